// A line for each of a few runs: its name and a hash of every bit of its times and states, and of
// the events that were found. trajectory_hash.txt has all lines. The lines up to `tiny` are older
// than the effects: scenes without effects keep every bit. If you change a method's steps or an
// effect's law, you change lines of that file; say so in CHANGELOG.md. Each run is computed once
// more where the host rounds upward and flushes small numbers to zero: that changes no bit, and
// what the host has switched on is there again after the run.
#include <array>
#include <cfenv>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <limits>

#include "arithmetic/bits.hpp"
#include "pendcore/pendcore.hpp"
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

using namespace pendcore;

namespace {

using Row = std::vector<double>;

/// A host that rounds upward and flushes small numbers to zero, where the processor can do so.
class OddHost {
 public:
  OddHost() {
    std::fegetenv(&found_);
#ifdef FE_UPWARD
    std::fesetround(FE_UPWARD);
#endif
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() | 0x8040);  // results, and operands
#elif defined(__aarch64__)
    unsigned long switches = 0;
    asm volatile("mrs %0, fpcr" : "=r"(switches));
    asm volatile("msr fpcr, %0" : : "r"(switches | 1UL << 24));  // FZ, for both
#endif
  }
  ~OddHost() { std::fesetenv(&found_); }

  static bool is_odd() {
    volatile double least = std::numeric_limits<double>::min();  // halved while running
#if defined(__x86_64__) || defined(__aarch64__)
    return std::fegetround() == FE_UPWARD && 0.5 * least == 0.0;
#elif defined(FE_UPWARD)
    return std::fegetround() == FE_UPWARD;
#else
    return least > 0.0;
#endif
  }

 private:
  std::fenv_t found_;
};

std::uint64_t hash_of(const Solution& solution) {
  std::uint64_t h = fingerprint(solution);
  for (const FoundEvent& found : solution.found) {
    h = hash_bits(h, std::array{found.t, static_cast<double>(found.event),
                                static_cast<double>(found.direction)});
    h = hash_bits(hash_bits(h, found.y), found.y_before);
  }
  return h;
}

bool is_wrong = false;

void print(const std::string& name, const Scene& scene, const Row& q0, const Row& qd0, double t_end,
           const Options& options = {}) {
  const std::uint64_t h = hash_of(simulate(scene, q0, qd0, 0.0, t_end, options));
  std::printf("%s %016" PRIx64 "\n", name.c_str(), h);
  const OddHost host;
  const bool has_same_bits = hash_of(simulate(scene, q0, qd0, 0.0, t_end, options)) == h;
  if (has_same_bits && OddHost::is_odd()) return;
  is_wrong = true;
  std::printf("%s: an odd host's bits %d, switches kept %d\n", name.c_str(), int{has_same_bits},
              int{OddHost::is_odd()});
}

Options options_of(const std::string& method, double rtol) {
  Options options{.rtol = {rtol}};
  options.method = method;
  if (method == "rk4") options.step = 0.01;
  return options;
}

Scene equal_rods(int n, std::vector<Effect> effects = {}) {
  return {.links = std::vector<Link>(n, Link::uniform_rod(0.4, 0.3)),
          .effects = std::move(effects)};
}

const std::vector<Link> two_rods(2, Link::uniform_rod(1.0, 0.7));
const Row high = {-1.4, -1.1}, still = {0.0, 0.0};

void print_explicit_runs() {
  const Scene book = Scene::textbook();
  const Scene rod{.links = {Link::uniform_rod(1.3, 0.8)}, .gravity = 9.80665};
  const Scene uneven{.links = {Link::uniform_rod(2.5, 0.7), Link::point_mass(0.4, 1.6)},
                     .gravity = 9.81};
  const Scene floating{.links = book.links, .gravity = 0.0};
  const Options plain = options_of("dopri5", 1e-9);
  Options tight = options_of("dopri5", 1e-12);
  print("textbook", book, {0.25 * M_PI, M_PI / 3}, still, 60, plain);
  print("chaotic", book, high, still, 60, tight);
  print("backward", uneven, {2.8, -0.4}, {1.5, -2.0}, -20, plain);
  print("rod", rod, {-1.2}, {0}, 60, plain);
  print("far", book, {3e8, -2e7}, {30, -70}, 5, plain);
  print("tiny", floating, {0.3, 0.9}, {3e-160, -1e-160}, 1e159, plain);

  const Scene busy{
      .links = {Link::uniform_rod(1.0, 1.0), Link::uniform_rod(0.6, 0.7)},
      .effects = {ViscousJoint{.joint = 1, .damping = 0.02, .damping2 = 0.01},
                  RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.03, .wind = {2, -1}},
                  Motor{.joint = 2, .sinusoid = Sinusoid{0.5, 3.0, 0.1}},
                  Motor{.joint = 1, .pd = PD{2.0, 0.3, 1.0}, .limit = 0.7},
                  DryJointFriction{.joint = 2, .coulomb = 0.01, .static_ = 0.02, .exponent = 1.3},
                  RotorInertia{.joint = 2, .armature = 0.01},
                  DrivenPivot{.y = Sinusoid{0.05, 11.0, 0.0}}}};
  const Row bent = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7},
            rates = {4.0, -9.0, 1.0, 2.0, 3.0, 4.0, 5.0};
  const Scene chain = equal_rods(7, busy.effects);
  print("effects", busy, {0.3, 0.9}, {4.0, -9.0}, 4, plain);
  print("chain", equal_rods(7), bent, Row(7, 0.0), 5, plain);
  tight.ledger = true;
  print("ledger", chain, bent, rates, 2, tight);
  tight.compensated = true;
  print("compensated", book, high, still, 60, tight);
  print("compensated chain", chain, bent, rates, 2, tight);
}

/// Rods that bounce and rub, a rod that sticks and is torn loose, and dampers, with events.
void print_switching_and_stiff_runs() {
  const Scene bouncing{.links = two_rods,
                       .effects = {JointStop{.joint = 1, .range = {-0.4, 1.9}, .restitution = 0.7},
                                   JointStop{.joint = 2, .range = {-0.5, 0.9}},
                                   DryJointFriction{.joint = 2, .coulomb = 0.1, .static_ = 0.2}}};
  const Scene stick{.links = two_rods,
                    .gravity = 0.0,
                    .effects = {DryJointFriction{.joint = 1, .coulomb = 0.4, .static_ = 0.6},
                                Motor{.joint = 1, .sinusoid = Sinusoid{1.0, 3.0, 0.0}},
                                ViscousJoint{.joint = 2, .damping = 0.05}}};
  const Scene damper{.links = two_rods, .effects = {ViscousJoint{.joint = 2, .damping = 1e5}}};
  for (const std::string method : {"dopri5", "radau5", "dopri5-radau5", "dop853", "rk4"}) {
    Options options = options_of(method, 1e-7);
    options.events = {{.function = events::LinkAngle{.link = 2, .value = 1.5}},
                      {.function = events::TipLine{.point = {0.3, 0.9}, .normal = {1.0, 0.5}}},
                      {.function = events::RateZero{.joint = 1, .link = {}}, .direction = -1}};
    print("bouncing " + method, bouncing, {0.4, 0.8}, {2.0, -3.0}, 4, options);
    print("stick " + method, stick, {0.4, 0.8}, {0.0, 0.5}, 8, options);
    if (method == "dopri5") continue;
    if (method.ends_with("radau5")) {  // with the damper, others take long
      print("damper " + method, damper, {0.8, 1.0}, still, 2, options);
    }
    options.compensated = options.ledger = true;
    print("kept bouncing " + method, bouncing, {0.4, 0.8}, {2.0, -3.0}, 4, options);
  }
}

/// Runs with tables other than the first, in closed forms and with any number of links.
void print_other_tables() {
  for (const std::string method : {"dop853", "rk4"}) {
    Options options = options_of(method, 1e-11);
    print("textbook " + method, Scene::textbook(), high, still, 60, options);
    print("chain " + method, equal_rods(7), Row(7, 0.5), Row(7, -2.0), 5, options);
    options.compensated = true;
    print("compensated " + method, Scene::textbook(), high, still, 60, options);
  }
}

/// Implicit steps whose complex system is one of three links, of some, and of many; series of few
/// links, bare and with torques of each kind.
void print_stiff_chains_and_series() {
  for (const int n : {3, 10, 20}) {
    const Scene chain = equal_rods(n, {ViscousJoint{.joint = n, .damping = 1e3}});
    print("stiff chain radau5, " + std::to_string(n) + " links", chain, Row(n, 0.5), Row(n, -2.0),
          0.2, options_of("radau5", 1e-6));
  }
  const Options series = options_of("taylor", 1e-11);
  const std::vector<Effect> torques = {ViscousJoint{.joint = 1, .damping = 0.02, .damping3 = 0.01},
                                       Motor{.joint = 2, .sinusoid = Sinusoid{0.5, 3.0, 0.1}},
                                       Motor{.joint = 1, .pd = PD{2.0, 0.3, 1.0}}};
  for (const int n : {2, 3, 4}) {
    const std::string name = " taylor, " + std::to_string(n) + " links";
    const Row q0(n, 0.5), qd0(n, -2.0);
    if (n > 2) print("bare" + name, equal_rods(n), q0, qd0, 5, series);
    print("torques" + name, equal_rods(n, torques), q0, qd0, 5, series);
  }
}

/// Runs that name no method: each branch of the rule, and a run that turns out to be stiff.
void print_runs_without_a_method() {
  const Scene drag{.links = two_rods,
                   .effects = {RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.03}}};
  const Scene damper{.links = two_rods, .effects = {ViscousJoint{.joint = 2, .damping = 1e5}}};
  print("default textbook", Scene::textbook(), high, still, 60);
  print("default drag", drag, {0.3, 0.9}, {4.0, -9.0}, 4);
  print("default loose drag", drag, {0.3, 0.9}, {4.0, -9.0}, 4, {.rtol = {1e-4}});
  print("default damper", damper, {0.8, 1.0}, still, 2);
}

}  // namespace

int main() {
  print_explicit_runs();
  print_switching_and_stiff_runs();
  print_other_tables();
  print_stiff_chains_and_series();
  print_runs_without_a_method();
  return is_wrong ? 1 : 0;
}
