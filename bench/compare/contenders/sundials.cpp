// SUNDIALS at its best, as found by experiment: memory is made once and reset for each solve
// (quicker than making it anew), the closed form has its constants in place, and there is no output
// but the states. Among ARKODE's explicit tables, the fifth order takes its own dense output,
// Hermite's of degree 4; degree 5 costs more without any gain here. The other tables are of higher
// order than any dense output of ARKODE, so their steps end at the times asked for. CVODE's Adams
// method uses fixed-point iteration; BDF uses Newton's method, with the analytic Jacobian if joints
// have springs and dampers.
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <cstddef>
#include <cstring>
#include <vector>

#include "solves.hpp"
#include "unit_rods.hpp"

namespace contenders {
namespace {

constexpr long most_steps = 2'000'000;

template <class Rods>
int rates(double /*t*/, N_Vector y, N_Vector f, void* rods) {
  (*static_cast<const Rods*>(rods))(NV_DATA_S(y), NV_DATA_S(f));
  return 0;
}

template <class Made, class... Arguments>
Made made(Made (*make)(Arguments...), std::type_identity_t<Arguments>... arguments) {
  const Made it = make(arguments...);
  if (it == nullptr) throw std::runtime_error("SUNDIALS could not be prepared");
  return it;
}

void done(int flag) {
  if (flag < 0) throw std::runtime_error("SUNDIALS refused a setting: " + std::to_string(flag));
}

void be_silent(int, const char*, const char*, char*, void*) {}

// What both packages need, and the loop over the times.
template <class Rods>
class SundialsRun : public Run {
 public:
  SundialsRun(const Rods& rods, const Given& given)
      : rods_(rods), times_(given["times"]), states_(Rods::size * given["times"].size()) {
    done(SUNContext_Create(nullptr, &context_));
    start_ = made(N_VNew_Serial, static_cast<sunindextype>(Rods::size), context_);
    y_ = made(N_VNew_Serial, static_cast<sunindextype>(Rods::size), context_);
    std::memcpy(NV_DATA_S(start_), given["start"].data(), sizeof(double) * Rods::size);
  }
  ~SundialsRun() override {
    N_VDestroy(y_);
    N_VDestroy(start_);
    SUNContext_Free(&context_);
  }
  SundialsRun(const SundialsRun&) = delete;
  SundialsRun& operator=(const SundialsRun&) = delete;

  std::span<const double> states() const final {
    return flag_ < 0 ? std::span<const double>() : states_;
  }
  std::string failure() const final { return "it ended with flag " + std::to_string(flag_); }

 protected:
  template <class Advance>
  void walk(Advance advance) {
    flag_ = 0;
    std::memcpy(states_.data(), NV_DATA_S(start_), sizeof(double) * Rods::size);
    for (std::size_t k = 1; k < times_.size() && flag_ >= 0; ++k) {
      flag_ = advance(times_[k]);
      std::memcpy(&states_[Rods::size * k], NV_DATA_S(y_), sizeof(double) * Rods::size);
    }
  }
  double begin() const { return times_.front(); }

  Rods rods_;
  SUNContext context_ = nullptr;
  N_Vector start_ = nullptr, y_ = nullptr;

 private:
  Numbers times_, states_;
  int flag_ = 0;
};

struct Table {
  ARKODE_ERKTableID id;
  bool stops_at_times;
};

template <class Rods>
class ErkRun : public SundialsRun<Rods> {
  using Base = SundialsRun<Rods>;

 public:
  ErkRun(const Rods& rods, const Given& given, Table table) : Base(rods, given), table_(table) {
    memory_ = made(ERKStepCreate, &rates<Rods>, this->begin(), this->start_, this->context_);
    done(ERKStepSetErrHandlerFn(memory_, be_silent, nullptr));
    done(ERKStepSetUserData(memory_, &this->rods_));
    done(ERKStepSetTableNum(memory_, table.id));
    done(ERKStepSStolerances(memory_, given["setting"][0], given["setting"][0]));
    done(ERKStepSetMaxNumSteps(memory_, most_steps));
    done(ERKStepSetInterpolantDegree(memory_, table.stops_at_times ? 1 : 4));
  }
  ~ErkRun() override { ERKStepFree(&memory_); }
  void solve() override {
    done(ERKStepReInit(memory_, &rates<Rods>, this->begin(), this->start_));
    this->walk([this](double time) {
      double reached = 0;
      if (table_.stops_at_times) ERKStepSetStopTime(memory_, time);
      return ERKStepEvolve(memory_, time, this->y_, &reached, ARK_NORMAL);
    });
  }
  Counts counts() override {
    long evaluations = 0, steps = 0;
    ERKStepGetNumRhsEvals(memory_, &evaluations);
    ERKStepGetNumStepAttempts(memory_, &steps);
    return {evaluations, steps};
  }

 private:
  Table table_;
  void* memory_ = nullptr;
};

int jacobian(double /*t*/, N_Vector y, N_Vector /*f*/, SUNMatrix matrix, void* rods, N_Vector,
             N_Vector, N_Vector) {
  double* const columns[] = {SM_COLUMN_D(matrix, 0), SM_COLUMN_D(matrix, 1), SM_COLUMN_D(matrix, 2),
                             SM_COLUMN_D(matrix, 3)};
  static_cast<const LoadedRods*>(rods)->jacobian(NV_DATA_S(y), columns);
  return 0;
}

template <class Rods>
class CvodeRun : public SundialsRun<Rods> {
  using Base = SundialsRun<Rods>;

 public:
  CvodeRun(const Rods& rods, const Given& given, int family) : Base(rods, given) {
    memory_ = made(CVodeCreate, family, this->context_);
    done(CVodeSetErrHandlerFn(memory_, be_silent, nullptr));
    done(CVodeInit(memory_, &rates<Rods>, this->begin(), this->start_));
    done(CVodeSetUserData(memory_, &this->rods_));
    done(CVodeSStolerances(memory_, given["setting"][0], given["setting"][0]));
    done(CVodeSetMaxNumSteps(memory_, most_steps));
    if (family == CV_ADAMS) {
      iteration_ = made(SUNNonlinSol_FixedPoint, this->start_, 0, this->context_);
      done(CVodeSetNonlinearSolver(memory_, iteration_));
    } else {
      const auto size = static_cast<sunindextype>(Rods::size);
      matrix_ = made(SUNDenseMatrix, size, size, this->context_);
      factors_ = made(SUNLinSol_Dense, this->start_, matrix_, this->context_);
      done(CVodeSetLinearSolver(memory_, factors_, matrix_));
      if constexpr (std::is_same_v<Rods, LoadedRods>) done(CVodeSetJacFn(memory_, jacobian));
    }
  }
  ~CvodeRun() override {
    CVodeFree(&memory_);
    if (iteration_) SUNNonlinSolFree(iteration_);
    if (factors_) SUNLinSolFree(factors_);
    if (matrix_) SUNMatDestroy(matrix_);
  }
  void solve() override {
    done(CVodeReInit(memory_, this->begin(), this->start_));
    this->walk([this](double time) {
      double reached = 0;
      return CVode(memory_, time, this->y_, &reached, CV_NORMAL);
    });
  }
  Counts counts() override {
    long evaluations = 0, of_differences = 0, steps = 0, failed = 0, diverged = 0;
    CVodeGetNumRhsEvals(memory_, &evaluations);
    if (factors_) CVodeGetNumLinRhsEvals(memory_, &of_differences);
    CVodeGetNumSteps(memory_, &steps);
    CVodeGetNumErrTestFails(memory_, &failed);
    CVodeGetNumNonlinSolvConvFails(memory_, &diverged);
    return {evaluations + of_differences, steps + failed + diverged};
  }

 private:
  void* memory_ = nullptr;
  SUNNonlinearSolver iteration_ = nullptr;
  SUNLinearSolver factors_ = nullptr;
  SUNMatrix matrix_ = nullptr;
};

// `Kind` is the template of runs; `choice` distinguishes its contenders.
template <template <class> class Kind, class Choice>
Contender sundials(const std::string& name, const std::string& label, const std::string& how,
                   Choice choice) {
  return {name, label + ", C++",
          "SUNDIALS " SUNDIALS_VERSION " as Debian builds it, " + how +
              "; right-hand side: " CONTENDER_BUILD,
          [choice](const Given& given) {
            return with_rods(given, [&]<class Rods>(const Rods& rods) -> std::unique_ptr<Run> {
              return std::make_unique<Kind<Rods>>(rods, given, choice);
            });
          }};
}

}  // namespace

std::vector<Contender> contenders() {
  return {
      sundials<ErkRun>("arkode_dopri5", "ARKODE DP5", "ERKStep, Dormand-Prince 5(4), dense output",
                       Table{ARKODE_DORMAND_PRINCE_7_4_5, false}),
      sundials<ErkRun>("arkode_verner6", "ARKODE Verner 6",
                       "ERKStep, Verner 8 stages 6(5), steps end at the times asked for",
                       Table{ARKODE_VERNER_8_5_6, true}),
      sundials<ErkRun>("arkode_rkf78", "ARKODE RKF78",
                       "ERKStep, Fehlberg 13 stages 8(7), steps end at the times asked for",
                       Table{ARKODE_FEHLBERG_13_7_8, true}),
      sundials<CvodeRun>("cvode_adams", "CVODE Adams", "CVODE, Adams-Moulton, fixed point",
                         CV_ADAMS),
      sundials<CvodeRun>("cvode_bdf", "CVODE BDF", "CVODE, BDF, Newton with a dense Jacobian",
                         CV_BDF),
  };
}

}  // namespace contenders
