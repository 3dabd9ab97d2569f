// A program of contenders: a request is a line, and the answer is a line, `ok ...`,
// `unsupported ...` or `error ...`. In this way the bursts of several programs can take turns.
// Each side is a program of its own, so that the linker does not mix inline functions of two
// headers or of two builds: a .cpp file that defines `contenders`, with a line in ../CMakeLists.txt
// and in programs.py, which speaks to it.
//
//   names                    the contenders
//   about NAME               label: version and settings
//   prepare NAME GIVEN       the number of what is prepared, with all that can be built beforehand
//   burst NUMBER SECONDS     nanoseconds of a call, or of its part, for each batch of calls
//   outcome NUMBER           what the calls compute
//   bytes NUMBER             heap in use after the preparation, 0 if unknown
//   make NUMBER COUNT        makes COUNT calls; answers the number of parts of one call
//
// GIVEN is any number of `NAME COUNT NUMBERS`, `word NAME WORD` and `effect KIND`, where numbers
// after an effect are its parameters.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace contenders {

using Numbers = std::vector<double>;

// Thrown by a contender that does not support what it is asked for.
struct Unsupported : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Effect {
  std::string kind;
  std::map<std::string, Numbers> parameters;  // those of a part are called "pd.kp", say
};

// A chain of uniform rods, masses (kg), lengths (m), gravity (m/s^2), with effects, and what else a
// contender needs to know of it. Angles are absolute, from +x towards +y, y down.
struct Given {
  std::map<std::string, Numbers> numbers;
  std::map<std::string, std::string> words;
  std::vector<Effect> effects;

  const Numbers& operator[](const char* name) const { return numbers.at(name); }
  std::size_t n() const { return numbers.at("masses").size(); }
};

// Calls that are timed; `parts` of a call, such as right-hand sides, share its time.
class Prepared {
 public:
  virtual ~Prepared() = default;
  std::string burst(double seconds);

  virtual void make(int count) = 0;
  virtual double parts() { return 1; }
  virtual std::string outcome() = 0;

  std::size_t bytes = 0;  // of the heap, held since the preparation

 protected:
  double shortest_batch_ = 0;  // s; more calls than one are timed at once until they take as long

 private:
  double seconds_of_batch();
  int count_ = 0;  // calls in a batch
};

// `label` names the contender in tables, `about` says version and settings. `prepare` throws
// Unsupported for what the contender does not support.
struct Contender {
  std::string name, label, about;
  std::function<std::unique_ptr<Prepared>(const Given&)> prepare;
};

// What a program defines.
std::vector<Contender> contenders();

// Numbers as text that reads back as the same doubles, with a space before each.
std::string words(const Numbers& numbers, const char* form = " %.17g");

}  // namespace contenders
