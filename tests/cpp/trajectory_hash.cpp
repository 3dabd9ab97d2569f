// A line for each of a few runs: its name and a hash of every bit of its times and states, and of
// the events that were found. trajectory_hash.txt has all lines. The lines up to `tiny` are older
// than the effects: scenes without effects keep every bit. If you change a method's steps or an
// effect's law, you change lines of that file; say so in CHANGELOG.md.
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>

#include "arithmetic/bits.hpp"
#include "pendcore/pendcore.hpp"

using namespace pendcore;

namespace {

void print(const char* name, const Solution& solution) {
  std::uint64_t h = fingerprint(solution);
  for (const FoundEvent& found : solution.found) {
    h = hash_bits(h, std::array{found.t, static_cast<double>(found.event),
                                static_cast<double>(found.direction)});
    h = hash_bits(hash_bits(h, found.y), found.y_before);
  }
  std::printf("%s %016" PRIx64 "\n", name, h);
}

/// Runs with tables other than the first, in closed forms and with any number of links.
void print_explicit_runs() {
  const Scene chain{.links = std::vector<Link>(7, Link::uniform_rod(0.4, 0.3))};
  for (const std::string_view method : {"dop853", "rk4"}) {
    Options options;
    options.method = method;
    options.rtol = {1e-11};
    if (method == "rk4") options.step = 0.01;
    const auto name = [method](std::string scene) { return (scene += ' ') += method; };
    print(name("textbook").c_str(),
          simulate(Scene::textbook(), {-1.4, -1.1}, {0, 0}, 0, 60, options));
    print(name("chain").c_str(),
          simulate(chain, std::vector(7, 0.5), std::vector(7, -2.0), 0, 5, options));
    options.compensated = true;
    print(name("compensated").c_str(),
          simulate(Scene::textbook(), {-1.4, -1.1}, {0, 0}, 0, 60, options));
  }
}

/// Rods that bounce and rub, a rod that sticks and is torn loose, and dampers, with events.
void print_switching_and_stiff_runs() {
  const std::vector<Link> rods(2, Link::uniform_rod(1.0, 0.7));
  const Scene bouncing{.links = rods,
                       .effects = {JointStop{.joint = 1, .range = {-0.4, 1.9}, .restitution = 0.7},
                                   JointStop{.joint = 2, .range = {-0.5, 0.9}},
                                   DryJointFriction{.joint = 2, .coulomb = 0.1, .static_ = 0.2}}};
  const Scene stick{.links = rods,
                    .gravity = 0.0,
                    .effects = {DryJointFriction{.joint = 1, .coulomb = 0.4, .static_ = 0.6},
                                Motor{.joint = 1, .sinusoid = Sinusoid{1.0, 3.0, 0.0}},
                                ViscousJoint{.joint = 2, .damping = 0.05}}};
  const Scene damper{.links = rods, .effects = {ViscousJoint{.joint = 2, .damping = 1e5}}};
  Options options;
  options.rtol = {1e-7};
  options.events = {{.function = events::LinkAngle{.link = 2, .value = 1.5}},
                    {.function = events::TipLine{.point = {0.3, 0.9}, .normal = {1.0, 0.5}}},
                    {.function = events::RateZero{.joint = 1, .link = {}}, .direction = -1}};
  for (const std::string_view method : {"dopri5", "radau5", "dopri5-radau5", "dop853", "rk4"}) {
    options.method = method;
    if (method == "rk4") options.step = 0.01;
    const auto name = [method](std::string scene) { return (scene += ' ') += method; };
    print(name("bouncing").c_str(), simulate(bouncing, {0.4, 0.8}, {2.0, -3.0}, 0, 4, options));
    print(name("stick").c_str(), simulate(stick, {0.4, 0.8}, {0.0, 0.5}, 0, 8, options));
    if (method == "dopri5") continue;
    if (method == "radau5" || method == "dopri5-radau5") {  // with the damper, others take long
      print(name("damper").c_str(), simulate(damper, {0.8, 1.0}, {0, 0}, 0, 2, options));
    }
    options.compensated = options.ledger = true;
    print(name("kept bouncing").c_str(),
          simulate(bouncing, {0.4, 0.8}, {2.0, -3.0}, 0, 4, options));
    options.compensated = options.ledger = false;
  }
}

/// Implicit steps whose complex system is one of three links, of some, and of many.
void print_stiff_chains() {
  Options options;
  options.method = "radau5";
  options.rtol = {1e-6};
  for (const int n : {3, 10, 20}) {
    const Scene chain{.links = std::vector<Link>(n, Link::uniform_rod(0.4, 0.3)),
                      .effects = {ViscousJoint{.joint = n, .damping = 1e3}}};
    const std::string name = "stiff chain radau5, " + std::to_string(n) + " links";
    print(name.c_str(),
          simulate(chain, std::vector(n, 0.5), std::vector(n, -2.0), 0, 0.2, options));
  }
}

/// Series of few links, bare and with torques of each kind.
void print_series() {
  Options options;
  options.method = "taylor";
  options.rtol = {1e-11};
  const std::vector<Effect> torques = {
      ViscousJoint{.joint = 1, .damping = 0.02, .damping3 = 0.01},
      Motor{.joint = 2, .sinusoid = Sinusoid{0.5, 3.0, 0.1}},
      Motor{.joint = 1, .pd = PD{2.0, 0.3, 1.0}},
  };
  for (const int n : {2, 3, 4}) {
    Scene scene{.links = std::vector<Link>(n, Link::uniform_rod(0.4, 0.3))};
    const std::vector<double> start(n, 0.5);
    const std::vector<double> rates(n, -2.0);
    const auto name = [n](const std::string& what) {
      return what + " taylor, " + std::to_string(n) + " links";
    };
    if (n > 2) print(name("bare").c_str(), simulate(scene, start, rates, 0, 5, options));
    scene.effects = torques;
    print(name("torques").c_str(), simulate(scene, start, rates, 0, 5, options));
  }
}

/// Runs that name no method: each branch of the rule, and a run that turns out to be stiff.
void print_runs_without_a_method() {
  const std::vector<Link> rods(2, Link::uniform_rod(1.0, 0.7));
  print("default textbook", simulate(Scene::textbook(), {-1.4, -1.1}, {0, 0}, 0, 60));
  const Scene drag{.links = rods,
                   .effects = {RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.03}}};
  print("default drag", simulate(drag, {0.3, 0.9}, {4.0, -9.0}, 0, 4));
  Options loose;
  loose.rtol = {1e-4};
  print("default loose drag", simulate(drag, {0.3, 0.9}, {4.0, -9.0}, 0, 4, loose));
  const Scene damper{.links = rods, .effects = {ViscousJoint{.joint = 2, .damping = 1e5}}};
  print("default damper", simulate(damper, {0.8, 1.0}, {0, 0}, 0, 2));
}

}  // namespace

int main() {
  const Scene book = Scene::textbook();
  const Scene rod{.links = {Link::uniform_rod(1.3, 0.8)}, .gravity = 9.80665};
  Scene uneven{.links = {Link::uniform_rod(2.5, 0.7), Link::point_mass(0.4, 1.6)}, .gravity = 9.81};
  Options plain;
  plain.method = "dopri5";
  Options tight = plain;
  tight.rtol = {1e-12};
  print("textbook", simulate(book, {0.25 * M_PI, M_PI / 3}, {0, 0}, 0, 60, plain));
  print("chaotic", simulate(book, {-1.4, -1.1}, {0, 0}, 0, 60, tight));
  print("backward", simulate(uneven, {2.8, -0.4}, {1.5, -2.0}, 0, -20, plain));
  print("rod", simulate(rod, {-1.2}, {0}, 0, 60, plain));
  print("far", simulate(book, {3e8, -2e7}, {30, -70}, 0, 5, plain));
  print("tiny", simulate({.links = book.links, .gravity = 0.0}, {0.3, 0.9}, {3e-160, -1e-160}, 0,
                         1e159, plain));

  const Scene busy{
      .links = {Link::uniform_rod(1.0, 1.0), Link::uniform_rod(0.6, 0.7)},
      .effects = {ViscousJoint{.joint = 1, .damping = 0.02, .damping2 = 0.01},
                  RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.03, .wind = {2, -1}},
                  Motor{.joint = 2, .sinusoid = Sinusoid{0.5, 3.0, 0.1}},
                  Motor{.joint = 1, .pd = PD{2.0, 0.3, 1.0}, .limit = 0.7},
                  DryJointFriction{.joint = 2, .coulomb = 0.01, .static_ = 0.02, .exponent = 1.3},
                  RotorInertia{.joint = 2, .armature = 0.01},
                  DrivenPivot{.y = Sinusoid{0.05, 11.0, 0.0}}}};
  print("effects", simulate(busy, {0.3, 0.9}, {4.0, -9.0}, 0, 4, plain));
  Scene chain{.links = std::vector<Link>(7, Link::uniform_rod(0.4, 0.3))};
  print("chain",
        simulate(chain, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}, std::vector(7, 0.0), 0, 5, plain));
  chain.effects = busy.effects;
  tight.ledger = true;
  print("ledger", simulate(chain, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7},
                           {4.0, -9.0, 1.0, 2.0, 3.0, 4.0, 5.0}, 0, 2, tight));
  tight.compensated = true;
  print("compensated", simulate(book, {-1.4, -1.1}, {0, 0}, 0, 60, tight));
  print("compensated chain", simulate(chain, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7},
                                      {4.0, -9.0, 1.0, 2.0, 3.0, 4.0, 5.0}, 0, 2, tight));
  print_switching_and_stiff_runs();
  print_explicit_runs();
  print_stiff_chains();
  print_series();
  print_runs_without_a_method();
  return 0;
}
