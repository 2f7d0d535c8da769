// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel {

/// The lattice of an arm whose motion is given: one node for each row, and one path, whose rows are
/// those given. Its steps have no limits: what a given motion must keep is checked before it is
/// searched (require_sound()).
class GivenLattice final : public ExplicitLattice {
 public:
  /// `path` has a layer for each row. References must outlive the lattice.
  GivenLattice(const Chain& chain, const ToolPath& path, const PathProblem& problem,
               const std::vector<TrajectoryRow>& rows)
      : ExplicitLattice(chain, path, without_limits(problem), nodes_of(rows)), rows_(rows) {}

  [[nodiscard]] std::vector<TrajectoryRow> path_rows(const std::vector<int>&) const override {
    return rows_;
  }

 private:
  static PathProblem without_limits(PathProblem problem) {
    problem.limits = Limits();
    problem.limits.joint_step = 1e3;
    problem.limits.tool_path_error = std::nullopt;
    return problem;
  }
  static std::vector<std::vector<Point>> nodes_of(const std::vector<TrajectoryRow>& rows) {
    std::vector<std::vector<Point>> layers;
    for (const TrajectoryRow& row : rows) {
      Point point;
      point.q = row.q;
      point.phi = row.phi;
      point.branch = row.branch;
      point.along = {0, 0};
      layers.push_back({point});
    }
    layers.front().front().along[0] = -1;
    layers.back().front().along[1] = -1;
    return layers;
  }

  const std::vector<TrajectoryRow>& rows_;
};

/// Says of a given motion that all of it is valid.
class GivenValidity final : public Validity {
 public:
  void nodes(std::span<const NodeQuestion>, std::span<NodeAnswer> answers) override {
    std::fill(answers.begin(), answers.end(), NodeAnswer{.valid = true});
  }
  void edges(std::span<const EdgeQuestion>, std::span<std::uint8_t> answers) override {
    std::fill(answers.begin(), answers.end(), std::uint8_t{1});
  }
  [[nodiscard]] bool asks_edges() const override { return false; }
};

/// Returns a warning if steps of a path beside a given motion are longer than the resolution says,
/// since that motion has few rows; else an empty text. `name`: of the arm.
inline std::string long_step_warning(const ToolPath& path, const Resolution& resolution,
                                     const std::string& name) {
  constexpr double kRounding = 1e-6;  // of the resolution
  double length = 0, angle = 0;
  for (int layer = 0; layer + 1 < path.size(); ++layer) {
    length = std::max(length, path.layer(layer).step_length);
    angle = std::max(angle, path.layer(layer).step_angle);
  }
  if (length <= resolution.ds * (1 + kRounding) && angle <= resolution.dalpha * (1 + kRounding))
    return "";
  return formatted(
      "steps of '%s' are up to %.3g mm and %.3g rad long, and resolution.ds and dalpha "
      "say %.3g mm and %.3g rad: its layers are the rows of the given motion",
      name.c_str(), 1e3 * length, angle, 1e3 * resolution.ds, resolution.dalpha);
}

}  // namespace swivel
