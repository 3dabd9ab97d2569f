/// \file
/// The changes of a motion by its Taylor series on numbers with slopes along eight names at once
/// (dynamics/series).
///
/// The coefficients of a change are the slopes of the coefficients of the motion; those of two
/// links have a recurrence of their own (double_pendulum_along_names.hpp). A series from a state
/// and its changes has the changes as far as it converges, whichever method makes the run: it may
/// serve many steps, or end within one. Where it ends follows from how fast the slopes fall: with
/// N the sum of the last four orders there, and M that of the four before, what is left out is
/// taken as 2 N (N/M), where N/M is at most a half. Where N is rounding, the series is looked at
/// farther on.
///
/// Source: Griewank and Walther, Evaluating Derivatives (2008), chapter 13, for series on dual
/// numbers; Jorba and Zou, A software package for the numerical integration of ODEs by means of
/// high-order Taylor methods, Experimental Mathematics 14 (2005), for steps from the last orders.
#pragma once

#include <memory>
#include <vector>

#include "analysis/variational_equations.hpp"

namespace pendcore {

class CoefficientsOfChanges;

class ChangesBySeries {
 public:
  ChangesBySeries();
  ~ChangesBySeries();

  /// Takes the laws in force and the changes at the start, (2n, names); those of names that are not
  /// finite stay so. Returns false where the laws have no series. The first series, since laws
  /// changed or none converged, is looked at after `first_reach`, s, others where the last ended.
  /// Each may leave out the tolerance of a change, a share of it.
  bool start(const VariationalEquations& equations, const Matrix& changes, double first_reach,
             double tolerance);
  /// Computes the series from where they start, at a state y. Returns how far they reach, s,
  /// forward or backward in time; 0 where none converges.
  double expand(double t, const double* y, bool forward);
  /// Writes the changes at a time since the start of the series, s.
  void evaluate(double since, Matrix& changes);
  /// Writes the state there, of the motion that starts where the series does.
  void state(double since, double* y) const;
  /// Lets the next series start from there.
  void move_start(double since);

 private:
  struct Part;

  void take_laws(const VariationalEquations& equations);
  void expand_parts(double t, const double* y, double sigma);

  std::vector<Part> parts_;
  std::unique_ptr<CoefficientsOfChanges> common_;
  std::vector<double> sums_;
  int laws_ = 0;  ///< VariationalEquations::changes_of_laws() of the parts
  double tolerance_ = 0.0;
  double reach_ = 0.0;  ///< s, of the last series; 0 if there is none
  double per_sigma_ = 1.0;
};

}  // namespace pendcore
