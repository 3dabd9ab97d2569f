#include "program.hpp"

#include <chrono>
#include <cstdio>
#include <iostream>
#include <sstream>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace contenders {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// The bytes of the heap that are in use, by any library; 0 if unknown.
std::size_t bytes_in_use() {
#ifdef __GLIBC__
  const auto heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
#else
  return 0;
#endif
}

template <class Value = std::string>
Value read(std::istream& in) {
  std::string word;
  if (!(in >> word)) throw std::invalid_argument("a word is missing");
  if constexpr (std::is_same_v<Value, std::string>)
    return word;
  else
    return static_cast<Value>(std::stod(word));  // which knows infinities
}

Given read_given(std::istream& in) {
  Given given;
  std::map<std::string, Numbers>* to = &given.numbers;
  for (std::string name; in >> name;) {
    if (name == "word") {
      const std::string of = read(in);
      given.words[of] = read(in);
    } else if (name == "effect") {
      given.effects.push_back({read(in), {}});
      to = &given.effects.back().parameters;
    } else {
      Numbers numbers(read<std::size_t>(in));
      for (double& number : numbers) number = read<double>(in);
      (*to)[name] = std::move(numbers);
    }
  }
  return given;
}

class Program {
 public:
  std::string answer(std::istream& in) {
    const std::string word = read(in);
    if (word == "names") {
      std::string line;
      for (const Contender& contender : all_) line += contender.name + ' ';
      return line;
    }
    if (word == "about") {
      const Contender& contender = named(read(in));
      return contender.label + ": " + contender.about;
    }
    if (word == "prepare") {
      const Contender& contender = named(read(in));
      const Given given = read_given(in);
      const std::size_t before = bytes_in_use();
      prepared_.push_back(contender.prepare(given));
      prepared_.back()->bytes = bytes_in_use() - before;
      return std::to_string(prepared_.size() - 1);
    }
    Prepared& one = *prepared_.at(read<std::size_t>(in));
    if (word == "burst") return one.burst(read<double>(in));
    if (word == "outcome") return one.outcome();
    if (word == "bytes") return std::to_string(one.bytes);
    if (word != "make") throw std::invalid_argument("no such request: " + word);
    one.make(read<int>(in));
    return std::to_string(one.parts());
  }

 private:
  const Contender& named(const std::string& name) const {
    for (const Contender& contender : all_)
      if (contender.name == name) return contender;
    throw std::invalid_argument("nothing has the name " + name);
  }

  std::vector<Contender> all_ = contenders();
  std::vector<std::unique_ptr<Prepared>> prepared_;
};

}  // namespace

double Prepared::seconds_of_batch() {
  const auto before = Clock::now();
  make(count_);
  return seconds_since(before);
}

// The first of several batches only warms up.
std::string Prepared::burst(double seconds) {
  const auto begin = Clock::now();
  if (count_ == 0)
    for (count_ = 1; shortest_batch_ > 0 && seconds_of_batch() < shortest_batch_;) count_ *= 2;
  Numbers taken;
  do {
    taken.push_back(1e9 * seconds_of_batch() / (count_ * parts()));
  } while (seconds_since(begin) < seconds);
  if (taken.size() > 1) taken.erase(taken.begin());
  return words(taken, "%.6g ");
}

std::string words(const Numbers& numbers, const char* form) {
  std::string line;
  char word[40];
  for (double value : numbers) {
    std::snprintf(word, sizeof word, form, value);
    line += word;
  }
  return line;
}

}  // namespace contenders

int main() {
  contenders::Program program;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream request(line);
    try {
      const std::string answered = program.answer(request);  // before any part of it is written
      std::cout << "ok " << answered << std::endl;
    } catch (const contenders::Unsupported& reason) {
      std::cout << "unsupported " << reason.what() << std::endl;
    } catch (const std::exception& reason) {
      std::cout << "error " << reason.what() << std::endl;
    }
  }
  return 0;
}
