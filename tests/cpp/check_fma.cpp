// a b + c, rounded once: the core's fma and the emulated one against whole numbers, in as many
// random and hard cases as the first argument says (a million by default). The exit status is 1
// if a result differs.
#include <algorithm>
#include <bit>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "arithmetic/emulated_fma.hpp"

using namespace pendcore;

namespace {

using Bits = std::uint64_t;
constexpr int least_exponent = -1074;  // that of the least double, 2^-1074

/// A whole number times 2^exponent, with a sign; it is a double without rounding.
struct Exact {
  bool negative;
  int exponent;
  Bits whole;
};

Exact exact(double x) {
  const Bits bits = std::bit_cast<Bits>(x);
  const int biased = static_cast<int>(bits >> 52) & 0x7ff;
  const Bits fraction = bits & 0xfffffffffffff;
  return {.negative = (bits >> 63) != 0,
          .exponent = biased == 0 ? least_exponent : least_exponent + biased - 1,
          .whole = biased == 0 ? fraction : fraction | 0x10000000000000};
}

/// A whole number of 320 bits, the lowest word first.
struct Wide {
  Bits words[5] = {};

  static Wide shifted(Bits x, int left) {
    Wide result;
    const int word = left / 64, by = left % 64;
    result.words[word] = x << by;
    if (by != 0 && word < 4) result.words[word + 1] = x >> (64 - by);
    return result;
  }
  bool bit(int i) const { return (words[i / 64] >> (i % 64) & 1) != 0; }
  int highest_bit() const {
    for (int word = 4; word >= 0; --word) {
      if (words[word] != 0) return 64 * word + 63 - std::countl_zero(words[word]);
    }
    return -1;
  }
  /// 53 bits and more from a bit on.
  Bits from(int i) const {
    const int word = i / 64, by = i % 64;
    const Bits above = by != 0 && word < 4 ? words[word + 1] << (64 - by) : 0;
    return (words[word] >> by) | above;
  }
  bool any_below(int i) const {
    for (int k = 0; k < i; ++k) {
      if (bit(k)) return true;
    }
    return false;
  }
  bool operator<(const Wide& other) const {
    for (int word = 4; word >= 0; --word) {
      if (words[word] != other.words[word]) return words[word] < other.words[word];
    }
    return false;
  }
};

Wide plus(const Wide& a, const Wide& b) {
  Wide sum;
  Bits carry = 0;
  for (int i = 0; i < 5; ++i) {
    const Bits first = a.words[i] + b.words[i];
    sum.words[i] = first + carry;
    carry = static_cast<Bits>(first < a.words[i]) + static_cast<Bits>(sum.words[i] < first);
  }
  return sum;
}

Wide minus(const Wide& a, const Wide& b) {  // a >= b
  Wide difference;
  Bits borrow = 0;
  for (int i = 0; i < 5; ++i) {
    const Bits first = a.words[i] - b.words[i];
    difference.words[i] = first - borrow;
    borrow = static_cast<Bits>(a.words[i] < b.words[i]) + static_cast<Bits>(first < borrow);
  }
  return difference;
}

/// The product of two numbers of 53 bits.
Wide times(Bits a, Bits b) {
  const Bits low_a = a & 0xffffffff, high_a = a >> 32;
  const Bits low_b = b & 0xffffffff, high_b = b >> 32;
  return plus(plus(Wide::shifted(low_a * low_b, 0), Wide::shifted(low_a * high_b, 32)),
              plus(Wide::shifted(high_a * low_b, 32), Wide::shifted(high_a * high_b, 64)));
}

Wide moved(const Wide& a, int left) {  // of two words that are not zero
  return plus(Wide::shifted(a.words[0], left), Wide::shifted(a.words[1], left + 64));
}

/// The double next to whole 2^exponent, that with an even last bit if two are.
double rounded(bool negative, const Wide& whole, int exponent) {
  const int highest = whole.highest_bit();
  const int dropped = std::max(highest - 52, least_exponent - exponent);
  double result = 0.0;
  if (dropped <= 0) {
    result = std::ldexp(static_cast<double>(whole.words[0]), exponent);
  } else if (dropped <= highest + 1) {
    Bits kept = dropped > highest ? 0 : whole.from(dropped);
    const bool half = whole.bit(dropped - 1);
    const bool more = whole.any_below(dropped - 1);
    if (half && (more || (kept & 1) != 0)) ++kept;
    result = std::ldexp(static_cast<double>(kept), exponent + dropped);
  }
  return negative ? -result : result;
}

/// a b + c for finite numbers whose product is not zero, c not zero.
double by_whole_numbers(double a, double b, double c) {
  const Exact x = exact(a), y = exact(b);
  Exact z = exact(c);
  bool negative = x.negative != y.negative;
  Wide product = times(x.whole, y.whole);
  int exponent = x.exponent + y.exponent;
  // What lies far below the other's last bit only says on which side the sum is.
  constexpr int far = 120;
  if (z.exponent + far < exponent) z = {z.negative, exponent - far + 1, 1};
  if (exponent + 2 * far < z.exponent) {
    product = Wide::shifted(1, 0);
    exponent = z.exponent - far;
  }
  const int least = std::min(exponent, z.exponent);
  product = moved(product, exponent - least);
  Wide added = Wide::shifted(z.whole, z.exponent - least);
  if (negative == z.negative) return rounded(negative, plus(product, added), least);
  if (product < added) {
    negative = z.negative;
    std::swap(product, added);
  }
  const Wide difference = minus(product, added);
  return difference.highest_bit() < 0 ? 0.0 : rounded(negative, difference, least);
}

double expected(double a, double b, double c) {
  const bool is_plain =
      std::isfinite(a) && std::isfinite(b) && std::isfinite(c) && a != 0.0 && b != 0.0 && c != 0.0;
  if (is_plain) return by_whole_numbers(a, b, c);
  // Either nothing is rounded here, or the product alone is; of a product that is not zero and
  // c = 0, whose sum may be below the least double, the sign is that of the product.
  if (c == 0.0 && std::isfinite(a) && std::isfinite(b) && a != 0.0 && b != 0.0) {
    const Exact x = exact(a), y = exact(b);
    return rounded(x.negative != y.negative, times(x.whole, y.whole), x.exponent + y.exponent);
  }
  return std::isfinite(a) && std::isfinite(b) && !std::isfinite(c) ? c : a * b + c;
}

class Cases {
 public:
  /// The next three numbers: any bits, or sums that cancel, lie half way, or leave the range.
  void next(double& a, double& b, double& c) {
    a = number();
    b = number();
    switch (random() % 8) {
      case 0: c = number(); break;
      case 1: c = -(a * b); break;
      case 2: c = std::bit_cast<double>(std::bit_cast<Bits>(-(a * b)) + random() % 5 - 2); break;
      case 3: c = std::ldexp(few_bits(), exponent_of(a * b) + offset(110)); break;
      case 4:  // a product half way between two doubles, and a tiny number that decides
        a = std::ldexp(1.0 + std::ldexp(static_cast<double>(random() >> 37), -27), offset(30));
        b = std::ldexp(1.0 + std::ldexp(static_cast<double>(random() >> 38), -26), offset(30));
        c = std::ldexp(few_bits(), offset(200));
        break;
      case 5:  // near the least double
        a = std::ldexp(few_bits(), -500 + offset(20));
        b = std::ldexp(number_near_one(), -540 + offset(40));
        c = std::ldexp(few_bits(), -1040 + offset(40));
        break;
      case 6:  // near the largest
        a = std::ldexp(number_near_one(), 500 + offset(20));
        b = std::ldexp(number_near_one(), 512 + offset(20));
        c = std::ldexp(number_near_one(), 1010 + offset(13));
        break;
      default: c = std::ldexp(number_near_one(), exponent_of(a * b) + offset(60)); break;
    }
  }

 private:
  Bits random() {  // splitmix64 (Steele, Lea & Flood 2014)
    state_ += 0x9e3779b97f4a7c15;
    Bits x = state_;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
  }
  int offset(int most) { return static_cast<int>(random() % (2 * most + 1)) - most; }
  double sign() { return (random() & 1) != 0 ? 1.0 : -1.0; }
  double number_near_one() {
    return sign() * (1.0 + std::ldexp(static_cast<double>(random() >> 12), -52));
  }
  /// Its last bits are zero, or all of its bits are one.
  double few_bits() {
    const int kept = static_cast<int>(random() % 53);
    const Bits mask = ~Bits{0} << (52 - kept);
    const Bits ones = (random() & 7) == 0 ? 0xfffffffffffff : random() & mask & 0xfffffffffffff;
    return sign() * std::bit_cast<double>(ones | 0x3ff0000000000000);
  }
  double number() {
    const Bits kind = random() % 64;
    if (kind == 0) return special();
    if (kind < 8) return std::bit_cast<double>(random());
    if (kind < 16) return std::ldexp(few_bits(), offset(60));
    return std::ldexp(number_near_one(), offset(60));
  }
  double special() {
    constexpr double numbers[] = {
        0.0, HUGE_VAL, 0x1p-1074, 0x1p-1022, 0x1.fffffffffffffp1023, 1.0, 0x0.fffffffffffffp-1022};
    return sign() * numbers[random() % std::size(numbers)];
  }
  static int exponent_of(double x) {
    const int biased = static_cast<int>(std::bit_cast<Bits>(x) >> 52) & 0x7ff;
    return biased - 1023;
  }

  Bits state_ = 20260101;
};

bool same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

int wrong = 0;

void compare(const char* which, double a, double b, double c, double found) {
  const double right = expected(a, b, c);
  if (same(found, right)) return;
  if (++wrong <= 20) std::printf("%s(%a, %a, %a) = %a, not %a\n", which, a, b, c, found, right);
}

}  // namespace

int main(int count, char** arguments) {
  const int cases = count > 1 ? std::atoi(arguments[1]) : 1'000'000;
  Cases random;
  for (int i = 0; i < cases; i += 2) {
    double a[2], b[2], c[2];
    for (int k = 0; k < 2; ++k) random.next(a[k], b[k], c[k]);
    const Pack<2> x = load<Pack<2>>(a), y = load<Pack<2>>(b), z = load<Pack<2>>(c);
    const Pack<2> both = fma(x, y, z);
    const Pack<2> emulated = emulated_fma(x, y, z);
    for (int k = 0; k < 2; ++k) {
      compare("fma", a[k], b[k], c[k], lane(both, k));
      compare("emulated_fma", a[k], b[k], c[k], lane(emulated, k));
      compare("fma alone", a[k], b[k], c[k], pendcore::fma(a[k], b[k], c[k]));
      compare("emulated_fma alone", a[k], b[k], c[k], emulated_fma(a[k], b[k], c[k]));
    }
  }
  std::printf("%d cases, %d wrong\n", cases, wrong);
  return wrong == 0 ? 0 : 1;
}
