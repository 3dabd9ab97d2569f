/// \file
/// A collocation method (collocation.hpp) applied to q'' = a(t, q, q'), as the loop sees it.
///
/// The stages Z = T W solve Z = h a F(Z); simplified Newton with the Jacobian J at the start of the
/// step splits into a real and a complex system,
///
///     (g - J) dW_1 = T^-1 F - g W_1,   g = real/h;    (g - J)(dW_2 + i dW_3) alike, g = (alpha +
///     i beta)/h
///
/// They are solved as systems of half the size (newton_systems.hpp).
///
/// The error is (g - J)^-1 (f(t, y) - u'(t)), g = real/h, with u the polynomial of the step. It is
/// of order 3, and damped where J is. The tolerances are for the error of the step itself, which is
/// of order 5. Therefore the estimate is compared with 0.1 rtol^(2/3), and with atol in proportion.
///
/// Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), IV.8: the
/// iteration and where it stops, error (8.20), starting values (8.5), predictive control (8.25).
/// Unlike in their program, J and its factors are made for every step. This is exact and cheap
/// here, and a step depends only on its start and on what saved_state() has of the step before.
/// Cost: three right-hand sides for each of two to four iterations, and one J.
#pragma once

#include <memory>
#include <vector>

#include "pendcore/integrate/general_system.hpp"
#include "pendcore/integrate/radau/collocation.hpp"
#include "pendcore/integrate/radau/newton_systems.hpp"
#include "pendcore/integrate/stepper.hpp"

namespace pendcore {

/// A system of two rows (q and qd) that also computes the derivatives of qdd, (row, row) each.
class DifferentiableSystem : public GeneralSystem {
 public:
  using GeneralSystem::GeneralSystem;
  virtual void jacobian(double t, const double* y, double* by_q, double* by_qd) const = 0;
};

class ImplicitRungeKutta final : public Stepper {
 public:
  ImplicitRungeKutta(const Collocation& method, std::unique_ptr<DifferentiableSystem> system,
                     bool compensated = false);

  const MethodInfo& info() const override { return method_.info; }
  int dimension() const override { return size_; }
  int controlled() const override { return state_; }
  int interpolant_degree() const override { return Collocation::degree; }

  void set_tolerances(const double* rtol, const double* atol) override;
  void start(const double* y, const double* dydt) override;
  void get_state(double* y) const override;
  void get_derivative(double* dydt) const override;
  void get_new_state(double* y) const override;
  void set_new_state(const double* y) override;
  void evaluate(double t, const double* y, double* dydt) override;

  /// If the iteration does not converge, the error is NaN, so that the step is not accepted.
  Attempt attempt(const TwoDouble& time, double h, double gain) override;
  void stay() override;
  void accept(double t_new) override;
  void interpolant(double h, double* coefficients) override;
  void sample(const double* coefficients, const TwoDouble& start, double h, const double* times,
              int count, double* states) const override;
  double stiffness(double /*h*/) override { return 0.0; }  // stability limits no step

  /// The low part of the state, if compensated. The polynomial, size and error of the accepted
  /// step, and the contraction of its iteration. Whether a step from here was tried already.
  std::vector<double> saved_state() const override;
  void restore(const std::vector<double>& memory) override;

 private:
  using Rows = std::vector<double>;

  void predict(double h);
  bool iterate(double t, double h);
  bool is_rounding(double h) const;
  void polish(double h);
  void advance();
  void integrate_quadratures(double t, double h);
  double squared_norm(const double* error) const;
  double scale(int i) const;
  void set_slope(double h);
  /// The coefficient of theta^(p + 1) of component i of u, through the stages.
  double power_of_stages(int p, int i) const {
    const Collocation::Row& row = method_.interpolant[p];
    return row[0] * stages_[i] + row[1] * stages_[size_ + i] + row[2] * stages_[2 * size_ + i];
  }
  void write_polynomial(double* rows) const;

  const Collocation& method_;
  std::unique_ptr<DifferentiableSystem> system_;
  int n_;      ///< numbers in q
  int state_;  ///< in q and qd
  int size_;   ///< and in the quadratures
  Rows rtol_, atol_;
  double newton_tolerance_ = 0.0;
  Rows y_, dydt_, y_new_;
  bool has_jacobian_ = false;
  Rows stages_, transformed_, rates_, increment_, trial_, error_;  ///< (3, size) or (size)
  Rows slope_;                                                     ///< h u'(t) of the dense output
  NewtonSystems systems_;
  int iterations_ = 0;  ///< iterations of the last attempt
  double h_ = 0.0;      ///< the size of the last attempt
  double squared_error_ = 0.0;
  double contraction_of_attempt_ = 1.0;
  // What the next step takes from the step before; h_before_ is 0 if there is none.
  Rows polynomial_;  ///< powers 1 to 3
  double h_before_ = 0.0;
  double log2_error_before_ = 0.0;
  double contraction_ = 1.0;
  bool is_retry_ = false;
  Rows low_, low_new_;  ///< the rounding errors of y and y_new, if compensated
};

}  // namespace pendcore
