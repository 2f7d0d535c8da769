// SPDX-License-Identifier: BSD-3-Clause
// Finds the arcs of arm angles within the joint limits, and moves nodes of cells onto them.
#include <algorithm>
#include <cmath>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"

namespace swivel {

namespace {

constexpr double kHair = 1e-6;  // rad: distance in arm angle of moved nodes from the ends of arcs

}  // namespace

int SrsLattice::triple_winding(int solution, int triple) const {
  const int wrist = triple_windings(1), elbow = images_[3].count, winding = solution % windings_;
  return triple == 0 ? winding / (wrist * elbow) : winding % wrist;
}

void SrsLattice::prepare_arcs() {
  for (int triple = 0; triple < 2; ++triple) {
    triple_limits_[static_cast<std::size_t>(triple)].clear();
    const std::size_t first = triple == 0 ? 0 : 4;
    int count = 1;
    for (std::size_t j = first; j < first + 3; ++j) count *= images_[j].count;
    for (int winding = 0; winding < count; ++winding) {
      std::array<std::array<double, 2>, 3> ranges;
      int rest = winding;
      for (std::size_t j = 3; j-- > 0;) {
        const Images& images = images_[first + j];
        const int image = rest % images.count;
        rest /= images.count;
        const JointLimit& limit = chain_->limit[first + j];
        const double begin = images.base + image * kTwoPi, end = begin + kTwoPi;
        if (continuous_[first + j]) {
          ranges[j] = {begin, end};
          continue;
        }
        // For an arm that is not exact, images reach beyond the limits by the fit error. Where
        // nodes are inside the limits by as much, their rows surely are within them.
        const double inside = limits_.joint_margin - kLimitTolerance +
                              fit_error()[static_cast<Eigen::Index>(first + j)];
        ranges[j] = {std::max(begin, limit.lower + inside), std::min(end, limit.upper - inside)};
      }
      triple_limits_[static_cast<std::size_t>(triple)].emplace_back(
          ranges, triple == 0 ? arm_->shoulder.shift : arm_->wrist.shift);
    }
  }
}

void SrsLattice::triple_arcs(int layer, int solution, int triple,
                             std::vector<AngleArc>& out) const {
  const int branch = solution / windings_;
  const ElbowCircle& circle =
      elbow_circles_[static_cast<std::size_t>(layer)][branch & kElbowBit ? 1 : 0];
  const auto winding = static_cast<std::size_t>(triple_winding(solution, triple));
  const TripleLimits& limits = triple_limits_[static_cast<std::size_t>(triple)][winding];
  limits.arcs(triple == 0 ? circle.shoulder : circle.wrist,
              (branch & (triple == 0 ? kShoulderBit : kWristBit)) != 0, out);
}

bool SrsLattice::elbow_within(int layer, int solution) const {
  const int elbow = elbow_side_of(solution);
  if (!elbow_alive(layer, elbow)) return false;
  const Images& images = images_[3];
  const double turns = std::ceil(
      (images.base -
       elbow_circles_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(elbow)].q4) /
      kTwoPi);
  const double q4 =
      elbow_circles_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(elbow)].q4 +
      kTwoPi * (turns + winding_images(solution % windings_, 3));
  return q4 <= images.upper;
}

void SrsLattice::arcs(int layer, int solution, std::vector<AngleArc>& out) const {
  out.clear();
  if (!elbow_within(layer, solution)) return;
  std::vector<AngleArc> shoulder, wrist;
  triple_arcs(layer, solution, 0, shoulder);
  triple_arcs(layer, solution, 1, wrist);
  common_arcs(shoulder, wrist, out);
}

bool SrsLattice::proved_unreachable(int layer) const {
  if (!arm_->exact || is_given(layer)) return false;
  const ReachStatus reach = reach_[static_cast<std::size_t>(layer)];
  if (reach != ReachStatus::kReachable) return reach == ReachStatus::kOutOfReach;
  std::vector<AngleArc> found;
  for (int solution = 0; solution < solutions(); ++solution) {
    arcs(layer, solution, found);
    if (!found.empty()) return false;
  }
  return true;
}

void SrsLattice::place_off_grid_nodes(const Budget& budget) {
  const TraceSpan span("arcs");
  off_grid_.clear();
  off_grid_begin_.assign(1, 0);
  off_grid_branches_.assign(static_cast<std::size_t>(layers()), 0);
  // Arcs of each triple, computed once for the branches and windings that share them.
  std::array<std::vector<std::vector<AngleArc>>, 2> of_triple;  // [triple][sign, winding]
  std::array<std::vector<char>, 2> known;
  std::vector<AngleArc> arcs;
  for (int layer = 0; layer < layers(); ++layer) {
    if (layer % 64 == 0) budget.poll(Stage::kLattice, layer, layers());
    for (int side = 0; side < kElbowSides && !is_given(layer); ++side) {
      for (std::size_t triple = 0; triple < 2; ++triple) {
        of_triple[triple].resize(2 * triple_limits_[triple].size());
        known[triple].assign(of_triple[triple].size(), 0);
      }
      const int half = solutions() / kElbowSides;
      for (int solution = side * half; solution < (side + 1) * half; ++solution) {
        if (!elbow_within(layer, solution)) continue;
        const auto found = [&](int triple) -> const std::vector<AngleArc>& {
          const bool negative =
              (solution / windings_ & (triple == 0 ? kShoulderBit : kWristBit)) != 0;
          const auto t = static_cast<std::size_t>(triple),
                     k = 2 * static_cast<std::size_t>(triple_winding(solution, triple)) +
                         (negative ? 1 : 0);
          if (!known[t][k]) triple_arcs(layer, solution, triple, of_triple[t][k]);
          known[t][k] = 1;
          return of_triple[t][k];
        };
        if (found(0).empty() || found(1).empty()) continue;
        common_arcs(found(0), found(1), arcs);
        place_off_grid_nodes_of(layer, solution, arcs);
      }
    }
    off_grid_begin_.push_back(off_grid_.size());
  }
}

void SrsLattice::place_off_grid_nodes_of(int layer, int solution,
                                         const std::vector<AngleArc>& arcs) {
  struct Move {
    int cell;
    double phi, away;  // away: distance from the cell's grid angle, rad
  };
  std::vector<Move> moves;
  const double step = kTwoPi / angles_;
  const auto cell_at = [&](double phi) { return std::llround((phi + kPi) / step); };
  const auto angle_of_cell = [&](long long cell) {
    return -kPi + step * static_cast<double>(cell);
  };
  const auto add = [&](long long cell, double phi) {
    const int wrapped = static_cast<int>((cell % angles_ + angles_) % angles_);
    const double away = std::abs(phi - angle_of_cell(cell));
    const auto same = std::find_if(moves.begin(), moves.end(),
                                   [&](const Move& move) { return move.cell == wrapped; });
    if (same == moves.end())
      moves.push_back({wrapped, wrap_angle(phi), away});
    else if (away < same->away)
      *same = {wrapped, wrap_angle(phi), away};
  };
  for (const AngleArc& arc : arcs) {
    const double begin = arc.begin + kHair, end = arc.end - kHair;
    if (arc.whole() || end < begin) continue;
    const long long first = cell_at(begin), last = cell_at(end);
    const bool first_inside = angle_of_cell(first) >= begin && angle_of_cell(first) <= end;
    const bool last_inside = angle_of_cell(last) >= begin && angle_of_cell(last) <= end;
    if (first == last && !first_inside) add(first, (begin + end) / 2);
    if (first == last) continue;
    if (!first_inside) add(first, begin);
    if (!last_inside) add(last, end);
  }
  std::sort(moves.begin(), moves.end(),
            [](const Move& a, const Move& b) { return a.cell < b.cell; });
  for (const Move& move : moves) {
    const int slot = solution * angles_ + move.cell;
    const auto own = static_cast<std::size_t>(move.cell);
    const double phi = angle_of_cell(move.cell);
    const bool near = std::any_of(arcs.begin(), arcs.end(), [&](const AngleArc& arc) {
      return std::abs(wrap_angle(phi - (arc.begin + arc.end) / 2)) <=
             (arc.end - arc.begin) / 2 + 10 * kHair;
    });
    // Another arc may contain the cell's grid angle, or end near it. Solving the node there
    // decides, and for an arm that is not exact always, because its bounds are wider than the arcs.
    if ((near || !arm_->exact) && solved(layer, slot, sine_[own], cosine_[own])) continue;
    const auto q = solved(layer, slot, std::sin(move.phi), std::cos(move.phi));
    if (!q) continue;  // the pose is near a singularity
    off_grid_.push_back({slot, move.phi, *q});
    off_grid_branches_[static_cast<std::size_t>(layer)] |=
        static_cast<std::uint8_t>(1 << branch_of(slot));
  }
}

const SrsLattice::OffGridNode* SrsLattice::find_off_grid(int layer, int slot) const {
  const std::span<const OffGridNode> here = off_grid_nodes(layer);
  const auto found =
      std::lower_bound(here.begin(), here.end(), slot,
                       [](const OffGridNode& moved, int wanted) { return moved.slot < wanted; });
  return found != here.end() && found->slot == slot ? &*found : nullptr;
}

}  // namespace swivel
