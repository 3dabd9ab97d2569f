// a b + c, rounded once: the core's fma and the emulated one against whole numbers, in as many
// random and hard cases as the first argument says (a million by default). The exit status is 1
// if a result differs.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <random>

#include "arithmetic/emulated_fma.hpp"

using namespace pendcore;

namespace {

using Bits = std::uint64_t;

/// A sum of products of doubles without rounding: a whole number of 2^-2304, in digits of 32 bits
/// that are carried at the end alone.
class ExactSum {
 public:
  void add(double a, double b) {
    int of_a, of_b;
    const double x = std::frexp(a, &of_a), y = std::frexp(b, &of_b);
    const int place = of_a + of_b - 106 + 2304;
    const int sign = std::signbit(a) == std::signbit(b) ? 1 : -1;
    const auto whole_x = static_cast<Bits>(std::ldexp(std::abs(x), 53));
    const auto whole_y = static_cast<Bits>(std::ldexp(std::abs(y), 53));
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        add(half(whole_x, i) * half(whole_y, j), place + 32 * (i + j), sign);
      }
    }
  }

  /// The double next to it, that with an even last bit if two are.
  double rounded() {
    const bool is_negative = carry() < 0;
    if (is_negative) {
      for (std::int64_t& digit : digits_) digit = -digit;
      carry();
    }
    int top = count - 1;
    while (top > 0 && digits_[top] == 0) --top;
    const int highest = 32 * top + static_cast<int>(std::bit_width(Bits(digits_[top]))) - 1;
    const int last = std::max(highest - 52, 2304 - 1074);  // that of the least double, 2^-1074
    Bits kept = 0;
    for (int i = highest; i >= last; --i) kept = 2 * kept + (bit(i) ? 1 : 0);
    const int below = (last - 1) / 32;
    const Bits rest = Bits(digits_[below]) << (64 - (last - 1) % 32 - 1) << 1;
    const bool is_more =
        rest != 0 || std::any_of(digits_, digits_ + below, [](auto digit) { return digit != 0; });
    if (bit(last - 1) && (is_more || kept % 2 == 1)) ++kept;
    const double size = std::ldexp(static_cast<double>(kept), last - 2304);
    return is_negative ? -size : size;
  }

 private:
  static constexpr int count = 140;  // up to 2^2176

  static Bits half(Bits whole, int i) { return i == 0 ? whole & 0xffffffff : whole >> 32; }
  void add(Bits whole, int place, int sign) {
    for (int i = 0; i < 2; ++i) {
      const Bits shifted = half(whole, i) << (place % 32);
      std::int64_t* const digit = digits_ + place / 32 + i;
      for (int j = 0; j < 2; ++j) digit[j] += sign * static_cast<std::int64_t>(half(shifted, j));
    }
  }
  /// Makes all digits those of a whole number; what is carried beyond them has its sign.
  std::int64_t carry() {
    std::int64_t carried = 0;
    for (std::int64_t& digit : digits_) {
      carried += digit;
      digit = carried & 0xffffffff;
      carried >>= 32;
    }
    return carried;
  }
  bool bit(int i) const { return (digits_[i / 32] >> (i % 32) & 1) != 0; }

  std::int64_t digits_[count] = {};
};

double expected(double a, double b, double c) {
  if (a != 0.0 && b != 0.0 && std::isfinite(a) && std::isfinite(b) && std::isfinite(c)) {
    ExactSum sum;
    sum.add(a, b);
    sum.add(c, 1.0);
    return sum.rounded();
  }
  return std::isfinite(a) && std::isfinite(b) && !std::isfinite(c) ? c : a * b + c;
}

/// Random numbers of any bits, or whose sums cancel, lie half way, or leave the range.
class Cases {
 public:
  void next(double& a, double& b, double& c) {
    a = number();
    b = number();
    switch (random_() % 8) {
      case 0: c = number(); break;
      case 1: c = -(a * b); break;
      case 2: c = std::bit_cast<double>(std::bit_cast<Bits>(-(a * b)) + random_() % 5 - 2); break;
      case 3: c = scaled(few_bits(), exponent_of(a * b), 110); break;
      case 4:  // a product half way between two doubles, and a tiny number that decides
        a = scaled(1.0 + std::ldexp(static_cast<double>(random_() >> 37), -27), 0, 30);
        b = scaled(1.0 + std::ldexp(static_cast<double>(random_() >> 38), -26), 0, 30);
        c = scaled(few_bits(), 0, 200);
        break;
      case 5:  // near the least double
        a = scaled(few_bits(), -500, 20);
        b = scaled(near_one(), -540, 40);
        c = scaled(few_bits(), -1040, 40);
        break;
      case 6:  // near the largest
        a = scaled(near_one(), 500, 20);
        b = scaled(near_one(), 512, 20);
        c = scaled(near_one(), 1010, 13);
        break;
      default: c = scaled(near_one(), exponent_of(a * b), 60); break;
    }
  }

 private:
  double scaled(double x, int exponent, int most) {
    return std::ldexp(x, exponent + static_cast<int>(random_() % (2 * most + 1)) - most);
  }
  double sign() { return (random_() & 1) != 0 ? 1.0 : -1.0; }
  double near_one() {
    return sign() * (1.0 + std::ldexp(static_cast<double>(random_() >> 12), -52));
  }
  /// Its last bits are zero, or all of its bits are one.
  double few_bits() {
    const Bits mask = ~Bits{0} << (52 - random_() % 53);
    const Bits ones = random_() % 8 == 0 ? 0xfffffffffffff : random_() & mask & 0xfffffffffffff;
    return sign() * std::bit_cast<double>(ones | 0x3ff0000000000000);
  }
  double number() {
    constexpr double special[] = {
        0.0, HUGE_VAL, 0x1p-1074, 0x1p-1022, 0x1.fffffffffffffp1023, 1.0, 0x0.fffffffffffffp-1022};
    const Bits kind = random_() % 64;
    if (kind == 0) return sign() * special[random_() % std::size(special)];
    if (kind < 8) return std::bit_cast<double>(random_());
    return scaled(kind < 16 ? few_bits() : near_one(), 0, 60);
  }
  static int exponent_of(double x) {
    return static_cast<int>(std::bit_cast<Bits>(x) >> 52 & 0x7ff) - 1023;
  }

  std::mt19937_64 random_{20260101};
};

bool are_same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

}  // namespace

int main(int count, char** arguments) {
  const int cases = count > 1 ? std::atoi(arguments[1]) : 1'000'000;
  Cases random;
  int wrong = 0;
  for (int i = 0; i < cases; i += 2) {
    double a[2], b[2], c[2];
    for (int k = 0; k < 2; ++k) random.next(a[k], b[k], c[k]);
    const Pack<2> x = load<Pack<2>>(a), y = load<Pack<2>>(b), z = load<Pack<2>>(c);
    const Pack<2> both = fma(x, y, z), emulated = emulated_fma(x, y, z);
    for (int k = 0; k < 2; ++k) {
      const double right = expected(a[k], b[k], c[k]);
      const auto compare = [&](const char* which, double found) {
        if (are_same(found, right) || ++wrong > 20) return;
        std::printf("%s(%a, %a, %a) = %a, not %a\n", which, a[k], b[k], c[k], found, right);
      };
      compare("fma", lane(both, k));
      compare("emulated_fma", lane(emulated, k));
      compare("fma alone", pendcore::fma(a[k], b[k], c[k]));
      compare("emulated_fma alone", emulated_fma(a[k], b[k], c[k]));
    }
  }
  std::printf("%d cases, %d wrong\n", cases, wrong);
  return wrong == 0 ? 0 : 1;
}
