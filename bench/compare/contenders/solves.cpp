#include "solves.hpp"

#include <chrono>

namespace contenders {
namespace {

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

}  // namespace

std::string Run::burst(double seconds) {
  using Clock = std::chrono::steady_clock;
  std::vector<long long> taken;
  const auto begin = Clock::now();
  for (;;) {
    const auto before = Clock::now();
    solve();
    const auto after = Clock::now();
    taken.push_back(std::chrono::duration_cast<std::chrono::nanoseconds>(after - before).count());
    if (std::chrono::duration<double>(after - begin).count() >= seconds) break;
  }
  std::string line;
  for (std::size_t i = taken.size() > 1 ? 1 : 0; i < taken.size(); ++i)
    line += std::to_string(taken[i]) + ' ';
  return line;
}

std::string Run::tell(const std::string& word, std::istream& /*rest*/) {
  if (word != "outcome") throw std::invalid_argument("no such request: " + word);
  solve();
  const auto found = states();
  if (found.empty()) return "failed " + failure();
  const std::string numbers = words({found.begin(), found.end()});
  const Counts counted = counts();
  return std::to_string(counted.evaluations) + ' ' + std::to_string(counted.steps) + numbers;
}

Contender solver(std::string name, std::string label, std::string about, PrepareRun prepare) {
  return {std::move(name), std::move(label), std::move(about),
          [prepare = std::move(prepare)](std::istream& in) -> std::unique_ptr<Prepared> {
            const double setting = read_number(in);
            return prepare(read_case(in), setting);
          }};
}

}  // namespace contenders
