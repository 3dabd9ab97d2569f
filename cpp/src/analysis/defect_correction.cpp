#include "pendcore/analysis/defect_correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/integrate/horner.hpp"
#include "pendcore/simulate/switching.hpp"

namespace pendcore {
namespace {

constexpr std::size_t most_points = 9;
constexpr std::size_t extrapolated_from = 3;
constexpr double lost = 0.2;  ///< rad
constexpr int within = 6;     ///< times kept in each step of a run with dense output

using Weights = std::array<double, most_points>;

/// A polynomial in theta: its coefficients, that of theta^0 first.
using Polynomial = std::array<double, most_points>;

double integral(const Polynomial& p, double theta) {
  double sum = 0.0;
  for (std::size_t i = p.size(); i-- > 0;) sum = theta * sum + p[i] / static_cast<double>(i + 1);
  return theta * sum;
}

double double_integral(const Polynomial& p, double theta) {
  double sum = 0.0;
  for (std::size_t i = p.size(); i-- > 0;) {
    sum = theta * sum + p[i] / static_cast<double>((i + 1) * (i + 2));
  }
  return theta * theta * sum;
}

/// The polynomial that is 1 at point j and 0 at the others.
Polynomial lagrange(std::span<const double> points, std::size_t j) {
  Polynomial product{1.0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == j) continue;
    const double scale = 1.0 / (points[j] - points[i]);
    for (std::size_t p = product.size(); p-- > 0;) {
      product[p] = scale * ((p > 0 ? product[p - 1] : 0.0) - points[i] * product[p]);
    }
  }
  return product;
}

}  // namespace

/// The points of a Lobatto quadrature in [0, 1], and what a step needs of them.
struct DefectCorrection::Points {
  std::size_t count;
  Weights theta{};
  std::array<Polynomial, most_points> through_all{};
  /// For each point, the weights of the values at all points in the integral up to it.
  std::array<Weights, most_points> of_all{};
  /// The same with the values at the points before it alone, and those of the double integral.
  std::array<Weights, most_points> of_earlier{}, twice_of_earlier{};

  explicit Points(std::span<const double> points) : count(points.size()) {
    std::ranges::copy(points, theta.begin());
    for (std::size_t j = 0; j < count; ++j) through_all[j] = lagrange(points, j);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) of_all[i][j] = integral(through_all[j], theta[i]);
      if (i > 0) weigh_earlier(points.first(i), i);
    }
  }

 private:
  /// Up to the last of the earlier points the polynomial goes through all of them. From there on
  /// one through the last few is more stable.
  void weigh_earlier(std::span<const double> earlier, std::size_t i) {
    const std::size_t few = std::min(extrapolated_from, earlier.size());
    const std::size_t first = earlier.size() - few;
    const double known = earlier.back();
    const double left = theta[i] - known;
    for (std::size_t j = 0; j < earlier.size(); ++j) {
      const Polynomial p = lagrange(earlier, j);
      of_earlier[i][j] = integral(p, known);
      twice_of_earlier[i][j] = double_integral(p, known) + left * integral(p, known);
    }
    for (std::size_t j = 0; j < few; ++j) {
      const Polynomial p = lagrange(earlier.last(few), j);
      of_earlier[i][first + j] += integral(p, theta[i]) - integral(p, known);
      twice_of_earlier[i][first + j] +=
          double_integral(p, theta[i]) - double_integral(p, known) - left * integral(p, known);
    }
  }
};

const DefectCorrection::Points& DefectCorrection::points_of(int count) {
  // (1 + x)/2 for the zeros x of the derivative of Legendre's polynomials, and for x = -1 and 1
  static const std::array all = {
      Points(std::array{0.0, 0.17267316464601143, 0.5, 0.82732683535398857, 1.0}),
      Points(std::array{0.0, 0.11747233803526765, 0.35738424175967745, 0.64261575824032255,
                        0.88252766196473235, 1.0}),
      Points(std::array{0.0, 0.084888051860716535, 0.26557560326464289, 0.5, 0.73442439673535711,
                        0.91511194813928346, 1.0}),
      Points(std::array{0.0, 0.064129925745196692, 0.20414990928342885, 0.39535039104876057,
                        0.60464960895123943, 0.79585009071657115, 0.93587007425480331, 1.0}),
      Points(std::array{0.0, 0.050121002294269921, 0.16140686024463112, 0.31844126808691092, 0.5,
                        0.68155873191308908, 0.83859313975536888, 0.94987899770573008, 1.0})};
  const int least = static_cast<int>(all.front().count);
  const int most = static_cast<int>(all.back().count);
  if (count < least || count > most) {
    throw std::invalid_argument("points = " + std::to_string(count) + ": must be from 5 to 9");
  }
  return all[static_cast<std::size_t>(count - least)];
}

bool has_defect_correction(const Scene& scene) { return !Switching::is_needed(scene); }

/// A part of a step, from one theta of its dense output on.
struct DefectCorrection::Part {
  const WatchedStep& step;
  double from, size;  ///< in theta
  double t_start, t;  ///< s, where the part begins, and where it ends
  double h;           ///< s
  bool ends_the_step;

  double theta(double share) const { return from + share * size; }
  double at(std::size_t column, double share) const {
    const auto row = static_cast<int>(step.y.size());
    return horner<double>(step.rows + column, step.degree, row, theta(share));
  }
  /// By how much the run's state is off the end of the dense output: a sum was rounded there. The
  /// state at the start comes last, so that little is rounded here.
  double jump(std::size_t column) const {
    const auto row = static_cast<int>(step.y.size());
    const double end = theta(1.0);
    const double turned = end * horner<double>(step.rows + row + column, step.degree - 1, row, end);
    return turned + (step.rows[column] - step.y[column]);
  }
  /// The derivative with respect to the share of the part.
  double slope(std::size_t column, double share) const {
    double sum = 0.0;
    for (int p = step.degree; p > 0; --p) {
      sum =
          theta(share) * sum + p * step.rows[static_cast<std::size_t>(p) * step.y.size() + column];
    }
    return size * sum;
  }
};

/// A neighbour of the run: its error now, and along the last part of a step.
struct DefectCorrection::Neighbour {
  Neighbour(const Scene& scene, std::vector<double> angles, const Points& its_points)
      : equations(equations_of_motion(scene)),
        qdd_of(right_hand_side(equations)),
        points(its_points),
        n(scene.links.size()),
        q0(std::move(angles)) {
    for (auto* one : {&e_q, &e_qd, &e_q_before, &e_qd_before, &q, &qd, &qdd}) one->resize(n);
    r.resize(points.count * n);
    s.resize(points.count * n);
  }

  /// Goes to the end of a part of a step. Returns the right-hand sides taken.
  int go_on(const Part& part) {
    e_q_before = e_q;
    e_qd_before = e_qd;
    for (std::size_t i = 0; i < points.count; ++i) {
      for (std::size_t link = 0; link < n; ++link) {
        const double theta = points.theta[i];
        s[i * n + link] = part.h * part.at(n + link, theta) - part.slope(link, theta);
        r[i * n + link] = -part.slope(n + link, theta);
      }
    }
    for (std::size_t i = 0; i < points.count; ++i) {
      // At the first point the last right-hand side of the part before serves again. Its state
      // lacked only what the last point itself added to the error.
      if (i > 0 || is_first) {
        set_state(part, i);
        qdd_of(part.t_start + points.theta[i] * part.h, q.data(), qd.data(), qdd.data());
      }
      for (std::size_t link = 0; link < n; ++link) r[i * n + link] += part.h * qdd[link];
    }
    for (std::size_t link = 0; link < n; ++link) {
      e_q[link] = angle_at(link, 1.0, part.h);
      for (std::size_t j = 0; j < points.count; ++j) {
        e_qd[link] += points.of_all[points.count - 1][j] * r[j * n + link];
      }
      if (!part.ends_the_step) continue;
      e_q[link] += part.jump(link);
      e_qd[link] += part.jump(n + link);
    }
    const int taken = static_cast<int>(points.count) - (is_first ? 0 : 1);
    is_first = false;
    return taken;
  }

  /// The error of an angle within the last part, of length h, s.
  double angle_at(std::size_t link, double theta, double h) const {
    double angle = e_q_before[link] + theta * h * e_qd_before[link];
    for (std::size_t j = 0; j < points.count; ++j) {
      angle += h * double_integral(points.through_all[j], theta) * r[j * n + link];
      angle += integral(points.through_all[j], theta) * s[j * n + link];
    }
    return angle;
  }

  EquationsOfMotion equations;
  RightHandSide qdd_of;
  const Points& points;
  std::size_t n;
  std::vector<double> q0;
  std::vector<double> e_q{}, e_qd{}, e_q_before{}, e_qd_before{}, q{}, qd{}, qdd{}, r{}, s{};
  bool is_first = true;

 private:
  /// Sets q and qd at a point to the run's and their errors, as the points before it have them.
  void set_state(const Part& part, std::size_t i) {
    const double theta = points.theta[i];
    for (std::size_t link = 0; link < n; ++link) {
      double rate = e_qd[link];
      double angle = e_q[link] + theta * part.h * e_qd[link];
      for (std::size_t j = 0; j < i; ++j) {
        rate += points.of_earlier[i][j] * r[j * n + link];
        angle += part.h * points.twice_of_earlier[i][j] * r[j * n + link];
      }
      for (std::size_t j = 0; j < points.count; ++j) {
        angle += points.of_all[i][j] * s[j * n + link];
      }
      q[link] = part.at(link, theta) + angle;
      qd[link] = part.at(n + link, theta) + rate;
    }
  }
};

DefectCorrection::DefectCorrection(int parts) : parts_(parts) {
  if (parts < 1) {
    throw std::invalid_argument("parts = " + std::to_string(parts) + ": must be >= 1");
  }
}
DefectCorrection::~DefectCorrection() = default;
DefectCorrection::DefectCorrection(DefectCorrection&&) noexcept = default;

void DefectCorrection::add(const Scene& scene, const std::vector<double>& q0, int points) {
  if (!has_defect_correction(scene)) {
    throw std::invalid_argument(
        "scene: a law changes with the state, or a joint is held: its runs have no defect "
        "correction");
  }
  neighbours_.push_back(std::make_unique<Neighbour>(scene, q0, points_of(points)));
}

void DefectCorrection::keep(Store store, const std::vector<double>& t_eval) {
  store_ = store;
  t_eval_ = t_eval;
}

void DefectCorrection::starts(double t, std::span<const double> y) {
  t_start_ = t;
  for (const auto& one : neighbours_) {
    for (std::size_t link = 0; link < one->n; ++link) one->e_q[link] = one->q0[link] - y[link];
  }
  const bool is_asked_for = !t_eval_.empty() && t_eval_.front() == t;
  if (is_asked_for) ++next_time_;
  if (store_ != Store::times || is_asked_for) {
    double* to = append(t);
    for (const auto& one : neighbours_) to = std::ranges::copy(one->e_q, to).out;
  }
}

void DefectCorrection::steps(const WatchedStep& step) {
  const double size = step.share / parts_;
  const double h = size * step.h;
  const double t_start = t_start_;
  if (store_ == Store::end) {
    t_.clear();
    errors_.clear();
  }
  for (int k = 0; k < parts_; ++k) {
    const bool is_last = k + 1 == parts_;
    const Part part{.step = step,
                    .from = k * size,
                    .size = size,
                    .t_start = t_start + k * h,
                    .t = is_last ? step.t : t_start + (k + 1) * h,
                    .h = h,
                    .ends_the_step = is_last};
    for (const auto& one : neighbours_) nfev_ += one->go_on(part);
    keep_errors(part);
  }
  compare();
  t_start_ = step.t;
}

void DefectCorrection::compare() {
  if (neighbours_.size() < 2 || agreement_.at_loss != 0.0) return;
  double between = 0.0;
  double largest = 0.0;
  const auto raise = [](double& to, double x) {
    if (!(std::abs(x) <= to)) to = std::abs(x);
  };
  for (std::size_t link = 0; link < links(); ++link) {
    const double first = neighbours_[0]->e_q[link];
    const double second = neighbours_[1]->e_q[link];
    raise(between, first - second);
    raise(largest, first);
    raise(largest, second);
  }
  if (!(largest <= lost)) {
    agreement_.at_loss = largest;
    return;
  }
  raise(agreement_.between, between);
  raise(agreement_.largest, largest);
}

/// A scene whose laws do not change has no impacts: its state is only settled.
void DefectCorrection::jumps(double, std::span<const double>) {}

void DefectCorrection::keep_errors(const Part& part) {
  const auto keep_at = [&](double t, double theta) {
    double* to = append(t);
    for (const auto& one : neighbours_) {
      for (std::size_t link = 0; link < one->n; ++link) *to++ = one->angle_at(link, theta, part.h);
    }
  };
  const auto keep_at_end = [&] {
    double* to = append(part.t);
    for (const auto& one : neighbours_) to = std::ranges::copy(one->e_q, to).out;
  };
  if (store_ == Store::times) {
    for (; next_time_ < t_eval_.size(); ++next_time_) {
      const double t = t_eval_[next_time_];
      if ((t - part.t) * part.h > 0.0) break;
      t == part.t ? keep_at_end() : keep_at(t, (t - part.t_start) / part.h);
    }
    return;
  }
  if (store_ == Store::dense) {
    const int times = (within + parts_ - 1) / parts_;
    for (int k = 1; k < times; ++k) {
      const double theta = static_cast<double>(k) / times;
      keep_at(part.t_start + theta * part.h, theta);
    }
  }
  if (part.ends_the_step || store_ == Store::dense) keep_at_end();
}

std::vector<double> DefectCorrection::errors_at_end() const {
  std::vector<double> errors;
  for (const auto& one : neighbours_) errors.insert(errors.end(), one->e_q.begin(), one->e_q.end());
  return errors;
}

std::size_t DefectCorrection::links() const {
  return neighbours_.empty() ? 0 : neighbours_.front()->n;
}

double* DefectCorrection::append(double t) {
  t_.push_back(t);
  const std::size_t size = neighbours() * links();
  errors_.resize(errors_.size() + size);
  return errors_.data() + errors_.size() - size;
}

}  // namespace pendcore
