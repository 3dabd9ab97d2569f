#include "analysis/lobatto_points.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace pendcore {
namespace {

using Polynomial = LobattoPoints::Polynomial;

/// How many of the last points a value beyond them is extrapolated from. More are less stable.
constexpr std::size_t extrapolated_from = 3;

double value(const Polynomial& p, double theta) {
  double sum = 0.0;
  for (std::size_t i = p.size(); i-- > 0;) sum = theta * sum + p[i];
  return sum;
}

/// The integral from 0 on.
Polynomial integrated(const Polynomial& p) {
  Polynomial result{};
  for (std::size_t i = 1; i < p.size(); ++i) result[i] = p[i - 1] / static_cast<double>(i);
  return result;
}

double integral(const Polynomial& p, double theta) { return value(integrated(p), theta); }
double double_integral(const Polynomial& p, double theta) {
  return value(integrated(integrated(p)), theta);
}

/// The polynomial that is 1 at point j and 0 at the others.
Polynomial lagrange(std::span<const double> points, std::size_t j) {
  Polynomial product{1.0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == j) continue;
    const double scale = 1.0 / (points[j] - points[i]);
    for (std::size_t p = product.size(); p-- > 0;) {
      product[p] = scale * ((p > 0 ? product[p - 1] : 0.0) - points[i] * product[p]);
    }
  }
  return product;
}

}  // namespace

LobattoPoints::LobattoPoints(std::span<const double> points) : count(points.size()) {
  std::ranges::copy(points, theta.begin());
  Sums& to_end = sums[count];
  to_end.theta = 1.0;
  for (std::size_t j = 0; j < count; ++j) {
    const Polynomial once = integrated(lagrange(points, j));
    twice_at[j] = integrated(once);
    to_end.once[j] = value(once, 1.0);
    to_end.twice[j] = value(twice_at[j], 1.0);
  }
  for (std::size_t i = 1; i < count; ++i) weigh_earlier(points.first(i));
}

/// Sets the weights of the earlier points at the point after them. Up to the last of them the
/// polynomial goes through all of them. From there on one through the last few is more stable.
void LobattoPoints::weigh_earlier(std::span<const double> earlier) {
  const std::size_t few = std::min(extrapolated_from, earlier.size());
  const std::size_t first = earlier.size() - few;
  Sums& to = sums[earlier.size()];
  to.theta = theta[earlier.size()];
  const double known = earlier.back();
  const double left = to.theta - known;
  for (std::size_t j = 0; j < earlier.size(); ++j) {
    const Polynomial p = lagrange(earlier, j);
    to.once[j] = integral(p, known);
    to.twice[j] = double_integral(p, known) + left * integral(p, known);
  }
  for (std::size_t j = 0; j < few; ++j) {
    const Polynomial p = lagrange(earlier.last(few), j);
    to.once[first + j] += integral(p, to.theta) - integral(p, known);
    to.twice[first + j] +=
        double_integral(p, to.theta) - double_integral(p, known) - left * integral(p, known);
  }
}

const LobattoPoints& lobatto_points(int count) {
  // (1 + x)/2 for the zeros x of the derivative of Legendre's polynomials, and for x = -1 and 1
  static const std::array all = {
      LobattoPoints(std::array{0.0, 0.17267316464601143, 0.5, 0.82732683535398857, 1.0}),
      LobattoPoints(std::array{0.0, 0.11747233803526765, 0.35738424175967745, 0.64261575824032255,
                               0.88252766196473235, 1.0}),
      LobattoPoints(std::array{0.0, 0.084888051860716535, 0.26557560326464289, 0.5,
                               0.73442439673535711, 0.91511194813928346, 1.0}),
      LobattoPoints(std::array{0.0, 0.064129925745196692, 0.20414990928342885, 0.39535039104876057,
                               0.60464960895123943, 0.79585009071657115, 0.93587007425480331, 1.0}),
      LobattoPoints(std::array{0.0, 0.050121002294269921, 0.16140686024463112, 0.31844126808691092,
                               0.5, 0.68155873191308908, 0.83859313975536888, 0.94987899770573008,
                               1.0})};
  constexpr int least = LobattoPoints::least;
  constexpr int most = LobattoPoints::most;
  if (count < least || count > most) {
    throw std::invalid_argument("points = " + std::to_string(count) + ": must be from " +
                                std::to_string(least) + " to " + std::to_string(most));
  }
  return all[static_cast<std::size_t>(count - least)];
}

}  // namespace pendcore
