/// \file
/// A system whose size the compiler does not know, for steppers that have their state in memory.
#pragma once

#include "pendcore/vector.hpp"

namespace pendcore {

/// dy/dt of a state in memory: two rows (q and qd) of `row` numbers each, and then quadratures.
class GeneralSystem {
 public:
  GeneralSystem(int row_size, int quadrature_count)
      : row(row_size), quadratures(quadrature_count) {}
  virtual ~GeneralSystem() = default;

  /// Computes the derivative (row, row, quadratures) of the state (row, row).
  virtual void operator()(double t, const double* y, double* dydt) const = 0;

  const int row;
  const int quadratures;
};

/// A system of two rows (q and qd) that also computes the derivatives of qdd, (row, row) each.
class DifferentiableSystem : public GeneralSystem {
 public:
  using GeneralSystem::GeneralSystem;
  virtual void jacobian(double t, const double* y, Eigen::Ref<Matrix> by_q,
                        Eigen::Ref<Matrix> by_qd) const = 0;
  /// Computes the derivatives of three states at three times, all in a row.
  virtual void derivatives_of_three(const double* t, const double* y, double* dydt) const {
    const int size = 2 * row + quadratures;
    for (int k = 0; k < 3; ++k) (*this)(t[k], y + k * size, dydt + k * size);
  }
};

}  // namespace pendcore
