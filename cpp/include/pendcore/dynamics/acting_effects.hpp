/// \file
/// The effects of a scene, compiled: the couples on each row of joints, summed, and a list of laws
/// for the rest; nothing for what the scene does not have.
///
/// All couples of a row cost what one does, and effects of one kind on different joints of a row
/// share a law. Constants of the mass matrix are not here (inertia.hpp).
#pragma once

#include <memory>
#include <tuple>
#include <variant>
#include <vector>

#include "pendcore/arithmetic/dual.hpp"
#include "pendcore/arithmetic/sine_cosine.hpp"
#include "pendcore/scene/scene.hpp"

namespace pendcore {

/// The first two waves of a pendulum of two links, on its equations:
/// Q += sum_k sin(wave k) (torque_k + on_sine_k sin q + on_cosine_k cos q).
struct TwoWaves {
  Pair angular_frequency{}, phase{};
  Pair torque[2]{};     ///< of motors
  Pair on_sine[2]{};    ///< of the pivot: a xdd_0
  Pair on_cosine[2]{};  ///< and -a ydd_0
};

/// What does not depend on the width of a row: the modes of the effects, the waves that they
/// share, and what moves the pivot. Belongs to one run, and to one thread: modes change along it.
class EffectsInForce {
 public:
  virtual ~EffectsInForce() = default;

  /// Freezes effect number i (from 0) to a mode.
  virtual void put_mode(std::size_t i, int mode) = 0;

  /// Eliminates a joint (from 0), or sets it free.
  void hold(int joint, bool is_held);

  /// Sine and cosine of the waves from number `known` on, at time t.
  PENDCORE_INLINE void compute_waves(double t, int known) const {
    for (int k = known; k < waves; k += 4) {
      Pack<4> s, c;
      sine_cosine(wave_angles<Pack<4>>(t, k), s, c);
      store(&wave_sine[k], s);
      store(&wave_cosine[k], c);
    }
  }
  template <class Real>
  PENDCORE_INLINE Real wave_angles(double t, int k) const {
    return fma(load<Real>(&angular_frequency[k]), broadcast<Real>(t), load<Real>(&phase[k]));
  }

  /// Acceleration (m/s^2) and velocity (m/s) of the pivot, once the waves are known.
  PENDCORE_INLINE void pivot_acceleration(double t, double& x, double& y) const {
    x = y = 0.0;
    for (const auto& law : pivots) law->add_acceleration(t, wave_sine.data(), x, y);
  }
  PENDCORE_INLINE void pivot_velocity(double t, double& x, double& y) const {
    x = y = 0.0;
    for (const auto& law : pivots) law->add_velocity(t, wave_cosine.data(), x, y);
  }

  /// What a function of the user's adds to Q (n), which comes zeroed.
  PENDCORE_INLINE void call(const CompiledUser& user, double t, const double* q, const double* qd,
                            double* Q) const {
    user(t, static_cast<int>(held.size()), q, qd, Q);
  }
  /// With its change along the slopes, by central differences: it is a function of doubles.
  void call(const CompiledUser& user, double t, const Dual<double>* q, const Dual<double>* qd,
            Dual<double>* Q) const;

  std::vector<Effect> effects;      ///< compiled
  std::vector<int> modes;           ///< of each effect
  std::vector<int> number_of_wave;  ///< of each effect that a wave drives
  std::vector<JointWave> joint_waves;
  std::vector<char> held;  ///< of each joint: it does not turn, and is eliminated
  std::vector<std::shared_ptr<DrivenPivot::Law>> pivots;
  std::vector<CompiledUser> users;
  bool has_modes = false;   ///< some law is smooth only in pieces
  bool has_forces = false;  ///< some law adds forces, not couples alone
  bool any_held = false;

  int waves = 0;
  TwoWaves two_waves;
  std::vector<double> angular_frequency;  ///< of the waves, filled up to whole packs
  std::vector<double> phase;
  mutable std::vector<double> wave_sine;
  mutable std::vector<double> wave_cosine;

 protected:
  explicit EffectsInForce(const Scene& scene);
  int add_wave(const Sinusoid& wave);  ///< its number
  void finish_waves();

 private:
  mutable std::vector<double> user_room_;
};

/// A law, and which effects share it: those of one kind and group on its row, a lane each. It is
/// aligned as Couples are, and empty for a kind of effect without a law.
template <class Kind, class Row>
struct alignas(sizeof(Row)) SharedLaw {};
template <HasLaw Kind, class Row>
struct alignas(sizeof(Row)) SharedLaw<Kind, Row> {
  typename Kind::template Law<Row> law;
  int row;
  double group;
  unsigned taken = 0;  ///< lanes
};

/// The laws of a scene, kind by kind in the order of the registry, and one of them.
template <class Registry, class Row>
struct LawsOf;
template <class... Kinds, class Row>
struct LawsOf<std::variant<Kinds...>, Row> {
  using Storage = std::tuple<std::vector<SharedLaw<Kinds, Row>>...>;
  using Pointer = std::variant<const SharedLaw<Kinds, Row>*...>;
};

/// For rows of that width.
template <class Row>
class ActingEffects final : public EffectsInForce {
 public:
  static constexpr int width = Lanes<Row>::width;

  using Laws = LawsOf<Effect, Row>;

  struct Entry {
    typename Laws::Pointer law;
    int row;

    std::size_t kind() const { return law.index(); }  ///< its place in the registry
  };

  explicit ActingEffects(const Scene& scene);
  ActingEffects(const ActingEffects&) = delete;  // its entries point to its own laws
  ActingEffects& operator=(const ActingEffects&) = delete;
  void put_mode(std::size_t i, int mode) override;

  /// Calls visit(law) for the law of an entry, of its own type.
  template <class Visit>
  PENDCORE_INLINE static void visit(const Entry& entry, Visit visit) {
    visit_one_of(entry, visit, std::make_index_sequence<std::variant_size_v<Effect>>{});
  }

  /// Adds what an entry does to the loads of its row.
  template <class At, class Loads>
  PENDCORE_INLINE static void add(const Entry& entry, const At& at, Loads& loads) {
    visit(entry, [&](const auto& law) __attribute__((always_inline)) { law.add(at, loads); });
  }

  std::vector<Couples<Row>> couples;  ///< of the rows that have some
  std::vector<Entry> entries;         ///< in the order in which the scene has them first

  /// The same through a pointer, on the instruction set of this processor: for forms in which the
  /// list is rare.
  template <class At, class Loads>
  static void add_all(const ActingEffects* effects, const At* at, Loads* loads) {
    static const auto add_on_this_processor = fastest<&add_in_turn<At, Loads>>();
    add_on_this_processor(effects, at, loads);
  }

 private:
  template <class At, class Loads>
  PENDCORE_INLINE static void add_in_turn(const ActingEffects* effects, const At* at,
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
    using Kind = std::variant_alternative_t<kind, Effect>;
    if constexpr (HasLaw<Kind>) {
      if (entry.law.index() == kind) visit(std::get<kind>(entry.law)->law);
    }
  }

  template <class Kind>
  std::vector<SharedLaw<Kind, Row>>& laws_of() {
    return std::get<std::vector<SharedLaw<Kind, Row>>>(laws_);
  }
  template <class Kind>
  void add_law(std::size_t i, const Kind& effect, const Scene& scene);

  struct Place {
    std::size_t number = 0;  ///< among the laws of its kind, or among the pivots
    int lane = 0;
  };
  std::vector<Place> places_;  ///< of each effect of the scene
  typename Laws::Storage laws_;
};

/// What the functions of a user add up to, N m.
template <class Row>
Row of_users(const EffectsInForce& effects, double t, const Row& q, const Row& qd);

/// For a chain of that scene's length.
std::shared_ptr<EffectsInForce> effects_in_force(const Scene& scene);

}  // namespace pendcore
