// The protocol of a program of contenders: a request is a line, and the answer is a line, `ok ...`,
// `unsupported ...` or `error ...`. In this way the bursts of several programs can take turns.
//
//   names                    the contenders
//   about NAME               label: version and settings
//   prepare NAME ...         the number of what is prepared, with all that can be built beforehand
//   burst NUMBER SECONDS     nanoseconds of calls, over about that long
//   WORD NUMBER ...          what else a program of this kind tells
#pragma once

#include <cstddef>
#include <functional>
#include <istream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace contenders {

// Thrown by a contender that does not support what it is asked for.
struct Unsupported : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Prepared {
 public:
  virtual ~Prepared() = default;
  virtual std::string burst(double seconds) = 0;
  virtual std::string tell(const std::string& word, std::istream& rest) = 0;
};

// `label` names the contender in tables, `about` says version and settings.
struct Contender {
  std::string name, label, about;
  std::function<std::unique_ptr<Prepared>(std::istream&)> prepare;
};

// What a program defines.
std::vector<Contender> contenders();

double read_number(std::istream& in);
std::size_t read_count(std::istream& in);
std::vector<double> read_numbers(std::istream& in, std::size_t count);

// Numbers as text that reads back as the same doubles, with a space before each.
std::string words(const std::vector<double>& numbers);

// Answers every line of the standard input until it ends.
int converse(const std::function<std::string(std::istream&)>& answer);

}  // namespace contenders
