// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/motion/smooth_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "swivel/core/base/angle.hpp"

namespace swivel {

namespace {

constexpr double kChange = 1e3;      // weight of too large a change of the coordinate
constexpr double kLeastMove = 1e-9;  // rad; rounds off the tip of the norm
// rad; rounds off the tip of the roll's cost, at which optima stand
constexpr double kLeastRoll = 1e-5;

/// Joints of all layers at given coordinates, and their first two derivatives by them.
struct Layers {
  std::vector<Config> q, first, second;
};

/// Coefficients of the second divided difference at a layer, and the mean step h.
struct Bend {
  std::array<double, 3> c{};
  double h = 0;
};

/// The norm of a weighted move: its gradient is `way`, its Hessian bent (diag(spread) - coupled way
/// way^T).
struct Norm {
  double bent = 0, coupled = 1;
  Config way, spread;
};

class Objective {
 public:
  /// `tip` rounds off the tips of norms, rad.
  Objective(const LayerSolver& solver, const SmoothObjective& objective, double tip = kLeastMove)
      : solver_(&solver), objective_(&objective), n_(solver.layers()), tip_(tip) {
    scale_ = Config::of(objective.weights.data());
    bends_.resize(static_cast<std::size_t>(n_));
    for (int i = 1; i + 1 < n_; ++i) {
      const double h0 = solver.travel(i) - solver.travel(i - 1),
                   h1 = solver.travel(i + 1) - solver.travel(i), h = (h0 + h1) / 2;
      bends_[at(i)] = {{1 / (h0 * h), -1 / (h0 * h) - 1 / (h1 * h), 1 / (h1 * h)}, h};
    }
    for (const int jump : objective.jumps) bends_[at(jump)] = bends_[at(jump + 1)] = {};
  }

  [[nodiscard]] bool solve(const std::vector<double>& x, std::vector<Config>& q) const {
    q.resize(x.size());
    for (int i = 0; i < n_; ++i) {
      const auto joints = solver_->joints(i, x[at(i)]);
      if (!joints) return false;
      q[at(i)] = *joints;
    }
    return true;
  }

  /// Returns what the joints' moves cost.
  [[nodiscard]] double moves(const std::vector<Config>& q) const {
    double sum = 0;
    for (int i = 0; i + 1 < n_; ++i) sum += length(scale_.cwiseProduct(q[at(i + 1)] - q[at(i)]));
    return sum;
  }

  [[nodiscard]] double value(const std::vector<double>& x, const std::vector<Config>& q) const {
    double sum = 0;
    for (int i = 0; i + 1 < n_; ++i) {
      sum += length(scale_.cwiseProduct(q[at(i + 1)] - q[at(i)]));
      const double over = std::abs(x[at(i + 1)] - x[at(i)]) - objective_->most_change;
      if (over > 0) sum += kChange * over * over;
    }
    for (int i = 1; i + 1 < n_; ++i)
      sum += objective_->bending * bends_[at(i)].h * joint_squared_norm(bend(q, i));
    for (std::size_t i = 0; i < objective_->roll.size(); ++i)
      sum += objective_->roll[i] * off(wrap_angle(roll(x[i], q[i])));
    return sum;
  }

  /// Computes the gradient g and the Hessian's diagonals 0, 1, 2 above the main one. Returns false
  /// where a derivative does not exist.
  [[nodiscard]] bool derive(const std::vector<double>& x, Layers& l, std::vector<double>& g,
                            std::array<std::vector<double>, 3>& H) const {
    constexpr double kStep = 1e-4;
    l.first.resize(x.size());
    l.second.resize(x.size());
    for (int i = 0; i < n_; ++i) {
      const auto before = solver_->joints(i, x[at(i)] - kStep),
                 after = solver_->joints(i, x[at(i)] + kStep);
      if (!before || !after) return false;
      l.first[at(i)] = (*after - *before) / (2 * kStep);
      l.second[at(i)] = ((*after - l.q[at(i)]) - (l.q[at(i)] - *before)) / (kStep * kStep);
    }
    g.assign(x.size(), 0);
    for (auto& diagonal : H) diagonal.assign(x.size(), 0);
    for (int i = 0; i + 1 < n_; ++i) {
      const std::size_t a = at(i), b = at(i + 1);
      const Norm n = norm(scale_.cwiseProduct(l.q[b] - l.q[a]));
      const Config ja = scale_.cwiseProduct(l.first[a]), jb = scale_.cwiseProduct(l.first[b]);
      const double wa = joint_dot(n.way, ja), wb = joint_dot(n.way, jb);
      g[a] -= wa;
      g[b] += wb;
      H[0][a] += n.bent * (joint_dot(ja.cwiseProduct(n.spread), ja) - n.coupled * wa * wa) -
                 joint_dot(n.way, scale_.cwiseProduct(l.second[a]));
      H[0][b] += n.bent * (joint_dot(jb.cwiseProduct(n.spread), jb) - n.coupled * wb * wb) +
                 joint_dot(n.way, scale_.cwiseProduct(l.second[b]));
      H[1][a] -= n.bent * (joint_dot(ja.cwiseProduct(n.spread), jb) - n.coupled * wa * wb);
      const double change = x[b] - x[a], over = std::abs(change) - objective_->most_change;
      if (over <= 0) continue;
      const double pull = 2 * kChange * std::copysign(over, change);
      g[a] -= pull;
      g[b] += pull;
      H[0][a] += 2 * kChange;
      H[0][b] += 2 * kChange;
      H[1][a] -= 2 * kChange;
    }
    for (std::size_t i = 0; i < objective_->roll.size(); ++i) {
      const double roll = wrap_angle(this->roll(x[i], l.q[i])), way = roll / off(roll);
      const double first = objective_->roll_is_coordinate ? 1 : l.first[i][kDof - 1],
                   second = objective_->roll_is_coordinate ? 0 : l.second[i][kDof - 1];
      g[i] += objective_->roll[i] * way * first;
      H[0][i] += objective_->roll[i] * ((1 - way * way) / off(roll) * first * first + way * second);
    }
    for (int i = 1; i + 1 < n_; ++i) {
      const Bend& b = bends_[at(i)];
      const Config e = bend(l.q, i);
      const double w = 2 * objective_->bending * b.h;
      for (int j = 0; j < 3; ++j) {
        const std::size_t k = at(i - 1 + j);
        const double cj = b.c[static_cast<std::size_t>(j)];
        g[k] += w * cj * joint_dot(e, l.first[k]);
        H[0][k] += w * cj * joint_dot(e, l.second[k]);
        for (int m = j; m < 3; ++m)
          H[static_cast<std::size_t>(m - j)][k] += w * cj * b.c[static_cast<std::size_t>(m)] *
                                                   joint_dot(l.first[k], l.first[at(i - 1 + m)]);
      }
    }
    return true;
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] double roll(double x, const Config& q) const {
    return objective_->roll_is_coordinate ? x : q[kDof - 1];
  }
  [[nodiscard]] double length(const Config& r) const {
    const int power = objective_->power;
    if (power == 2) return std::sqrt(joint_squared_norm(r) + tip_ * tip_);
    if (power == 1) return joint_sum(magnitudes(r));
    const double unit = std::max(r.lpNorm<Eigen::Infinity>(), tip_);
    return unit * std::pow(joint_sum(raised(r / unit, power)) +
                               raised(Config::Constant(tip_ / unit), power)[0],
                           1.0 / power);
  }
  static double off(double roll) { return std::sqrt(roll * roll + kLeastRoll * kLeastRoll); }
  [[nodiscard]] Norm norm(const Config& r) const {
    Norm n;
    if (objective_->power == 1) {
      const Config size = magnitudes(r);
      n.bent = 1;
      n.coupled = 0;
      n.way = r.cwiseQuotient(size);
      n.spread = size.cwiseInverse() - n.way.cwiseAbs2().cwiseQuotient(size);
      return n;
    }
    const double length = this->length(r);
    n.bent = (objective_->power - 1) / length;
    n.spread = raised(r / length, objective_->power - 2);
    n.way = n.spread.cwiseProduct(r / length);
    return n;
  }
  /// Returns the magnitudes of r's entries, their tips rounded off.
  [[nodiscard]] Config magnitudes(const Config& r) const {
    return (r.cwiseAbs2() + Config::Constant(tip_ * tip_)).cwiseSqrt();
  }
  /// Returns each entry of r to an even power >= 0, by products alone.
  static Config raised(const Config& r, int power) {
    Config result = Config::Ones(), square = r.cwiseAbs2();
    for (int left = power / 2; left > 0; left /= 2) {
      if (left % 2 == 1) result = result.cwiseProduct(square);
      square = square.cwiseAbs2();
    }
    return result;
  }
  [[nodiscard]] Config bend(const std::vector<Config>& q, int i) const {
    const auto& c = bends_[at(i)].c;
    return c[0] * q[at(i - 1)] + c[1] * q[at(i)] + c[2] * q[at(i + 1)];
  }

  const LayerSolver* solver_;
  const SmoothObjective* objective_;
  int n_;
  double tip_;
  Config scale_;
  std::vector<Bend> bends_;
};

/// Solves (H + shift) p = -g over the free coordinates, where p is as given for the others, by L D
/// L^T. Returns false unless the matrix is positive definite.
bool newton_step(const std::array<std::vector<double>, 3>& H, const std::vector<double>& g,
                 const std::vector<bool>& free, double shift, std::vector<double>& p) {
  const std::size_t n = g.size();
  std::vector<double> d(n), l1(n, 0), l2(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    // l1[i], l2[i]: entries of row i one and two before the diagonal.
    if (!free[i]) continue;
    double rhs = -g[i], pivot = H[0][i] + shift;
    const bool one = i >= 1 && free[i - 1], two = i >= 2 && free[i - 2];
    if (i >= 1 && !free[i - 1]) rhs -= H[1][i - 1] * p[i - 1];
    if (i >= 2 && !free[i - 2]) rhs -= H[2][i - 2] * p[i - 2];
    if (i + 1 < n && !free[i + 1]) rhs -= H[1][i] * p[i + 1];
    if (i + 2 < n && !free[i + 2]) rhs -= H[2][i] * p[i + 2];
    const double h1 = one ? H[1][i - 1] : 0, h2 = two ? H[2][i - 2] : 0;
    if (two) l2[i] = h2 / d[i - 2];
    if (one) l1[i] = (h1 - (two ? h2 * l1[i - 1] : 0)) / d[i - 1];
    pivot -= l1[i] * l1[i] * (one ? d[i - 1] : 0) + l2[i] * l2[i] * (two ? d[i - 2] : 0);
    if (!(pivot > 1e-12 * (std::abs(H[0][i]) + shift))) return false;
    d[i] = pivot;
    if (one) rhs -= l1[i] * p[i - 1];
    if (two) rhs -= l2[i] * p[i - 2];
    p[i] = rhs;
  }
  for (std::size_t i = n; i-- > 0;) {
    if (!free[i]) continue;
    p[i] /= d[i];
    if (i + 1 < n && free[i + 1]) p[i] -= l1[i + 1] * p[i + 1];
    if (i + 2 < n && free[i + 2]) p[i] -= l2[i + 2] * p[i + 2];
  }
  return true;
}

/// Computes a newton_step() inside the boxes by a primal-dual active set (Hintermueller, Ito and
/// Kunisch 2002). Coordinates that would leave their box end on the bound, and those whose bound no
/// longer holds them back are free again, all at once: one at a time would need as many steps as a
/// path has layers on bounds. Where that does not settle, bounds are only added.
bool newton_step_inside(const std::array<std::vector<double>, 3>& H, const std::vector<double>& g,
                        std::vector<bool> free, double shift, const std::vector<double>& x,
                        const std::vector<CoordinateBox>& boxes, std::vector<double>& p) {
  constexpr int kRounds = 40, kSettling = 25;
  const std::size_t n = x.size();
  std::fill(p.begin(), p.end(), 0);
  std::vector<std::size_t> change;
  for (int round = 0; round < kRounds; ++round) {
    if (!newton_step(H, g, free, shift, p)) return false;
    change.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const double low = boxes[i].low - x[i], high = boxes[i].high - x[i];
      if (free[i]) {
        if (p[i] < low || p[i] > high) change.push_back(i);
        continue;
      }
      if (round >= kSettling || low >= high) continue;
      double slope = g[i] + (H[0][i] + shift) * p[i];  // of the model, at p
      if (i >= 1) slope += H[1][i - 1] * p[i - 1];
      if (i >= 2) slope += H[2][i - 2] * p[i - 2];
      if (i + 1 < n) slope += H[1][i] * p[i + 1];
      if (i + 2 < n) slope += H[2][i] * p[i + 2];
      if (p[i] <= low ? slope < 0 : slope > 0) change.push_back(i);
    }
    if (change.empty()) return true;
    for (const std::size_t i : change) {
      if (free[i]) p[i] = std::clamp(p[i], boxes[i].low - x[i], boxes[i].high - x[i]);
      free[i] = !free[i];
    }
  }
  return true;
}

/// Seeks a minimum of f from x on, by smooth_minimum()'s method.
std::vector<double> minimum_from(const Objective& f, const std::vector<CoordinateBox>& boxes,
                                 std::vector<double> x, const Budget& budget) {
  constexpr int kIterations = 60;
  constexpr double kGain = 1e-9, kFirstShift = 1e-3, kLastShift = 1e9;
  Layers here;
  if (!f.solve(x, here.q)) return x;
  double value = f.value(x, here.q), shift = 0;
  std::vector<double> g, p(x.size()), next(x.size());
  std::array<std::vector<double>, 3> H;
  std::vector<bool> free(x.size());
  std::vector<Config> q;
  int small = 0;
  bool done = false;
  for (int iteration = 0; iteration < kIterations && small < 2 && !done; ++iteration) {
    budget.poll();
    if (!f.derive(x, here, g, H)) return x;
    for (std::size_t i = 0; i < x.size(); ++i)
      free[i] = boxes[i].low < boxes[i].high && !(x[i] <= boxes[i].low && g[i] > 0) &&
                !(x[i] >= boxes[i].high && g[i] < 0);
    bool better = false;
    while (!better && shift <= kLastShift) {
      if (newton_step_inside(H, g, free, shift, x, boxes, p)) {
        // A Newton step gains half of g . p.
        done = shift == 0 && std::abs(std::inner_product(g.begin(), g.end(), p.begin(), 0.0)) <
                                 kGain * (1 + value);
        for (std::size_t i = 0; i < x.size(); ++i)
          next[i] = std::clamp(x[i] + p[i], boxes[i].low, boxes[i].high);
        if (f.solve(next, q)) {
          const double there = f.value(next, q);
          if (there < value) {
            small = value - there < kGain * (1 + value) ? small + 1 : 0;
            value = there;
            x.swap(next);
            here.q.swap(q);
            better = true;
            break;
          }
        }
        if (done) break;
      }
      shift = std::max(kFirstShift, 4 * shift);
    }
    if (!better) break;
    shift = shift <= kFirstShift ? 0 : shift / 8;
  }
  return x;
}

/// Seeks a minimum of the sum of magnitudes, which has no derivative where a joint stands still, by
/// objectives that round it off less and less.
std::vector<double> least_sum_from(const LayerSolver& solver, const SmoothObjective& objective,
                                   const std::vector<CoordinateBox>& boxes, std::vector<double> x,
                                   const Budget& budget) {
  const Objective exact(solver, objective);
  std::vector<Config> q;
  if (!exact.solve(x, q)) return x;
  const double before = exact.value(x, q), mean = exact.moves(q) / (kDof * (solver.layers() - 1.0));
  std::vector<double> found = x;
  for (const double part : {3e-2, 3e-3, 3e-4})
    found = minimum_from(Objective(solver, objective, std::max(kLeastMove, part * mean)), boxes,
                         std::move(found), budget);
  return exact.solve(found, q) && exact.value(found, q) < before ? found : x;
}

}  // namespace

double smooth_cost(const LayerSolver& solver, const SmoothObjective& objective,
                   const std::vector<double>& x) {
  const Objective f(solver, objective);
  std::vector<Config> q;
  return f.solve(x, q) ? f.value(x, q) : std::numeric_limits<double>::infinity();
}

std::vector<double> smooth_minimum(const LayerSolver& solver, const SmoothObjective& objective,
                                   const std::vector<CoordinateBox>& boxes, std::vector<double> x,
                                   const Budget& budget) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::clamp(x[i], boxes[i].low, boxes[i].high);
  if (objective.power == 1) return least_sum_from(solver, objective, boxes, std::move(x), budget);
  return minimum_from(Objective(solver, objective), boxes, std::move(x), budget);
}

}  // namespace swivel
