// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/grid/chord_lower_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cost_to_go/kernels/relax_task.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr int kRun = 16;  // angles relaxed at once

/// How far the coordinate may turn along a chord: longer chords need fewer layers, but follow the
/// joints less and leave the sweep wider gaps.
int stride_of(const SrsLattice& lattice) {
  constexpr double kTurn = 0.6;
  const double turn_per_layer = lattice.window() * kTwoPi / lattice.angles();
  return turn_per_layer > 0
             ? static_cast<int>(std::clamp(std::round(kTurn / turn_per_layer), 4.0, 32.0))
             : 4;
}

struct Interval {
  float low = kNever, high = -kNever;
  void add(const Interval& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  [[nodiscard]] float gap(const Interval& other) const {
    return std::max(low - other.high, other.low - high);
  }
};

constexpr auto kMiddle = SrsLattice::kMiddleJoints;

using Lanes = Eigen::Array<float, kRun, 1>;
using Track = Eigen::Map<const Eigen::ArrayXd>;

/// The least value and the joint ranges of some nodes of an IK solution.
struct Summary {
  float least = kNever;                        // value
  std::array<Interval, kMiddle.size()> joint;  // kMiddle
  void add(const Summary& other) {
    least = std::min(least, other.least);
    for (std::size_t m = 0; m < joint.size(); ++m) joint[m].add(other.joint[m]);
  }
};

/// One IK solution at one layer, from -window to angles + window around the circle, and on to whole
/// runs.
struct alignas(64) Circle {
  bool alive = false;
  std::vector<float> q[kDof];
  std::vector<float> value;    // bound; kNever where no node is
  std::vector<Summary> near;   // [run of angles]: what lies in its windows
  std::vector<Summary> parts;  // scratch of look_around

  [[nodiscard]] Eigen::Map<const Lanes> lanes(const std::vector<float>& padded, int at) const {
    return Eigen::Map<const Lanes>(padded.data() + at);
  }
  /// Returns the summary of the kRun padded positions from `at`.
  [[nodiscard]] Summary summary(int at) const {
    const auto values = lanes(value, at);
    Summary sum;
    sum.least = values.minCoeff();
    if (sum.least == kNever) return sum;
    for (std::size_t m = 0; m < kMiddle.size(); ++m)
      relax_kernels().coarse_range(q[kMiddle[m]].data() + at, values.data(), kRun, sum.joint[m].low,
                                   sum.joint[m].high);
    return sum;
  }
};

class Chords {
 public:
  /// Prepares chords between the layers c * stride, c = 0, 1, ..., and the last.
  Chords(const SrsLattice& lattice, int stride, const Budget& budget, const ParallelFor& work)
      : lattice_(lattice),
        stride_(stride),
        budget_(budget),
        work_(work),
        n_(lattice.angles()),
        window_(std::min(n_ / 2, stride * lattice.window() + 1)),
        nodes_(SrsLattice::kElbowSides) {
    const Cost& cost = lattice.cost();
    task_.metric = relax_metric(cost.metric);
    task_.wraps = false;
    double scales = 0, largest = kPi;
    for (std::size_t j = 0; j < kDof; ++j) {
      const bool turns = lattice.continuous()[j];
      task_.wraps |= turns;
      task_.turn[j] = turns ? static_cast<float>(kTwoPi) : 0;
      task_.scale[j] = static_cast<float>(lattice.cost_scale()[j]);
      scales += lattice.cost_scale()[j];
      const JointLimit& limit = lattice.chain().limit[j];
      if (!turns) largest = std::max({largest, std::abs(limit.lower), std::abs(limit.upper)});
    }
    task_.unit = static_cast<float>(lattice.cost_unit());
    // A few units of 2^-24 for each of the rounding of joints, their difference, its norm, and
    // exact costs.
    lost_ = 0x1p-20 * scales * (largest + kTwoPi) + 1e-10 * lattice.cost_unit();
    fits_ = scales * (largest + kTwoPi) * lattice.layers() < 1e30;
    for (auto& layer : circles_) layer.resize(static_cast<std::size_t>(lattice.solutions()));
  }

  [[nodiscard]] bool fits() const { return fits_; }
  [[nodiscard]] int layers() const { return (lattice_.layers() - 1 + stride_ - 1) / stride_ + 1; }

  /// Computes the bounds of the nodes of the layers from c on, as [layer][slot]: one layer, or as
  /// many as both elbow sides go through alone. c is 0, then what the call before returned. Returns
  /// the next c; -1 where no node is reached.
  int advance(int c, float* rows) {
    budget_.tell(Stage::kBounds, layer_at(c), lattice_.layers());
    int end = c + 1;
    while (!meets(c) && end < layers() && end - c < kMostAlone && !meets(end)) ++end;
    work_.for_each(SrsLattice::kElbowSides, [&](int side, int) {
      for (int at = c; at < end; ++at) {
        load(at, side);
        const bool meets_other = end == c + 1 && meets(at);
        for (int solution = first_solution(side);
             solution < first_solution(side) + lattice_.solutions() / 2; ++solution) {
          float* const row = rows + static_cast<std::ptrdiff_t>(at - c) * lattice_.width() +
                             static_cast<std::ptrdiff_t>(solution) * n_;
          if (circle(at, solution).alive)
            bound(at, solution, meets_other, row);
          else
            std::fill_n(row, n_, kNever);
        }
      }
    });
    for (int solution = 0; solution < lattice_.solutions(); ++solution)
      if (circle(end - 1, solution).alive) return end;
    return -1;
  }

 private:
  static constexpr int kMostAlone = 16;  // chords until the next progress report

  [[nodiscard]] int first_solution(int side) const { return side * lattice_.solutions() / 2; }
  /// Returns true if a step of the chord before layer c may lead from one elbow side to the other.
  [[nodiscard]] bool meets(int c) const {
    for (int step = c > 0 ? layer_at(c - 1) : 0; step < (c > 0 ? layer_at(c) : 0); ++step)
      if (lattice_.may_change_elbow_side(step)) return true;
    return false;
  }
  [[nodiscard]] int layer_at(int c) const { return std::min(c * stride_, lattice_.layers() - 1); }
  Circle& circle(int c, int solution) {
    return circles_[static_cast<std::size_t>(c) % circles_.size()]
                   [static_cast<std::size_t>(solution)];
  }
  /// Computes the bounds of an IK solution's nodes from those of layer c - 1; zeros in layer 0.
  void bound(int c, int solution, bool meets_other, float* best) {
    budget_.poll();
    Circle& here = circle(c, solution);
    if (c == 0) std::fill_n(best, n_, 0.0F);
    for (int run = 0; c > 0 && run < runs(); ++run) {
      const Lanes relaxed = relax(c, solution, meets_other, run);
      std::copy_n(relaxed.data(), std::min(kRun, n_), best + begin(run));
    }
    Eigen::Map<Eigen::ArrayXf> bounds(best, n_), values(here.value.data() + window_, n_);
    if (c > 0) bounds = ((bounds - static_cast<float>(lost_)) * (1 - 0x1p-20F)).max(0);
    bounds = values = (values == 0).select(bounds, kNever);
    here.alive = bounds.minCoeff() < kNever;
    wrap(here.value);
    look_around(here);
  }
  void wrap(std::vector<float>& padded) const {
    std::copy_n(padded.begin() + n_, window_, padded.begin());
    std::copy_n(padded.begin() + window_, window_, padded.begin() + window_ + n_);
  }

  /// Loads joints, with value 0 where there is a node.
  void load(int c, int side) {
    budget_.poll();
    LayerNodes& nodes = nodes_[static_cast<std::size_t>(side)];
    lattice_.lay_out(layer_at(c), 0, n_, nodes);
    lattice_.solve_part(side, 0, n_, nodes);
    for (int solution = first_solution(side);
         solution < first_solution(side) + lattice_.solutions() / 2; ++solution) {
      Circle& to = circle(c, solution);
      to.alive = false;
      if (!nodes.alive(solution)) continue;
      const auto length = static_cast<std::size_t>(n_ + 2 * window_ + kRun);
      to.value.resize(length, kNever);
      Eigen::Map<Eigen::ArrayXf> value(to.value.data() + window_, n_);
      value =
          (Track(nodes.mask(solution, 0), n_) + Track(nodes.mask(solution, 1), n_)).cast<float>();
      to.alive = value.minCoeff() == 0;
      if (!to.alive) continue;
      for (int k = 0; k < kDof; ++k) {
        std::vector<float>& q = to.q[k];
        q.resize(length);
        Eigen::Map<Eigen::ArrayXf>(q.data() + window_, n_) =
            Track(nodes.q(solution, k), n_).cast<float>();
        wrap(q);
      }
    }
  }

  [[nodiscard]] int runs() const { return (n_ + kRun - 1) / kRun; }
  /// Returns the first angle of a run. Runs are whole vectors, so the last two may overlap.
  [[nodiscard]] int begin(int run) const { return std::max(0, std::min(run * kRun, n_ - kRun)); }

  /// Summarises what lies in the windows of every run, up to a run more on both sides.
  void look_around(Circle& circle) {
    const int length = n_ + 2 * window_;
    circle.parts.clear();
    for (int at = 0; at < length; at += kRun) circle.parts.push_back(circle.summary(at));
    circle.near.assign(static_cast<std::size_t>(runs()), {});
    for (int run = 0; run < runs(); ++run) {
      const int last = std::min(length, begin(run) + kRun + 2 * window_) - 1;
      for (int part = begin(run) / kRun; part <= last / kRun; ++part)
        circle.near[static_cast<std::size_t>(run)].add(
            circle.parts[static_cast<std::size_t>(part)]);
    }
  }

  /// Computes the bounds of a run's nodes before rounding is subtracted.
  Lanes relax(int c, int solution, bool meets_other, int run) {
    const Circle& here = circle(c, solution);
    const int at = window_ + begin(run), count = std::min(kRun, n_);
    Lanes best = Lanes::Constant(kNever);
    const Summary own = here.summary(at);
    if (own.least == kNever) return best;
    const auto worst_of_all = [&] {
      return (here.lanes(here.value, at) < kNever).select(best, 0).maxCoeff();
    };
    relax_with(here, begin(run), count, circle(c - 1, solution), best.data());
    float worst = worst_of_all();
    const int side = lattice_.elbow_side_of(solution),
              first = meets_other ? 0 : first_solution(side);
    for (int other = first;
         other < (meets_other ? lattice_.solutions() : first + lattice_.solutions() / 2); ++other) {
      const Circle& before = circle(c - 1, other);
      if (other == solution || !before.alive) continue;
      const Summary& near = before.near[static_cast<std::size_t>(run)];
      float norm = 0;
      for (std::size_t m = 0; m < kMiddle.size(); ++m)
        if (task_.turn[kMiddle[m]] == 0)
          norm = std::max(norm, task_.scale[kMiddle[m]] * own.joint[m].gap(near.joint[m]));
      if (near.least == kNever || near.least + norm >= worst) continue;
      relax_with(here, begin(run), count, before, best.data());
      worst = worst_of_all();
    }
    return best;
  }

  void relax_with(const Circle& here, int begin, int count, const Circle& before,
                  float* best) const {
    if (!before.alive) return;
    int first = begin, last = begin + count - 1 + 2 * window_;  // positions in `before`
    while (first <= last && before.value[static_cast<std::size_t>(first)] == kNever) ++first;
    while (first <= last && before.value[static_cast<std::size_t>(last)] == kNever) --last;
    if (first > last) return;
    const int low = std::max(begin, first - count + 1), high = std::min(begin + 2 * window_, last);
    RelaxTask<float> task = task_;
    task.n = count;
    task.offsets = high - low + 1;
    for (std::size_t j = 0; j < kDof; ++j) {
      task.from[j] = here.q[j].data() + window_ + begin;
      task.to[j] = before.q[j].data() + low;
    }
    task.value = before.value.data() + low;
    task.best = best;
    relax_kernels().coarse(task);
  }

  const SrsLattice& lattice_;
  int stride_;
  const Budget& budget_;
  const ParallelFor& work_;
  int n_, window_;
  RelaxTask<float> task_;
  double lost_ = 0;
  bool fits_ = true;
  std::array<std::vector<Circle>, 2> circles_;  // [c % 2][solution]
  std::vector<LayerNodes> nodes_;               // scratch of load(): [elbow side]
};

}  // namespace

ChordLowerBound::ChordLowerBound(const SrsLattice& lattice, const Budget& budget,
                                 const ParallelFor& work)
    : stride_(stride_of(lattice)), last_(lattice.layers() - 1), width_(lattice.width()) {
  const TraceSpan span("coarse bound");
  Chords chords(lattice, stride_, budget, work);
  if (!chords.fits()) return;
  const int coarse = chords.layers();
  rows_.resize(static_cast<std::size_t>(coarse) * static_cast<std::size_t>(width_));
  for (int c = 0; c < coarse;) {
    const int next = chords.advance(c, rows_.data() + static_cast<std::ptrdiff_t>(c) * width_);
    if (next < 0) {
      best_ = std::numeric_limits<double>::infinity();
      return;
    }
    ik_nodes_ += static_cast<std::int64_t>(next - c) * width_;
    c = next;
  }
  best_ = *std::min_element(rows_.end() - width_, rows_.end());
}

const float* ChordLowerBound::row(int layer) const {
  if (rows_.empty() || (layer % stride_ != 0 && layer != last_)) return nullptr;
  return rows_.data() + static_cast<std::ptrdiff_t>((layer + stride_ - 1) / stride_) * width_;
}

}  // namespace swivel
