/// \file
/// The compiled effects of a scene: the sum of the couples on each row of joints, and a list of the
/// other laws. What a scene does not have costs nothing.
///
/// All couples of a row together cost as much as one, and effects of one kind on different joints
/// of a row share a law. Effects that only change constants of the mass matrix are in inertia.hpp.
#pragma once

#include <bit>
#include <memory>
#include <tuple>
#include <variant>
#include <vector>

#include "arithmetic/dual.hpp"
#include "dynamics/drives.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

/// The part of the compiled effects that does not depend on the width of a row: modes, waves, and
/// the motion of the pivot. An object belongs to one run and one thread, because modes change along
/// the run.
class EffectsOfRun : public Drives<double> {
 public:
  virtual ~EffectsOfRun() = default;

  /// Freezes effect number i (from 0) to a mode.
  virtual void put_mode(std::size_t i, int mode) = 0;

  /// All about the effects but the values of their parameters: which laws there are, and what each
  /// acts on. Only trajectories that have this in common can share lanes.
  virtual std::vector<int> kinds() const = 0;

  /// Eliminates a joint (counted from 0), or sets it free.
  void hold(int joint, bool is_held);

  /// Computes what a user's function adds to Q (n); Q is zero on entry.
  PENDCORE_INLINE void call(const UserLaw& user, double t, const double* q, const double* qd,
                            double* Q) const {
    user(t, static_cast<int>(held.size()), q, qd, Q);
  }
  /// The same with the derivative along the slopes. It is taken by central differences, because the
  /// function takes doubles.
  void call(const UserLaw& user, double t, const Dual<double>* q, const Dual<double>* qd,
            Dual<double>* Q) const;

  std::vector<Effect> effects;
  std::vector<int> modes;           ///< the mode of each effect
  std::vector<int> number_of_wave;  ///< the first wave of each effect, or -1
  std::vector<char> held;           ///< whether each joint is eliminated, as it does not turn
  std::vector<UserLaw> users;
  bool has_modes = false;   ///< some law is only piecewise smooth
  bool has_forces = false;  ///< some law adds forces, not only couples
  bool any_held = false;
  bool are_couples_alone = false;  ///< no waves, pivots, users' functions or laws of the list
  WavesOf<Pair> two_waves;

 protected:
  explicit EffectsOfRun(const Scene& scene);
  void put_pivot(std::size_t i, const PivotLaw& law);

  /// The number of an effect among the pivots, the functions or the laws like its own.
  std::vector<std::size_t> number_of_law_;

 private:
  mutable std::vector<double> user_room_;
};

/// A law that effects on one row share, with a lane for each. Its alignment is the one
/// of Couples.
template <template <class> class Law, class Row>
struct alignas(std::bit_floor(sizeof(Row))) SharedLaw {
  Law<Row> law;
  int row;
  Account account;     ///< where the ledger books its work
  unsigned taken = 0;  ///< a bit for each lane in use
};

/// The law of one joint or link of a row.
template <template <class> class Law>
PENDCORE_INLINE Law<double> law_of_lane(const Law<Pack<4>>& all, int lane) {
  Law<double> one;
  each_field(one, all, [lane](double& to, const Pack<4>& from) { to = from[lane]; });
  if constexpr (requires { Law<double>::shared(one); }) {
    Law<double>::shared(one) = Law<Pack<4>>::shared(all);
  }
  return one;
}

/// The laws of a scene, a vector for each law of the list, and a pointer to one of them.
template <class List>
struct LawsOf;
template <template <class> class... Laws, class Row>
struct LawsOf<std::variant<Laws<Row>...>> {
  using Storage = std::tuple<std::vector<SharedLaw<Laws, Row>>...>;
  using Pointer = std::variant<const SharedLaw<Laws, Row>*...>;
};

/// The compiled effects of a scene whose links are taken in rows of `width`.
template <class AnyRow>
class EffectsInRows final : public EffectsOfRun {
 public:
  using Row = AnyRow;
  using Number = double;
  static constexpr int width = Lanes<Row>::width;

  using Laws = LawsOf<LawOn<Row>>;

  struct Entry {
    typename Laws::Pointer law;
    int row;
    Account account;
  };

  explicit EffectsInRows(const Scene& scene);
  EffectsInRows(const EffectsInRows&) = delete;  // its entries point to its own laws
  EffectsInRows& operator=(const EffectsInRows&) = delete;
  void put_mode(std::size_t i, int mode) override;
  std::vector<int> kinds() const override;

  static constexpr bool are_any() { return true; }

  /// Calls visit(law) with the law of an entry in its own type.
  template <class Visit>
  PENDCORE_INLINE static void visit(const Entry& entry, Visit visit) {
    visit_one_of(entry, visit,
                 std::make_index_sequence<std::variant_size_v<typename Laws::Pointer>>{});
  }

  /// Adds the law of an entry to the loads of its row.
  template <class At, class Loads>
  PENDCORE_INLINE static void add(const Entry& entry, const At& at, Loads& loads) {
    visit(entry, [&](const auto& law) __attribute__((always_inline)) { law.add(at, loads); });
  }

  std::vector<Couples<Row>> couples;  ///< one for each row that has couples
  std::vector<Entry> entries;         ///< in the order of their first effects in the scene

  /// Adds all entries, compiled for the instruction set of this processor. It is for forms of the
  /// equations that rarely have entries.
  template <class At, class Loads>
  static void add_all(const EffectsInRows* effects, const At* at, Loads* loads) {
    on_this_processor<&add_in_turn<At, Loads>>(effects, at, loads);
  }

 private:
  template <class At, class Loads>
  PENDCORE_INLINE static void add_in_turn(const EffectsInRows* effects, const At* at,
                                          Loads* loads) {
    for (const Entry& entry : effects->entries) add(entry, *at, *loads);
  }
  void sum_couples(int joint);
  void find_two_waves(const Scene& scene);

  template <class Visit, std::size_t... kinds>
  PENDCORE_INLINE static void visit_one_of(const Entry& entry, Visit& visit,
                                           std::index_sequence<kinds...>) {
    (visit_if<kinds>(entry, visit), ...);
  }
  template <std::size_t kind, class Visit>
  PENDCORE_INLINE static void visit_if(const Entry& entry, Visit& visit) {
    if (entry.law.index() == kind) visit(std::get<kind>(entry.law)->law);
  }

  template <template <class> class Law>
  std::vector<SharedLaw<Law, Row>>& laws_like(const Law<double>& /*one*/) {
    return std::get<std::vector<SharedLaw<Law, Row>>>(laws_);
  }
  void add_law(std::size_t i);

  std::vector<int> place_of_;  ///< the joint or link of each effect, from 0; -1 if none
  std::vector<LinkConstants> link_there_;
  typename Laws::Storage laws_;
};

/// The sum of what the users' functions add, N m.
template <class Row>
Row of_users(const EffectsOfRun& effects, double t, const Row& q, const Row& qd);

}  // namespace pendcore
