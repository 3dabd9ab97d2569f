// The program of a contender of forward dynamics; forward_dynamics.py speaks to it:
//
//   names                    the contenders
//   about NAME               label: version and settings
//   prepare NAME EFFECT n states masses lengths gravity q qd      the number of the calls
//   accelerations CALLS      qdd at the first state
//   bytes CALLS              heap in use after the preparation of the calls, 0 if unknown
//   make CALLS COUNT         makes COUNT calls; answers the number of right-hand sides of one call
//   burst CALLS SECONDS      nanoseconds of a right-hand side, one number for each batch of calls
#include "forward_dynamics.hpp"

#include <chrono>
#include <cstdio>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

using namespace contenders;
using Clock = std::chrono::steady_clock;
constexpr double batch_seconds = 1e-5;  // long compared with reading the clock

struct Prepared {
  std::unique_ptr<Calls> calls;
  std::size_t bytes = 0;
  int count = 0;  // in a batch
};

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

std::string burst(Prepared& prepared, double seconds) {
  Calls& calls = *prepared.calls;
  const auto begin = Clock::now();
  double taken = seconds_of(calls, prepared.count > 0 ? prepared.count : 1);  // warms up
  for (int count = 1; prepared.count == 0; count *= 2) {
    taken = seconds_of(calls, count);
    if (taken >= batch_seconds) prepared.count = count;
  }
  std::string line;
  char word[40];
  do {
    taken = seconds_of(calls, prepared.count) / (prepared.count * calls.right_hand_sides());
    std::snprintf(word, sizeof word, "%.4g ", 1e9 * taken);
    line += word;
  } while (std::chrono::duration<double>(Clock::now() - begin).count() < seconds);
  return line;
}

std::string answer(std::istream& request, std::vector<Prepared>& all) {
  static const std::vector<ForwardDynamics> list = forward_dynamics();
  std::string word, name;
  request >> word;
  if (word == "names") return names(list);
  if (word == "about") {
    request >> name;
    return about(list, name);
  }
  if (word == "prepare") {
    request >> name;
    const ForwardDynamics& contender = find(list, name);
    const Scene scene = read_scene(request);
    Prepared& prepared = all.emplace_back();
    const std::size_t before = bytes_in_use();
    try {
      prepared.calls = contender.prepare(scene);
    } catch (...) {
      all.pop_back();
      throw;
    }
    prepared.bytes = bytes_in_use() - before;
    return std::to_string(all.size() - 1);
  }
  if (word == "accelerations") return words(all.at(read_count(request)).calls->accelerations());
  if (word == "bytes") return std::to_string(all.at(read_count(request)).bytes);
  if (word == "make") {
    Calls& calls = *all.at(read_count(request)).calls;
    calls.make(static_cast<int>(read_count(request)));
    return std::to_string(calls.right_hand_sides());
  }
  if (word == "burst") {
    Prepared& prepared = all.at(read_count(request));
    return burst(prepared, read_number(request));
  }
  throw std::invalid_argument("no such request: " + word);
}

}  // namespace

int main() {
  std::vector<Prepared> all;
  return converse([&all](std::istream& request) { return answer(request, all); });
}
