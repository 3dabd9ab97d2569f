#include "pendcore/analysis/lobatto_points.hpp"

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

/// The integral from 0 to theta, and its integral; both without the factor theta, or theta^2.
Polynomial integrated(Polynomial p) {
  for (std::size_t i = 0; i < p.size(); ++i) p[i] /= static_cast<double>(i + 1);
  return p;
}
Polynomial integrated_twice(Polynomial p) {
  for (std::size_t i = 0; i < p.size(); ++i) p[i] /= static_cast<double>((i + 1) * (i + 2));
  return p;
}

double integral(const Polynomial& p, double theta) { return theta * value(integrated(p), theta); }
double double_integral(const Polynomial& p, double theta) {
  return theta * theta * value(integrated_twice(p), theta);
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

LobattoPoints::Within LobattoPoints::at(double share) const {
  Within weights{.theta = share, .once = {}, .twice = {}};
  for (std::size_t j = 0; j < count; ++j) {
    weights.once[j] = share * value(once_[j], share);
    weights.twice[j] = share * share * value(twice_[j], share);
  }
  return weights;
}

LobattoPoints::LobattoPoints(std::span<const double> points) : count(points.size()) {
  std::ranges::copy(points, theta.begin());
  for (std::size_t j = 0; j < count; ++j) {
    once_[j] = integrated(lagrange(points, j));
    twice_[j] = integrated_twice(lagrange(points, j));
  }
  for (std::size_t k = 0; k < equal_parts.size(); ++k) {
    equal_parts[k] = at(static_cast<double>(k) / divisions);
  }
  for (std::size_t i = 0; i < count; ++i) {
    of_all[i] = at(theta[i]).once;
    if (i > 0) weigh_earlier(points.first(i), i);
  }
}

/// Up to the last of the earlier points the polynomial goes through all of them. From there on
/// one through the last few is more stable.
void LobattoPoints::weigh_earlier(std::span<const double> earlier, std::size_t i) {
  const std::size_t few = std::min(extrapolated_from, earlier.size());
  const std::size_t first = earlier.size() - few;
  const double known = earlier.back();
  const double left = theta[i] - known;
  for (std::size_t j = 0; j < earlier.size(); ++j) {
    const Polynomial p = lagrange(earlier, j);
    of_earlier[i][j] = integral(p, known);
    twice_of_earlier[i][j] = double_integral(p, known) + left * integral(p, known);
  }
  for (std::size_t j = 0; j < few; ++j) {
    const Polynomial p = lagrange(earlier.last(few), j);
    of_earlier[i][first + j] += integral(p, theta[i]) - integral(p, known);
    twice_of_earlier[i][first + j] +=
        double_integral(p, theta[i]) - double_integral(p, known) - left * integral(p, known);
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
  const int least = static_cast<int>(all.front().count);
  const int most = static_cast<int>(all.back().count);
  if (count < least || count > most) {
    throw std::invalid_argument("points = " + std::to_string(count) + ": must be from " +
                                std::to_string(least) + " to " + std::to_string(most));
  }
  return all[static_cast<std::size_t>(count - least)];
}

}  // namespace pendcore
