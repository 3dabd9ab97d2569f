#include "ensemble/workers.hpp"

#include <algorithm>
#include <thread>
#include <vector>

namespace pendcore {

SharedWork::SharedWork(std::size_t count, const EnsembleLimits& limits)
    : count_(count), limits_(limits) {
  const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t wanted = limits.workers > 0 ? limits.workers : processors;
  workers_ = std::clamp<std::size_t>(wanted, 1, count);
  // Some milliseconds of work, and in a small ensemble few enough that every worker gets some.
  constexpr std::size_t usual_chunk = 256;
  chunk_ = std::clamp<std::size_t>(count / (8 * workers_), 1, usual_chunk);
}

Chunk SharedWork::take() {
  if (status_.load(std::memory_order_relaxed) != Status::finished) return {};
  const std::size_t begin = next_.fetch_add(chunk_, std::memory_order_relaxed);
  if (begin >= count_) return {};
  return {begin, std::min(begin + chunk_, count_)};
}

bool SharedWork::goes_on(bool on_calling_thread) {
  if (on_calling_thread) {
    const Clock::time_point now = Clock::now();
    const std::chrono::duration<double> since_start = now - start_;
    const std::chrono::duration<double> since_call = now - last_call_;
    if (since_start.count() >= limits_.time_limit) status_ = Status::time_limit;
    if (limits_.monitor && since_call.count() >= 0.05) {
      last_call_ = now;
      const double fraction = static_cast<double>(done()) / static_cast<double>(count_);
      if (!limits_.monitor(fraction)) status_ = Status::interrupted;
    }
  }
  return status_.load(std::memory_order_relaxed) == Status::finished;
}

void SharedWork::run(const std::function<void(bool)>& work) {
  const auto guarded = [&](bool on_calling_thread) {
    try {
      work(on_calling_thread);
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      if (!error_) error_ = std::current_exception();
      status_ = Status::interrupted;
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < workers_; ++i) others.emplace_back(guarded, false);
    guarded(true);
    // The calling thread may be done long before the others: until they are, it looks at the clock
    // and calls the monitor.
    while (done() < count_ && goes_on(true) && workers_ > 1) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  if (error_) std::rethrow_exception(error_);
}

}  // namespace pendcore
