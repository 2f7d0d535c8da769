// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/motion/layer_solver.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

class PoseNewton;

/// The joints of each layer of a path as a function of the length along its self-motion curve from
/// given joints, rad, of either sign. Joint limits are ignored. Curves are followed as far as they
/// are asked about, until the arm is singular; therefore an object must not be used by several
/// threads at once. Deterministic, and independent of what was asked before.
class ArcLengths final : public LayerSolver {
 public:
  /// Takes for each layer the joints that length 0 belongs to, at the layer's pose or near it. The
  /// path must outlive this object.
  ArcLengths(const Chain& chain, const ToolPath& path, std::vector<Config> origins);
  ~ArcLengths() override;

  [[nodiscard]] int layers() const override { return static_cast<int>(curves_.size()); }
  [[nodiscard]] double travel(int layer) const override { return path_->layer(layer).travel; }
  [[nodiscard]] std::optional<Config> joints(int layer, double length) const override;
  /// Returns the length at which the layer's curve is nearest to joints interpolated between those
  /// of the layers before and after; 0 where it is not found.
  [[nodiscard]] double between(int layer, int before, double x, int after, double y) const override;

 private:
  struct Point {
    Config q, tangent;  // tangent: points away from the origin
    double length = 0;
  };
  struct Curve {
    std::array<std::vector<Point>, 2> side;  // points ahead and behind; both begin with the origin
    std::array<bool, 2> ended{};
  };
  [[nodiscard]] std::optional<Point> point(int layer, double length) const;
  bool follow(Curve& curve, std::size_t side, const Pose& tool) const;

  std::unique_ptr<const PoseNewton> newton_;
  const ToolPath* path_;
  mutable std::vector<Curve> curves_;
};

}  // namespace swivel
