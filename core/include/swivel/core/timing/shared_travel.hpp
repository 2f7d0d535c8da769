// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// The travel of an arm's tool along its path, m, as a function of a parameter (m) that it shares
/// with another arm: never descending, and twice continuously differentiable but where both rest.
/// Quintic polynomials between knots.
class SharedTravel {
 public:
  /// A value of the parameter, the travel there, and its first and second derivative on both sides.
  struct Knot {
    double x = 0, travel = 0;
    std::array<double, 2> slope{}, bend{};  ///< before and after
  };
  /// A waypoint at which the ratio of both tools' speeds changes, over `reach` on both sides of it.
  struct Blend {
    double x = 0, reach = 0;
  };
  SharedTravel() = default;
  /// Takes at least two knots, with ascending x.
  explicit SharedTravel(std::vector<Knot> knots, std::vector<Blend> blends = {});

  /// Returns the travel at a parameter; at those beyond the ends, that of the end.
  [[nodiscard]] double travel(double x) const;
  /// Returns the first and second derivative of the travel at a parameter.
  [[nodiscard]] std::array<double, 2> derivatives(double x) const;
  /// Returns the parameter at a travel, the least one where the tool stands still.
  [[nodiscard]] double parameter(double travel) const;
  [[nodiscard]] const std::vector<Knot>& knots() const { return knots_; }
  [[nodiscard]] const std::vector<Blend>& blends() const { return blends_; }
  /// Returns false if the travel descends anywhere from knot k to the next.
  [[nodiscard]] bool ascends(std::size_t k) const;

 private:
  struct Piece {
    double length = 0;  // m of the parameter
    std::array<double, 6> c{};
  };
  struct At {
    std::size_t piece = 0;
    double u = 0;  // 0 to 1
  };
  [[nodiscard]] At at(double x) const;

  std::vector<Knot> knots_;
  std::vector<Piece> pieces_;
  std::vector<Blend> blends_;
};

/// The parameter by which two arms move, and the travel of either tool over it.
struct CommonParameter {
  std::array<SharedTravel, 2> travel;
  /// Layers at which both arms rest: corners of either path that are not rounded, and waypoints at
  /// which the ratio of the tools' speeds changes and that have no room for a blend.
  std::vector<int> rests;
  /// Waypoints at which the ratio changes over a blend.
  std::vector<int> blended;
};
/// Returns the common parameter of two tool paths with as many layers, which are simultaneous.
/// Between two waypoints it grows evenly from layer to layer, by the longer of both travels in all.
/// Tools are at their waypoints at one time; where the ratio of their speeds changes there, it does
/// so over `most_reach` (m) on both sides at most, and both rest there if that is 0. `follower`:
/// the arm whose path the other's tool carries, or -1: its layers are simultaneous with the
/// leader's, but for blends, by which either tool is off its place by 0.05 mm at most.
[[nodiscard]] CommonParameter common_parameter(const std::array<const ToolPath*, 2>& paths,
                                               int follower, double most_reach);

}  // namespace swivel
