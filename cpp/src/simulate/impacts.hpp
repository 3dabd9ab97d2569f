/// \file
/// The impacts of joints on their stops, and what the joints do after them. The laws are those of
/// dynamics/contact/impact_laws.hpp.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "simulate/modes.hpp"

namespace pendcore {

/// A run knows this of the order in which joints struck their stops.
struct ImpactOrder {
  /// s, the time at which noticeable impacts first came so close together that their order is not
  /// known; NaN if it always was.
  double lost = std::numeric_limits<double>::quiet_NaN();
  double last_impact = std::numeric_limits<double>::quiet_NaN();  ///< s, NaN before the first
  /// (n), 1 for the joints that struck at the last impact, or so shortly before it that doubles
  /// hardly distinguish the times
  std::vector<int> struck;
};

class Impacts {
 public:
  /// `accounts` are the accounts of the ledger, which the state has after angles and rates if the
  /// ledger is kept.
  Impacts(const EquationsOfMotion& equations, Modes& modes, const std::vector<Account>& accounts);

  /// Computes the impact of the joints that move into their stops, and the modes after it: rates
  /// have jumped, so that every law with modes may be in another one. At the beginning of a run,
  /// `begins`, all joints that touch their stops take part in the first impacts.
  void strike(double t, double* y, bool begins);

  const ImpactOrder& order() const { return order_; }
  void restore(const ImpactOrder& order) { order_ = order; }
  /// The remark of a run in which the order of impacts was lost, or empty.
  std::string remark() const;

 private:
  bool bounce_in_turn(double t, double* y, bool begins);
  bool loses_order_of(const double* y);
  bool capture(double t, const double* y);
  void book(Account account, double value, double* y) const;

  EquationsOfMotion equations_;
  Modes& modes_;
  HeldJoints& joints_;
  std::vector<Account> accounts_;
  int n_;
  ImpactOrder order_;
};

}  // namespace pendcore
