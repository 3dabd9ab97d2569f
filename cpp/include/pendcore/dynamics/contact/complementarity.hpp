/// \file
/// Forces that hold only so far: of what the joints at rest could do, what they do.
///
///     w = a + W lambda,   lower <= lambda <= upper
///     w_i = 0 where lambda_i is between its bounds, w_i >= 0 at the lower, w_i <= 0 at the upper
///
/// With W positive definite there is one answer, the least of 1/2 lambda.W lambda + a.lambda
/// between the bounds. With a and w accelerations of joints and lambda the torques of friction and
/// stops it says which joints stay at rest; with rates and impulses, how an impact ends.
/// All that is wrong is changed at once (Judice and Pires, Computers & Operations Research 21
/// (1994) 587); where that leads in circles, always downhill between the bounds (Bertsekas, SIAM
/// J. Control and Optimization 20 (1982) 221: Newton's method with projections).
#pragma once

#include <functional>
#include <vector>

namespace pendcore {

enum class Bound : signed char { lower = -1, between = 0, upper = 1 };

struct ForcesBetweenBounds {
  int size = 0;
  std::vector<double> W;  ///< (size, size), symmetric, positive definite
  std::vector<double> a, lower, upper;
  std::vector<double> lambda, w;  ///< the answer
  std::vector<Bound> at;          ///< and where each force is

  /// Is called now and then in what takes long, and may throw.
  std::function<void()> look;

  void resize(int count);
  /// False where it has not found the answer.
  bool solve();

 private:
  void solve_between();
  int wrong(int i) const;
  bool descend();
  void slope_at(const std::vector<double>& x, std::vector<double>& slope) const;
  bool goes_down(const std::vector<double>& from, const std::vector<double>& slope) const;
  double rounding(int i) const;  ///< of w
  std::vector<double> factor_;
  std::vector<int> free_;
};

/// A = L D L^T, in place of the lower half of A, (n, n) row-major, D on the diagonal; in one order
/// of operations, without square roots: in units twice as large each bit is the same.
void factor_symmetric(int n, double* a);
/// x becomes L^-1 x, and L^-T D^-1 x; x is zero before `first`.
void solve_lower(int n, const double* factor, double* x, int first = 0);
void solve_upper(int n, const double* factor, double* x);

}  // namespace pendcore
