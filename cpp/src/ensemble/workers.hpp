/// \file
/// Threads that share out the members of an ensemble.
///
/// A worker takes a chunk of members when it has none left, by one atomic addition; until then it
/// works without a lock. The calling thread is a worker, too: it alone looks at the clock and calls
/// the monitor.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>

#include "pendcore/ensemble.hpp"

namespace pendcore {

/// Members [begin, end).
struct Chunk {
  std::size_t begin = 0;
  std::size_t end = 0;
  bool is_empty() const { return begin == end; }
};

class SharedWork {
 public:
  SharedWork(std::size_t count, const EnsembleLimits& limits);

  /// The next members for a worker; an empty chunk if there are none, or if the work is stopped.
  Chunk take();
  void count(std::size_t members) { done_.fetch_add(members, std::memory_order_relaxed); }
  /// Whether to go on. The calling thread may find that the time is up, or call the monitor.
  bool goes_on(bool on_calling_thread);

  /// Runs work(on_calling_thread) on all workers until each returns. Throws what one of them threw.
  void run(const std::function<void(bool)>& work);

  std::size_t done() const { return done_.load(); }
  Status status() const { return status_.load(); }

 private:
  using Clock = std::chrono::steady_clock;

  std::size_t count_;
  std::size_t workers_;  ///< limits.workers, or one for each processor
  std::size_t chunk_;
  const EnsembleLimits& limits_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<std::size_t> done_ = 0;
  std::atomic<Status> status_ = Status::finished;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_call_ = start_;
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace pendcore
