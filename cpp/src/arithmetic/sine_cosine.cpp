#include "arithmetic/sine_cosine.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace pendcore {
namespace {

__extension__ typedef unsigned __int128 Wide;
__extension__ typedef __int128 SignedWide;

// 2/pi in words of 64 bits, after one word of zeros: the largest double reaches bit 1024 + 192.
constexpr std::array<std::uint64_t, 21> two_over_pi_bits = {
    0x0000000000000000, 0xa2f9836e4e441529, 0xfc2757d1f534ddc0, 0xdb6295993c439041,
    0xfe5163abdebbc561, 0xb7246e3a424dd2e0, 0x06492eea09d1921c, 0xfe1deb1cb129a73e,
    0xe88235f52ebb4484, 0xe99c7026b45f7e41, 0x3991d639835339f4, 0x9c845f8bbdf9283b,
    0x1ff897ffde05980f, 0xef2f118b5a0a6d1f, 0x6d367ecf27cb09b7, 0x4f463f669e5fea2d,
    0x7527bac7ebe5f17b, 0x3d0739f78a5292ea, 0x6bfb5fb11f8d5d08, 0x56033046fc7b6bab,
    0xf0cfbc209af4361d,
};

/// 64 bits of 2/pi from bit `offset` on; bit 0 is worth 2^63 (the first word holds zeros).
std::uint64_t bits_from(int offset) {
  const int word = offset / 64;
  const int shift = offset % 64;
  if (shift == 0) return two_over_pi_bits[word];
  return (two_over_pi_bits[word] << shift) | (two_over_pi_bits[word + 1] >> (64 - shift));
}

PENDCORE_INLINE void sine_cosine_stream(const double* x, long long m, double* sine,
                                        double* cosine) {
  using Quad = Pack<4>;
  long long i = 0;
  for (; i + 4 <= m; i += 4) {
    Quad s, c;
    sine_cosine(load<Quad>(x + i), s, c);
    store(sine + i, s);
    store(cosine + i, c);
  }
  for (; i < m; ++i) sine_cosine(x[i], sine[i], cosine[i]);
}

}  // namespace

void sine_cosine_detail::replace_large(const double* x, int count, double* sine_of_x,
                                       double* cosine_of_x) {
  for (int i = 0; i < count; ++i) {
    if (!(std::abs(x[i]) <= largest)) sine_cosine_exact(x[i], sine_of_x[i], cosine_of_x[i]);
  }
}

void sine_cosine(const double* x, long long m, double* sine, double* cosine) {
  on_this_processor<&sine_cosine_stream>(x, m, sine, cosine);
}

void sine_cosine_exact(double x, double& sine, double& cosine) {
  if (!std::isfinite(x)) {
    sine = cosine = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  if (std::abs(x) <= sine_cosine_detail::largest) {
    sine_cosine(x, sine, cosine);
    return;
  }
  // |x| = mantissa 2^exponent. The bits of 2/pi that are worth 4/2^exponent or more only add
  // multiples of 4 to |x| 2/pi. The next 192 bits leave 128 bits below the binary point.
  int exponent;
  const double significand = std::frexp(std::abs(x), &exponent);
  const auto mantissa = static_cast<std::uint64_t>(std::ldexp(significand, 53));
  exponent -= 53;
  const int first_bit = exponent - 2 + 64;
  const Wide low = Wide{mantissa} * bits_from(first_bit + 128);
  const Wide middle = Wide{mantissa} * bits_from(first_bit + 64) + (low >> 64);
  const auto high =
      mantissa * bits_from(first_bit) + static_cast<std::uint64_t>(middle >> 64);  // modulo 4
  std::int64_t quadrant = static_cast<std::int64_t>(high >> 62);
  Wide fraction = (Wide{high} << 66) | (Wide{static_cast<std::uint64_t>(middle)} << 2) |
                  (static_cast<std::uint64_t>(low) >> 62);

  double sign = 1.0;  // the sign of the distance to the nearest multiple
  if ((fraction >> 127) != 0) {
    fraction = -fraction;
    sign = -1.0;
    ++quadrant;
  }
  const double scale = 0x1p-128;
  const double leading = static_cast<double>(fraction);
  const auto rest = static_cast<SignedWide>(fraction - static_cast<Wide>(leading));
  const double part_1 = sign * scale * leading;
  const double part_2 = sign * scale * static_cast<double>(rest);

  constexpr double half_pi = 0x1.921fb54442d18p+0;
  constexpr double half_pi_rest = 0x1.1a62633145c07p-54;
  const double r = part_1 * half_pi;
  const double tail = fma(part_1, half_pi, -r) + fma(part_1, half_pi_rest, part_2 * half_pi);
  double s, c;
  sine_cosine_detail::reduced(r, tail, s, c);
  sine_cosine_detail::rotate(static_cast<long long>(quadrant), s, c, sine, cosine);
  if (x < 0.0) sine = -sine;
}

}  // namespace pendcore
