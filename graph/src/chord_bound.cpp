// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/chord_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernels/relax.hpp"
#include "swivel/core/timeline.hpp"

namespace swivel {

namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr int kRun = 16;  // angles relaxed at once

struct Interval {
  float low = kNever, high = -kNever;
  void add(float x) {
    low = x < low ? x : low;
    high = x > high ? x : high;
  }
  void add(const Interval& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  [[nodiscard]] float gap(const Interval& other) const { return std::max(low - other.high, other.low - high); }
};

constexpr std::array<std::size_t, 3> kMiddle{1, 3, 5};  // a branch flips only through the zero of one of these

/// What is known of the nodes of a run.
struct Summary {
  float least = kNever;                        // value
  std::array<Interval, kMiddle.size()> joint;  // kMiddle
  void add(const Summary& other) {
    least = std::min(least, other.least);
    for (std::size_t m = 0; m < joint.size(); ++m) joint[m].add(other.joint[m]);
  }
};

/// One label of one layer, from -window to angles + window around the circle.
struct Circle {
  bool alive = false;
  std::vector<float> q[kDof];
  std::vector<float> value;      // bound; kNever where no node is
  std::vector<Summary> summary;  // of each kRun padded positions
};

class Chords {
 public:
  explicit Chords(const Lattice& lattice)
      : lattice_(lattice), n_(lattice.angles()), window_(std::min(n_ / 2, ChordBound::kStride * lattice.window() + 1)) {
    const Cost& cost = lattice.cost();
    task_.metric = cost.metric == CostMetric::kL2 ? RelaxMetric::kL2 : RelaxMetric::kMax;
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
    // Rounding of joints, their difference, its norm, and of exact costs to 2^-40: a few units of 2^-24 of each.
    lost_ = 0x1p-20 * scales * (largest + kTwoPi) + 1e-10;
    fits_ = scales * (largest + kTwoPi) * lattice.layers() < 1e30;
    for (auto& layer : circles_) layer.resize(static_cast<std::size_t>(lattice.labels()));
  }

  [[nodiscard]] bool fits() const { return fits_; }

  /// The bounds of a layer's nodes from those of the layer given before; zeros in the first. False where none is reached.
  bool advance(int layer, float* row) {
    std::swap(circles_[0], circles_[1]);
    load(layer);
    const bool first = layer == 0;
    std::fill_n(row, lattice_.width(), kNever);
    bool any = false;
    for (int label = 0; label < lattice_.labels(); ++label) {
      Circle& here = circle(0, label);
      if (!here.alive) continue;
      float* best = row + static_cast<std::ptrdiff_t>(label) * n_;
      if (first) std::fill_n(best, n_, 0.0F);
      for (int k = 0; !first && k < n_; k += kRun) {
        const int begin = std::max(0, std::min(k, n_ - kRun));  // whole vectors: the last two runs may overlap
        relax(label, begin, std::min(kRun, n_), best + begin);
      }
      here.alive = false;
      for (int j = 0; j < n_; ++j) {
        const float kept = first ? 0 : (best[j] - static_cast<float>(lost_)) * (1 - 0x1p-20F);
        best[j] = here.value[static_cast<std::size_t>(window_ + j)] == 0 ? std::max(0.0F, kept) : kNever;
        here.alive |= best[j] != kNever;
      }
      any |= here.alive;
      std::copy_n(best, n_, here.value.begin() + window_);
      wrap(here.value);
      summarize(here);
    }
    return any;
  }

 private:
  Circle& circle(std::size_t which, int label) { return circles_[which][static_cast<std::size_t>(label)]; }
  void wrap(std::vector<float>& padded) const {
    std::copy_n(padded.begin() + n_, window_, padded.begin());
    std::copy_n(padded.begin() + window_, window_, padded.begin() + window_ + n_);
  }

  /// Joints, and value 0 where a node is.
  void load(int layer) {
    lattice_.solve(layer, 0, n_, nodes_);
    for (int label = 0; label < lattice_.labels(); ++label) {
      Circle& to = circle(0, label);
      to.alive = false;
      if (!nodes_.alive(label)) continue;
      const auto length = static_cast<std::size_t>(n_ + 2 * window_), start = static_cast<std::size_t>(window_);
      const double *shoulder = nodes_.shoulder_bar(label), *wrist = nodes_.wrist_bar(label);
      to.value.resize(length);
      float least = kNever;
      for (int j = 0; j < n_; ++j) {
        const auto bar = static_cast<float>(shoulder[j] + wrist[j]);
        to.value[start + static_cast<std::size_t>(j)] = bar;
        least = bar < least ? bar : least;
      }
      to.alive = least == 0;
      if (!to.alive) continue;
      for (int k = 0; k < kDof; ++k) {
        std::vector<float>& q = to.q[k];
        q.resize(length);
        const double* from = nodes_.q(label, k);
        std::transform(from, from + n_, q.begin() + window_, [](double x) { return static_cast<float>(x); });
        wrap(q);
      }
    }
  }

  void summarize(Circle& circle) const {
    const std::size_t length = circle.value.size(), run = kRun;
    circle.summary.assign((length + run - 1) / run, {});
    for (std::size_t k = 0; k < length; ++k) {
      if (circle.value[k] == kNever) continue;
      Summary& summary = circle.summary[k / run];
      summary.least = circle.value[k] < summary.least ? circle.value[k] : summary.least;
      for (std::size_t m = 0; m < kMiddle.size(); ++m) summary.joint[m].add(circle.q[kMiddle[m]][k]);
    }
  }
  /// Of padded positions begin ... end - 1 and up to a run more on both sides.
  static Summary summary_of(const Circle& circle, int begin, int end) {
    Summary sum;
    for (int s = begin / kRun; s <= (end - 1) / kRun; ++s) sum.add(circle.summary[static_cast<std::size_t>(s)]);
    return sum;
  }

  void relax(int label, int begin, int count, float* best) {
    const Circle& here = circle(0, label);
    Summary own;
    for (int k = 0; k < count; ++k) {
      const auto at = static_cast<std::size_t>(window_ + begin + k);
      if (here.value[at] == kNever) continue;
      own.least = 0;
      for (std::size_t m = 0; m < kMiddle.size(); ++m) own.joint[m].add(here.q[kMiddle[m]][at]);
    }
    if (own.least == kNever) return;
    relax_with(here, begin, count, circle(1, label), best);
    for (int other = 0; other < lattice_.labels(); ++other) {
      const Circle& before = circle(1, other);
      if (other == label || !before.alive) continue;
      float worst = 0;
      for (int k = 0; k < count; ++k) {
        const float given = here.value[static_cast<std::size_t>(window_ + begin + k)] + best[k];
        worst = given < kNever || here.value[static_cast<std::size_t>(window_ + begin + k)] == 0 ? std::max(worst, best[k]) : worst;
      }
      const Summary near = summary_of(before, begin, begin + count + 2 * window_);
      float norm = 0;
      for (std::size_t m = 0; m < kMiddle.size(); ++m)
        if (task_.turn[kMiddle[m]] == 0) norm = std::max(norm, task_.scale[kMiddle[m]] * own.joint[m].gap(near.joint[m]));
      if (near.least == kNever || near.least + norm >= worst) continue;
      relax_with(here, begin, count, before, best);
    }
  }

  void relax_with(const Circle& here, int begin, int count, const Circle& before, float* best) {
    if (!before.alive) return;
    int first = begin, last = begin + count - 1 + 2 * window_;  // positions in `before`
    while (first <= last && before.value[static_cast<std::size_t>(first)] == kNever) ++first;
    while (first <= last && before.value[static_cast<std::size_t>(last)] == kNever) --last;
    if (first > last) return;
    const int low = std::max(begin, first - count + 1), high = std::min(begin + 2 * window_, last);
    task_.n = count;
    task_.offsets = high - low + 1;
    for (std::size_t j = 0; j < kDof; ++j) {
      task_.from[j] = here.q[j].data() + window_ + begin;
      task_.to[j] = before.q[j].data() + low;
    }
    task_.value = before.value.data() + low;
    task_.best = best;
    relax_kernels().chord(task_);
  }

  const Lattice& lattice_;
  int n_, window_;
  ChordTask task_;
  double lost_ = 0;
  bool fits_ = true;
  std::array<std::vector<Circle>, 2> circles_;  // [here, before][label]
  LayerNodes nodes_;
};

}  // namespace

ChordBound::ChordBound(const Lattice& lattice) : last_(lattice.layers() - 1), width_(lattice.width()) {
  const Span span("chord bound");
  Chords chords(lattice);
  if (!chords.fits()) return;
  const int coarse = (last_ + kStride - 1) / kStride + 1;
  rows_.resize(static_cast<std::size_t>(coarse) * static_cast<std::size_t>(width_));
  for (int c = 0; c < coarse; ++c) {
    ik_nodes_ += width_;
    if (!chords.advance(std::min(c * kStride, last_), rows_.data() + static_cast<std::ptrdiff_t>(c) * width_)) {
      best_ = std::numeric_limits<double>::infinity();
      return;
    }
  }
  best_ = *std::min_element(rows_.end() - width_, rows_.end());
}

const float* ChordBound::row(int layer) const {
  if (rows_.empty() || (layer % kStride != 0 && layer != last_)) return nullptr;
  return rows_.data() + static_cast<std::ptrdiff_t>((layer + kStride - 1) / kStride) * width_;
}

}  // namespace swivel
