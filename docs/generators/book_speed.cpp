// The C++ side of book_speed.py: `call N` is answered with the seconds that N right-hand sides of
// the generated header took. It is compiled beside book.hpp.
#include <chrono>
#include <cstddef>
#include <iostream>
#include <string>

#include "book.hpp"

int main() {
  const book::Chain chain;
  std::array<book::Chain::State, 64> states{};
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double x = static_cast<double>(i);
    states[i] = {0.8 + 0.01 * x, 1.0 - 0.02 * x, 0.1 * x, -0.2 * x};
  }
  volatile double kept = 0.0;
  std::string word;
  for (std::size_t count = 0; std::cin >> word >> count;) {
    const auto begun = std::chrono::steady_clock::now();
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto dydt = chain.right_hand_side(0.0, states[i % states.size()]);
      sum += dydt[2] + dydt[3];
    }
    kept = kept + sum;
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begun;
    std::cout << "ok " << seconds.count() << std::endl;
  }
}
