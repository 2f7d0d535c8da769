// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>

#include "drawing.hpp"
#include "map_cells.hpp"
#include "swivel/core/base/angle.hpp"

namespace swivel {

using namespace detail;

namespace {

/// Returns the colour of a node as SVG writes it.
std::string colour_of(const LatticeMap::Node& node) {
  switch (node.state) {
    case NodeState::kNoIk:
      return "#ffffff";
    case NodeState::kSingular:
      return "#cc79a7";
    case NodeState::kJointLimit:
      return kJointColour[node.cause];
    case NodeState::kNotLookedAt:
      return "#dcdcdc";
    case NodeState::kFree:
      return node.proved ? "#7ed0b4" : "#00795a";
    case NodeState::kBlocked:
      return kBlockerColour[node.cause % kBlockerColour.size()];
  }
  return "#ffffff";
}

/// Returns the marks of the coordinate: where they are, in cells from the lower edge of a panel,
/// and what they say, in rad.
std::vector<std::pair<double, std::string>> marks(const LatticeMap& map) {
  if (map.closed) {
    const double quarter = map.angles / 4.0;
    return {
        {0, "-π"}, {quarter, "-π/2"}, {2 * quarter, "0"}, {3 * quarter, "π/2"}, {4 * quarter, "π"}};
  }
  const double high = map.low + (map.angles - 1) * map.step;
  if (map.angles == 1) return {{0.5, number(map.value(0))}};
  double each = 1;
  for (const double candidate : {0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002})
    if ((high - map.low) / each < 3) each = candidate;
  std::vector<std::pair<double, std::string>> marks;
  for (double k = std::ceil(map.low / each); k * each <= high; ++k)
    marks.emplace_back((k * each - map.low) / map.step + 0.5, number(wrap_angle(k * each)));
  return marks;
}

/// Draws a lattice map from top to bottom: a panel per inhabited IK solution, then the legend.
class MapDrawing {
 public:
  explicit MapDrawing(const LatticeMap& map)
      : map_(map), cells_(map, 620, 252), solutions_(map.inhabited_solutions()), seen_(map) {}

  /// Returns the SVG document.
  std::string document() {
    const double height_of_legend = 18.0 * static_cast<double>(5 + kDof + map_.blockers.size());
    const double width = kLeft + kPanelWidth + kRight;
    drawing_.rectangle(
        0, 0, width,
        kTop + static_cast<double>(solutions_.size()) * (kPanelHeight + kGap) + height_of_legend,
        "#ffffff");
    for (const int solution : solutions_) {
      draw_cells(solution);
      draw_path(solution);
      draw_axes(solution);
      top_ += kPanelHeight + kGap;
    }
    draw_legend();
    return drawing_.document(width, top_);
  }

 private:
  static constexpr double kLeft = 52, kPanelWidth = 620, kPanelHeight = 190, kTop = 24, kGap = 52,
                          kRight = 24;

  /// A node stands for the stretch halfway to its neighbours, so the first and last layer are half
  /// as wide.
  [[nodiscard]] double x_of(double layer) const {
    return kLeft + kPanelWidth * std::clamp(layer, 0.0, map_.layers - 1.0) / (map_.layers - 1);
  }
  [[nodiscard]] double y_of(double angle) const {
    return top_ + kPanelHeight * (1 - angle / map_.angles);
  }
  /// Returns true if some cell stands for more than one node.
  [[nodiscard]] bool merges_nodes() const { return cells_.layers_each * cells_.angles_each > 1; }

  /// Draws the cells of a panel and notes their states for the legend. Equal neighbours in a row
  /// become one rectangle.
  void draw_cells(int solution) {
    for (int row = 0; row < cells_.rows; ++row) {
      const double low = row * cells_.angles_each,
                   high = std::min(map_.angles, (row + 1) * cells_.angles_each);
      for (int column = 0; column < cells_.columns;) {
        const LatticeMap::Node node = cells_.node(solution, column, row);
        seen_.see(node);
        int end = column + 1;
        for (; end < cells_.columns; ++end) {
          const LatticeMap::Node other = cells_.node(solution, end, row);
          if (other != node) break;
        }
        const double from = x_of(column * cells_.layers_each - 0.5),
                     to = x_of(end * cells_.layers_each - 0.5);
        if (node.state != NodeState::kNoIk)
          drawing_.rectangle(from, y_of(high), to - from, y_of(low) - y_of(high), colour_of(node));
        column = end;
      }
    }
  }

  /// Draws a stretch of the path, black with a white rim; nothing for fewer than two points.
  void draw_stretch(const std::vector<std::pair<double, double>>& points) {
    if (points.size() < 2) return;
    drawing_.line(points, "#ffffff", 4);
    drawing_.line(points, "#000000", 2);
  }

  /// Draws the stretches of the path that lie in the panel, with dots where it changes branch.
  void draw_path(int solution) {
    std::vector<std::pair<double, double>> stretch;
    const auto end_stretch = [&] {
      draw_stretch(stretch);
      stretch.clear();
    };
    const std::vector<int>& path = map_.path_in(solution);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const int slot = path[i], angle = slot % map_.angles;
      const bool here = slot / map_.angles == solution;
      const bool changes = i > 0 && path[i - 1] / map_.angles != slot / map_.angles;
      const bool through_pi =
          i > 0 && map_.closed && std::abs(path[i - 1] % map_.angles - angle) > map_.angles / 2;
      if (here && !changes && through_pi) end_stretch();
      if (!here) {
        end_stretch();
        continue;
      }
      stretch.emplace_back(x_of(static_cast<double>(i)), y_of(angle + 0.5));
      if (changes || (i + 1 < path.size() && path[i + 1] / map_.angles != solution))
        drawing_.circle(stretch.back().first, stretch.back().second, 4, "#000000");
    }
    end_stretch();
  }

  /// Draws frame, title and marks of a panel.
  void draw_axes(int solution) {
    drawing_.frame(kLeft, top_, kPanelWidth, kPanelHeight);
    drawing_.text(kLeft, top_ - 7, "start", map_.solution_name(solution));
    for (const auto& [angle, name] : marks(map_))
      drawing_.text(kLeft - 6, y_of(angle) + 4, "end", name);
    drawing_.text(14, top_ + kPanelHeight / 2, "middle", map_.letter(solution));
    for (int k = 0; k <= 5; ++k) {
      const double layer = (map_.layers - 1) * k / 5.0;
      drawing_.text(x_of(layer), top_ + kPanelHeight + 15, "middle",
                    number(map_.s[static_cast<std::size_t>(layer + 0.5)]));
    }
    drawing_.text(kLeft + kPanelWidth / 2, top_ + kPanelHeight + 29, "middle", "s (m)");
  }

  void draw_legend() {
    if (!map_.path.empty()) explain("#000000", seen_.path_meaning() + "; dots: change of branch");
    for (const auto& [node, meaning] : seen_.entries()) explain(colour_of(node), meaning);
    if (!map_.grid())
      remark(map_.letter(solutions_.empty() ? 0 : solutions_.front()) + std::string(": ") +
             map_.coordinate_name() +
             ", rad. Between two nodes of an arc of solutions the nearer one is shown" +
             (merges_nodes() ? ", of several a blocked one first, then a free one." : "."));
    else if (merges_nodes())
      remark("A cell stands for up to " + std::to_string(cells_.layers_each) + " x " +
             std::to_string(cells_.angles_each) +
             " nodes and shows a blocked one first, then a free one.");
  }
  /// Adds a line to the legend that explains a colour.
  void explain(const std::string& colour, const std::string& meaning) {
    drawing_.rectangle(kLeft, top_ - 10, 14, 12, colour);
    drawing_.frame(kLeft, top_ - 10, 14, 12);
    drawing_.text(kLeft + 22, top_, "start", meaning);
    top_ += 18;
  }
  /// Adds a line of text to the legend.
  void remark(const std::string& text) {
    drawing_.text(kLeft, top_, "start", text);
    top_ += 18;
  }

  const LatticeMap& map_;
  const MapCells cells_;
  const std::vector<int> solutions_;  ///< whose panels are drawn
  MapLegend seen_;
  Drawing drawing_;
  double top_ = kTop;  ///< upper edge of what is drawn next
};

}  // namespace

std::string to_svg(const LatticeMap& map) {
  return MapDrawing(map).document();
}

}  // namespace swivel
