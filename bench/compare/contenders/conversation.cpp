#include "conversation.hpp"

#include <cstdio>
#include <iostream>
#include <sstream>

namespace contenders {

double read_number(std::istream& in) {
  std::string word;
  if (!(in >> word)) throw std::invalid_argument("a number is missing");
  return std::stod(word);
}

std::size_t read_count(std::istream& in) { return static_cast<std::size_t>(read_number(in)); }

std::vector<double> read_numbers(std::istream& in, std::size_t count) {
  std::vector<double> numbers(count);
  for (double& number : numbers) number = read_number(in);
  return numbers;
}

std::string words(const std::vector<double>& numbers) {
  std::string line;
  char word[40];
  for (double value : numbers) {
    std::snprintf(word, sizeof word, " %.17g", value);
    line += word;
  }
  return line;
}

int converse(const std::function<std::string(std::istream&)>& answer) {
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream request(line);
    try {
      const std::string answered = answer(request);  // before any part of the answer is written
      std::cout << "ok " << answered << std::endl;
    } catch (const Unsupported& reason) {
      std::cout << "unsupported " << reason.what() << std::endl;
    } catch (const std::exception& reason) {
      std::cout << "error " << reason.what() << std::endl;
    }
  }
  return 0;
}

}  // namespace contenders
