// The program of contenders that prepare something to be timed.
#include "conversation.hpp"

int main() {
  using namespace contenders;
  const std::vector<Contender> all = contenders::contenders();
  std::vector<std::unique_ptr<Prepared>> prepared;
  const auto named = [&all](std::istream& request) -> const Contender& {
    std::string name;
    request >> name;
    for (const Contender& contender : all)
      if (contender.name == name) return contender;
    throw std::invalid_argument("nothing has the name " + name);
  };
  return converse([&](std::istream& request) -> std::string {
    std::string word, line;
    request >> word;
    if (word == "names") {
      for (const Contender& contender : all) line += contender.name + ' ';
      return line;
    }
    if (word == "about") {
      const Contender& contender = named(request);
      return contender.label + ": " + contender.about;
    }
    if (word == "prepare") {
      prepared.push_back(named(request).prepare(request));
      return std::to_string(prepared.size() - 1);
    }
    Prepared& one = *prepared.at(read_count(request));
    return word == "burst" ? one.burst(read_number(request)) : one.tell(word, request);
  });
}
