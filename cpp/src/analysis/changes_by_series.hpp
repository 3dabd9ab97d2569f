/// \file
/// The changes of a motion along one step, by the Taylor series of the motion on numbers with
/// slopes along eight names at once (dynamics/series).
///
/// The coefficients of a change are the slopes of the coefficients of the motion; those of two
/// links have a recurrence of their own (double_pendulum_along_names.hpp). So the series from the
/// state and its changes at the start of a step has the changes anywhere in the step, whichever
/// method made the step. Its order follows from how fast the slopes fall: with N the largest of the
/// last four at the end of the step, and M that of the four before, what is left out is taken as
/// N (N/M)/(1 - N/M).
///
/// Source: Griewank and Walther, Evaluating Derivatives (2008), chapter 13, for series on dual
/// numbers. Cost: for two links, six times a step of the run, and two more for each further eight
/// names; for a chain, some twelve for each eight.
#pragma once

#include <memory>
#include <vector>

#include "analysis/variational_equations.hpp"

namespace pendcore {

class ChangesInCommon;

class ChangesBySeries {
 public:
  ChangesBySeries();
  ~ChangesBySeries();

  /// Computes the series of a step of length h (s) from a state y and its changes, (2n, names),
  /// each to a share of its size. Columns that are not finite are left so. Returns false where the
  /// laws that are in force have no series, or the series does not converge.
  bool expand(const VariationalEquations& equations, double t, const double* y, double h,
              const Matrix& changes, double tolerance);
  /// Writes the changes at a share of that step.
  void evaluate(double share, Matrix& changes);

 private:
  struct Part;
  struct Convergence {
    bool is_there;
    int wanted_order;  ///< the lowest one with which the next step is likely to have it
  };

  void take_laws(const VariationalEquations& equations);
  void set_order(int order, Eigen::Index size);
  Convergence look_at(Part& part, double tolerance) const;

  std::vector<Part> parts_;
  std::unique_ptr<ChangesInCommon> common_;
  std::vector<double> sums_;
  int laws_ = 0;  ///< VariationalEquations::changes_of_laws() of the parts
  int order_ = 0;
  int wanted_order_ = 0;
  double x_ = 0.0;  ///< the step in units of sigma
};

}  // namespace pendcore
