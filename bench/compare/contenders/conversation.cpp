// The executable that holds the C++ contenders and answers compiled.py, a line for a line:
//
//   names                    the contenders
//   about NAME               label: version and settings
//   prepare NAME TOLERANCE n masses lengths gravity start n_t times      the number of the run
//   outcome RUN              right-hand sides, then the states
//   burst RUN SECONDS        nanoseconds of each call; a first of several only warms up
//
// The answer is `ok ...`, `unsupported ...` or `error ...`.
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "contender.hpp"

namespace {

using namespace contenders;

const std::vector<Contender>& list() {
  static const std::vector<Contender> all{
      pendcore_core(),
      odeint(),
  };
  return all;
}

const Contender& find(const std::string& name) {
  for (const Contender& contender : list())
    if (contender.name == name) return contender;
  throw std::invalid_argument("no contender of the name " + name);
}

double read_number(std::istream& in) {
  std::string word;
  if (!(in >> word)) throw std::invalid_argument("a number is missing");
  return std::stod(word);
}

std::vector<double> read_numbers(std::istream& in, std::size_t count) {
  std::vector<double> numbers(count);
  for (double& number : numbers) number = read_number(in);
  return numbers;
}

std::size_t read_count(std::istream& in) { return static_cast<std::size_t>(read_number(in)); }

Case read_case(std::istream& in) {
  Case given;
  const std::size_t n = read_count(in);
  given.masses = read_numbers(in, n);
  given.lengths = read_numbers(in, n);
  given.gravity = read_number(in);
  given.start = read_numbers(in, 2 * n);
  given.times = read_numbers(in, read_count(in));
  return given;
}

std::string outcome(Run& run) {
  run.solve();
  std::string line = std::to_string(run.evaluations());
  char word[40];
  for (double value : run.states()) {
    std::snprintf(word, sizeof word, " %.17g", value);
    line += word;
  }
  return line;
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
  std::string word, name, line;
  request >> word;
  if (word == "names") {
    for (const Contender& contender : list()) line += contender.name + ' ';
    return line;
  }
  if (word == "about") {
    request >> name;
    return find(name).label + ": " + find(name).about;
  }
  if (word == "prepare") {
    request >> name;
    const double tolerance = read_number(request);
    runs.push_back(find(name).prepare(read_case(request), tolerance));
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
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream request(line);
    try {
      std::cout << "ok " << answer(request, runs) << std::endl;
    } catch (const Unsupported& reason) {
      std::cout << "unsupported " << reason.what() << std::endl;
    } catch (const std::exception& reason) {
      std::cout << "error " << reason.what() << std::endl;
    }
  }
}
