// A program of C++ contenders that solve cases; compiled.py speaks to it:
//
//   names                    the contenders
//   about NAME               label: version and settings
//   prepare NAME SETTING n masses lengths gravity damping stiffness rest controller start n_t times
//                            the number of the run
//   outcome RUN              right-hand sides, steps, then the states; or `failed` and the reason
//   burst RUN SECONDS        nanoseconds of each call; the first of several only warms up
#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "contender.hpp"

namespace {

using namespace contenders;

const std::vector<Contender>& list() {
  static const std::vector<Contender> all = contenders::contenders();
  return all;
}

Case read_case(std::istream& in) {
  Case given;
  const std::size_t n = read_count(in);
  given.masses = read_numbers(in, n);
  given.lengths = read_numbers(in, n);
  given.gravity = read_number(in);
  given.damping = read_numbers(in, n);
  given.stiffness = read_numbers(in, n);
  given.rest = read_numbers(in, n);
  given.controller = read_number(in) != 0;
  given.start = read_numbers(in, 2 * n);
  given.times = read_numbers(in, read_count(in));
  return given;
}

std::string outcome(Run& run) {
  run.solve();
  const auto states = run.states();
  if (states.empty()) return "failed " + run.failure();
  const std::string found = words({states.begin(), states.end()});
  const Counts counted = run.counts();
  return std::to_string(counted.evaluations) + ' ' + std::to_string(counted.steps) + found;
}

std::string burst(Run& run, double seconds) {
  using Clock = std::chrono::steady_clock;
  std::vector<long long> taken;
  const auto begin = Clock::now();
  for (;;) {
    const auto before = Clock::now();
    run.solve();
    const auto after = Clock::now();
    taken.push_back(std::chrono::duration_cast<std::chrono::nanoseconds>(after - before).count());
    if (std::chrono::duration<double>(after - begin).count() >= seconds) break;
  }
  std::string line;
  for (std::size_t i = taken.size() > 1 ? 1 : 0; i < taken.size(); ++i)
    line += std::to_string(taken[i]) + ' ';
  return line;
}

std::string answer(std::istream& request, std::vector<std::unique_ptr<Run>>& runs) {
  std::string word, name;
  request >> word;
  if (word == "names") return names(list());
  if (word == "about") {
    request >> name;
    return about(list(), name);
  }
  if (word == "prepare") {
    request >> name;
    const double setting = read_number(request);
    runs.push_back(find(list(), name).prepare(read_case(request), setting));
    return std::to_string(runs.size() - 1);
  }
  if (word == "outcome") return outcome(*runs.at(read_count(request)));
  if (word == "burst") {
    Run& run = *runs.at(read_count(request));
    return burst(run, read_number(request));
  }
  throw std::invalid_argument("no such request: " + word);
}

}  // namespace

int main() {
  std::vector<std::unique_ptr<Run>> runs;
  return converse([&runs](std::istream& request) { return answer(request, runs); });
}
