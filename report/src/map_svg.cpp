// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>

#include "drawing.hpp"
#include "map_cells.hpp"
#include "swivel/core/base/angle.hpp"

namespace swivel {

using namespace detail;

namespace {

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

/// Where marks of the coordinate are, in cells from the lower edge of a panel, and what they say,
/// rad.
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

}  // namespace

std::string to_svg(const LatticeMap& map) {
  constexpr double kLeft = 52, kPanelWidth = 620, kPanelHeight = 190, kTop = 24, kGap = 52,
                   kRight = 24;
  const MapCells cells(map, 620, 252);
  Drawing drawing;
  const std::vector<int> solutions = map.inhabited_solutions();
  const double height_of_legend = 18.0 * static_cast<double>(5 + kDof + map.blockers.size());
  const double width = kLeft + kPanelWidth + kRight;
  drawing.rectangle(
      0, 0, width,
      kTop + static_cast<double>(solutions.size()) * (kPanelHeight + kGap) + height_of_legend,
      "#ffffff");
  // A node stands for the stretch halfway to its neighbours, so the first and last layer are half
  // as wide.
  const auto x_of = [&](double layer) {
    return kLeft + kPanelWidth * std::clamp(layer, 0.0, map.layers - 1.0) / (map.layers - 1);
  };
  MapLegend seen(map);
  double top = kTop;
  for (const int solution : solutions) {
    const auto y_of = [&](double angle) { return top + kPanelHeight * (1 - angle / map.angles); };
    for (int row = 0; row < cells.rows; ++row) {
      const double low = row * cells.angles_each,
                   high = std::min(map.angles, (row + 1) * cells.angles_each);
      for (int column = 0; column < cells.columns;) {
        const LatticeMap::Node node = cells.node(solution, column, row);
        seen.see(node);
        int end = column + 1;  // cells alike are one rectangle
        for (; end < cells.columns; ++end) {
          const LatticeMap::Node other = cells.node(solution, end, row);
          if (other != node) break;
        }
        const double from = x_of(column * cells.layers_each - 0.5),
                     to = x_of(end * cells.layers_each - 0.5);
        if (node.state != NodeState::kNoIk)
          drawing.rectangle(from, y_of(high), to - from, y_of(low) - y_of(high), colour_of(node));
        column = end;
      }
    }
    std::vector<std::pair<double, double>> line;
    const auto flush = [&] {
      if (line.size() > 1) {
        drawing.line(line, "#ffffff", 4);
        drawing.line(line, "#000000", 2);
      }
      line.clear();
    };
    const std::vector<int>& path = map.path_in(solution);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const int slot = path[i], angle = slot % map.angles;
      const bool here = slot / map.angles == solution;
      const bool changes = i > 0 && path[i - 1] / map.angles != slot / map.angles;
      if (here && i > 0 && !changes && map.closed &&
          std::abs(path[i - 1] % map.angles - angle) > map.angles / 2)
        flush();  // through pi
      if (!here) {
        flush();
        continue;
      }
      line.emplace_back(x_of(static_cast<double>(i)), y_of(angle + 0.5));
      if (changes || (i + 1 < path.size() && path[i + 1] / map.angles != solution))
        drawing.circle(line.back().first, line.back().second, 4, "#000000");
    }
    flush();
    drawing.frame(kLeft, top, kPanelWidth, kPanelHeight);
    drawing.text(kLeft, top - 7, "start", map.solution_name(solution));
    for (const auto& [angle, name] : marks(map))
      drawing.text(kLeft - 6, y_of(angle) + 4, "end", name);
    drawing.text(14, top + kPanelHeight / 2, "middle", map.letter(solution));
    for (int k = 0; k <= 5; ++k) {
      const double layer = (map.layers - 1) * k / 5.0;
      drawing.text(x_of(layer), top + kPanelHeight + 15, "middle",
                   number(map.s[static_cast<std::size_t>(layer + 0.5)]));
    }
    drawing.text(kLeft + kPanelWidth / 2, top + kPanelHeight + 29, "middle", "s (m)");
    top += kPanelHeight + kGap;
  }
  const auto legend = [&](const std::string& colour, const std::string& meaning) {
    drawing.rectangle(kLeft, top - 10, 14, 12, colour);
    drawing.frame(kLeft, top - 10, 14, 12);
    drawing.text(kLeft + 22, top, "start", meaning);
    top += 18;
  };
  if (!map.path.empty()) legend("#000000", seen.path_meaning() + "; dots: change of branch");
  for (const auto& [node, meaning] : seen.entries()) legend(colour_of(node), meaning);
  if (!map.grid()) {
    drawing.text(kLeft, top, "start",
                 map.letter(solutions.empty() ? 0 : solutions.front()) + std::string(": ") +
                     map.coordinate_name() +
                     ", rad. Between two nodes of an arc of solutions the nearer one is shown" +
                     (cells.layers_each * cells.angles_each > 1
                          ? ", of several a blocked one first, then a free one."
                          : "."));
    top += 18;
  } else if (cells.layers_each * cells.angles_each > 1) {
    drawing.text(kLeft, top, "start",
                 "A cell stands for up to " + std::to_string(cells.layers_each) + " x " +
                     std::to_string(cells.angles_each) +
                     " nodes and shows a blocked one first, then a free one.");
    top += 18;
  }
  return drawing.document(width, top);
}

}  // namespace swivel
