#include "forward_dynamics.hpp"

#include <chrono>
#include <cstdio>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace contenders {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double batch_seconds = 1e-5;  // long compared with reading the clock

// The bytes of the heap that are in use, by any library; 0 if unknown.
std::size_t bytes_in_use() {
#ifdef __GLIBC__
  const auto heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
#else
  return 0;
#endif
}

double seconds_of(Calls& calls, int count) {
  const auto before = Clock::now();
  calls.make(count);
  return std::chrono::duration<double>(Clock::now() - before).count();
}

Scene read_scene(std::istream& in) {
  Scene scene;
  in >> scene.effect;
  const std::size_t n = read_count(in), states = read_count(in);
  scene.masses = read_numbers(in, n);
  scene.lengths = read_numbers(in, n);
  scene.gravity = read_number(in);
  scene.q = read_numbers(in, states * n);
  scene.qd = read_numbers(in, states * n);
  return scene;
}

}  // namespace

std::string Calls::burst(double seconds) {
  const auto begin = Clock::now();
  double taken = seconds_of(*this, count_ > 0 ? count_ : 1);  // warms up
  for (int count = 1; count_ == 0; count *= 2) {
    taken = seconds_of(*this, count);
    if (taken >= batch_seconds) count_ = count;
  }
  std::string line;
  char word[40];
  do {
    taken = seconds_of(*this, count_) / (count_ * right_hand_sides());
    std::snprintf(word, sizeof word, "%.4g ", 1e9 * taken);
    line += word;
  } while (std::chrono::duration<double>(Clock::now() - begin).count() < seconds);
  return line;
}

std::string Calls::tell(const std::string& word, std::istream& rest) {
  if (word == "accelerations") return words(accelerations());
  if (word == "bytes") return std::to_string(bytes);
  if (word != "make") throw std::invalid_argument("no such request: " + word);
  make(static_cast<int>(read_count(rest)));
  return std::to_string(right_hand_sides());
}

Contender forward_dynamics(std::string name, std::string label, std::string about,
                           PrepareCalls prepare) {
  return {std::move(name), std::move(label), std::move(about),
          [prepare = std::move(prepare)](std::istream& in) -> std::unique_ptr<Prepared> {
            const Scene scene = read_scene(in);
            const std::size_t before = bytes_in_use();
            std::unique_ptr<Calls> calls = prepare(scene);
            calls->bytes = bytes_in_use() - before;
            return calls;
          }};
}

}  // namespace contenders
