#include "integrate/events/root.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pendcore {
namespace {

constexpr double none = 2.0;
/// Memory for a degree below `room`; most polynomials only need the smaller one.
template <std::size_t room>
using Bernstein = std::array<double, room>;
constexpr std::size_t small = 16;
constexpr std::size_t large = highest_degree + 1;

/// 1/C(degree, k)
constexpr std::array<Bernstein<large>, large> inverse_binomials = [] {
  std::array<Bernstein<large>, large> table{};
  for (int degree = 0; degree < static_cast<int>(large); ++degree) {
    double binomial = 1.0;
    for (int k = 0; k <= degree; ++k) {
      table[degree][k] = 1.0 / binomial;
      binomial = binomial * (degree - k) / (k + 1);
    }
  }
  return table;
}();

/// Finds a sign change between low and high, p(low) >= 0 > p(high), to the last bits of theta.
double bisect(const double* c, int degree, double low, double high) {
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return high;
    (polynomial_at(c, degree, middle) < 0.0 ? high : low) = middle;
  }
}

/// Takes the first half of the interval into `left`, and leaves the second in `right`, by de
/// Casteljau's algorithm.
void halve(double* left, double* right, int degree) {
  for (int i = 0; i <= degree; ++i) {
    left[i] = right[0];
    for (int k = 0; k < degree - i; ++k) right[k] = 0.5 * (right[k] + right[k + 1]);
  }
}

/// Searches low .. high for the first negative value, from the Bernstein form b of the polynomial
/// there.
template <std::size_t room>
double search(const double* c, int degree, const Bernstein<room>& b, double low, double high,
              int depth) {
  bool any_negative = false;
  for (int i = 0; i <= degree; ++i) any_negative |= b[i] < 0.0;
  if (!any_negative) return none;
  int changes = 0;
  for (int i = 1; i <= degree; ++i) changes += (b[i] < 0.0) != (b[i - 1] < 0.0);
  if (changes == 0) return low;
  if (changes == 1 && b[0] >= 0.0) return bisect(c, degree, low, high);
  // A polynomial that is not negative at the end of so short an interval only touches zero.
  if (depth == 50) return polynomial_at(c, degree, high) < 0.0 ? high : none;
  Bernstein<room> left{};
  Bernstein<room> right = b;
  halve(left.data(), right.data(), degree);
  const double middle = 0.5 * (low + high);
  const double found = search(c, degree, left, low, middle, depth + 1);
  return found <= 1.0 ? found : search(c, degree, right, middle, high, depth + 1);
}

template <std::size_t room>
double search_step(const double* c, int degree) {
  Bernstein<room> b{};
  bernstein_form(c, degree, b.data());
  return search(c, degree, b, 0.0, 1.0, 0);
}

/// Finds the turning points of a polynomial on low .. high from the Bernstein form b of its
/// derivative. Turning points that are closer together than 2^-30 of the step differ by less than
/// rounding, and one of them stands for all.
class TurningPoints {
 public:
  TurningPoints(const double* c, int degree, std::vector<TurningPoint>& found)
      : c_(c), degree_(degree), found_(found) {}

  void search(const Bernstein<large>& b, double low, double high, int depth) {
    const int last = degree_ - 1;
    int changes = 0;
    int sign_before = 0;
    for (int i = 0; i <= last; ++i) {
      const int here = sign(b[i]);
      changes += here != 0 && here == -sign_before;
      if (here != 0) sign_before = here;
    }
    if (changes == 0) return;
    if (changes == 1) {
      return append(
          pendcore::bisect([this](double theta) { return slope(theta); }, low, high, sign_before));
    }
    const double middle = 0.5 * (low + high);
    if (depth == 30) return append(middle);
    Bernstein<large> left{};
    Bernstein<large> right = b;
    halve(left.data(), right.data(), last);
    search(left, low, middle, depth + 1);
    if (right[0] == 0.0) append(middle);
    search(right, middle, high, depth + 1);
  }

 private:
  void append(double theta) { found_.push_back({theta, polynomial_at(c_, degree_, theta)}); }
  double slope(double theta) const {
    double sum = degree_ * c_[degree_];
    for (int k = degree_ - 1; k > 0; --k) sum = sum * theta + k * c_[k];
    return sum;
  }

  const double* c_;
  int degree_;
  std::vector<TurningPoint>& found_;
};

/// Adds the turning points of a polynomial, given in its Bernstein form b as well.
void find_turning_points(const double* coefficients, int degree, const Bernstein<large>& b,
                         std::vector<TurningPoint>& found) {
  Bernstein<large> slopes{};
  for (int i = 0; i < degree; ++i) slopes[i] = b[i + 1] - b[i];
  TurningPoints(coefficients, degree, found).search(slopes, 0.0, 1.0, 0);
}

}  // namespace

/// b_i = sum_{k <= i} C(i, k)/C(degree, k) c_k, by Pascal's triangle.
void bernstein_form(const double* coefficients, int degree, double* bernstein) {
  for (int k = 0; k <= degree; ++k) bernstein[k] = inverse_binomials[degree][k] * coefficients[k];
  for (int k = 1; k <= degree; ++k) {
    for (int i = degree; i >= k; --i) bernstein[i] += bernstein[i - 1];
  }
}

double first_negative(const double* coefficients, int degree) {
  double least = coefficients[0];  // a lower bound
  for (int k = 1; k <= degree; ++k) least += std::min(coefficients[k], 0.0);
  if (least > 0.0) return none;
  double largest = 0.0;
  for (int k = 1; k <= degree; ++k) largest = std::max(largest, std::abs(coefficients[k]));
  const bool from_zero = coefficients[0] <= 1e-13 * largest;
  const double* const c = from_zero ? coefficients + 1 : coefficients;  // p/theta has p's signs
  const int rest = from_zero ? degree - 1 : degree;
  if (!(largest > 0.0)) return coefficients[0] < 0.0 ? 0.0 : none;
  return rest < static_cast<int>(small) ? search_step<small>(c, rest) : search_step<large>(c, rest);
}

void find_turning_points(const double* coefficients, int degree, std::vector<TurningPoint>& found) {
  Bernstein<large> b{};
  bernstein_form(coefficients, degree, b.data());
  find_turning_points(coefficients, degree, b, found);
}

bool find_roots(const double* coefficients, int degree, double end, double noise,
                std::vector<Root>& found) {
  const double start = coefficients[0];
  double reach = noise;  // an upper bound of |p(theta) - p(0)|
  for (int k = 1; k <= degree; ++k) reach += std::abs(coefficients[k]);
  if (std::abs(start) > reach && sign(start) == sign(end)) return true;
  Bernstein<large> b{};
  bernstein_form(coefficients, degree, b.data());
  b[degree] = end;
  const auto [least, largest] = std::minmax_element(b.begin(), b.begin() + degree + 1);
  if (*least > noise || *largest < -noise) return true;
  std::vector<TurningPoint> turning_points;
  find_turning_points(coefficients, degree, b, turning_points);
  return find_roots([=](double theta) { return polynomial_at(coefficients, degree, theta); }, start,
                    turning_points, end, noise, found);
}

}  // namespace pendcore
