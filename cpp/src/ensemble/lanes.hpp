/// \file
/// What the runs of an ensemble have in common that are taken in lanes: a trajectory a lane.
///
/// Each lane has its own time, step, step control and constants, and the next member begins in it
/// as soon as one has ended: none waits for another. The kernel of a step is that of a single run
/// (integrate/runge_kutta/step.hpp) on packs, so that a member has the bits of simulate(). What is
/// rare (a step that is not finite, that looks stiff, or becomes too small) is not handled here:
/// such a member is run by simulate() from its start. The last few members, too few to fill the
/// lanes, go on one by one from where they stand.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "pendcore/ensemble.hpp"
#include "pendcore/solution.hpp"

namespace pendcore {

/// Adds what a run did to the sums of an ensemble.
inline void add(Statistics& sum, const Statistics& one) {
  sum.nfev += one.nfev;
  sum.njev += one.njev;
  sum.nlu += one.nlu;
  sum.accepted += one.accepted;
  sum.rejected += one.rejected;
}

/// A member that is about to begin, or has ended.
struct LaneMember {
  std::size_t number = 0;
  std::vector<double> state;  ///< (2n): angles, rad, and rates, rad/s
  double t = 0.0;             ///< s
  Status status = Status::finished;
  Solution recorded;                 ///< what was recorded of its steps: times, states, events
  std::unique_ptr<StepWatch> watch;  ///< looks on, if it is not null
};

/// Where lanes get their members, and give them back.
class LaneSource {
 public:
  virtual ~LaneSource() = default;
  /// Fills `member` with the next one and returns its scene; null if there is none. A varied scene
  /// is valid until the next call.
  virtual const Scene* next(LaneMember& member) = 0;
  /// The watch of a member that begins, whose scene is allowed; null if members have none.
  virtual std::unique_ptr<StepWatch> watch(const Scene& scene) = 0;
  virtual bool watches() const = 0;  ///< whether they have one
  /// Whether their watches ask for dense output.
  virtual bool watches_dense_output() const = 0;
  /// The scene of a member that has begun; a varied one is valid until the next call.
  virtual const Scene& scene_of(std::size_t number) = 0;
  virtual void ended(const LaneMember& member) = 0;
  /// Runs this member by simulate().
  virtual void run_alone(std::size_t number) = 0;
  /// Whether to go on; is asked from time to time.
  virtual bool goes_on() = 0;
};

/// Runs members until the source has none left.
class LaneRunner {
 public:
  virtual ~LaneRunner() = default;
  virtual void run(LaneSource& source) = 0;
  const Statistics& statistics() const { return statistics_; }

 protected:
  Statistics statistics_;
};

/// The methods that have lanes for the equations of a scene; none where a law may change. Those of
/// Dormand and Prince have them for one to four links with all effects but users' functions, Taylor
/// series for two to `most_links_in_lanes` links with all effects that have a series.
std::vector<std::string_view> methods_with_lanes(const Scene& scene);
/// Longer chains run one by one: the series of eight of them leave a processor's second cache.
inline constexpr std::size_t most_links_in_lanes = 100;

/// The lanes for a scene and its options, or null if its members are run one by one: for example
/// if an event is a function of the user's.
std::unique_ptr<LaneRunner> make_lanes(const Scene& scene, double t0, double t_end,
                                       const Options& options);

}  // namespace pendcore
