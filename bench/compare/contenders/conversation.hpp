// The protocol of a program of contenders: a request is a line, and the answer is a line, `ok ...`,
// `unsupported ...` or `error ...`. In this way the bursts of several programs can take turns.
#pragma once

#include <cstddef>
#include <functional>
#include <istream>
#include <stdexcept>
#include <string>
#include <vector>

namespace contenders {

// Thrown by a contender that does not support what it is asked for.
struct Unsupported : std::runtime_error {
  using std::runtime_error::runtime_error;
};

double read_number(std::istream& in);
std::size_t read_count(std::istream& in);
std::vector<double> read_numbers(std::istream& in, std::size_t count);

// Numbers as text that reads back as the same doubles, with a space before each.
std::string words(const std::vector<double>& numbers);

// The element of that name. The elements of both kinds of programs have a `name`.
template <class Element>
const Element& find(const std::vector<Element>& all, const std::string& name) {
  for (const Element& element : all)
    if (element.name == name) return element;
  throw std::invalid_argument("nothing has the name " + name);
}

// The answers to the requests that all programs have, `names` and `about NAME`.
template <class Element>
std::string names(const std::vector<Element>& all) {
  std::string line;
  for (const Element& element : all) line += element.name + ' ';
  return line;
}
template <class Element>
std::string about(const std::vector<Element>& all, const std::string& name) {
  const Element& element = find(all, name);
  return element.label + ": " + element.about;
}

// Answers every line of the standard input until it ends.
int converse(const std::function<std::string(std::istream&)>& answer);

}  // namespace contenders
