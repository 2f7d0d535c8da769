// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>

#include "drawing.hpp"
#include "map_cells.hpp"
#include "outline.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/report/run_map.hpp"

namespace swivel {

using namespace detail;

namespace {

/// Returns the marks of the coordinate: where they are, in cells from the lower edge of a panel,
/// and what they say, in the coordinate's unit.
std::vector<std::pair<double, std::string>> marks(const LatticeMap& map) {
  const auto name = [&](double value) { return formatted("%.4g", value * map.scale() + 0.0); };
  std::vector<std::pair<double, std::string>> marks;
  if (map.closed) {
    for (int k = 0; k <= 4; ++k) marks.emplace_back(k * map.angles / 4.0, name(k * kPi / 2 - kPi));
    return marks;
  }
  const double high = map.low + (map.angles - 1) * map.step;
  if (map.angles == 1) return {{0.5, name(map.value(0))}};
  const double span = (high - map.low) * map.scale();
  double each = 45;
  for (const double candidate : {20., 10., 5., 2., 1., 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005})
    if (span / each < 3) each = candidate;
  for (double k = std::ceil(map.low * map.scale() / each); k * each <= high * map.scale(); ++k) {
    const double at = k * each / map.scale();
    marks.emplace_back((at - map.low) / map.step + 0.5, name(map.slides ? at : wrap_angle(at)));
  }
  return marks;
}

/// Returns the marks along the path: the layer, not always whole, at which s (m, of each layer) has
/// a round value, and that value.
std::vector<std::pair<double, std::string>> marks_along(const std::vector<double>& s) {
  constexpr double kMost = 6, kSlack = 1e-9;
  const double span = s.back() - s.front(), decade = std::pow(10, std::floor(std::log10(span)));
  if (!(span > 0)) return {{0, number(s.front())}};
  double each = decade;
  for (const double candidate : {0.5, 0.2, 0.1})
    if (span / (candidate * decade) <= kMost) each = candidate * decade;
  std::vector<std::pair<double, std::string>> marks;
  for (double k = std::ceil(s.front() / each - kSlack); k * each <= s.back() + kSlack; ++k) {
    const auto next = std::lower_bound(s.begin(), s.end(), k * each - kSlack);
    auto layer = static_cast<double>(next - s.begin());
    if (next != s.begin() && *next > *(next - 1)) layer -= (*next - k * each) / (*next - next[-1]);
    marks.emplace_back(layer, formatted("%.4g", k * each + 0.0));
  }
  return marks;
}

/// Draws a lattice map from top to bottom: its name if it has one, a panel per inhabited IK
/// solution, then the legend.
class MapDrawing {
  static constexpr double kLeft = 52, kPanelWidth = 620, kPanelHeight = 190, kTop = 24, kGap = 52,
                          kRight = 24;
  static constexpr std::size_t kMostInMargin = 9;  ///< letters of a text left of a panel

 public:
  static constexpr double kWidth = kLeft + kPanelWidth + kRight;

  /// Draws into `drawing`, from `top` on.
  MapDrawing(const LatticeMap& map, Drawing& drawing, double top)
      : map_(map),
        cells_(map, 620, 252),
        solutions_(map.inhabited_solutions()),
        seen_(map),
        drawing_(drawing),
        top_(top) {}

  /// Draws the map. Returns where it ends.
  double draw(const std::string& name = "") {
    const double height_of_name = name.empty() ? 0 : 30,
                 height_of_legend = 18.0 * static_cast<double>(5 + kDof + map_.blockers.size());
    drawing_.rectangle(0, top_, kWidth,
                       height_of_name + kTop +
                           static_cast<double>(solutions_.size()) * (kPanelHeight + kGap) +
                           height_of_legend,
                       "#ffffff");
    if (!name.empty()) drawing_.text(kLeft, top_ + 22, "start", name);
    top_ += height_of_name + kTop;
    for (const int solution : solutions_) {
      const std::vector<LatticeMap::Node> nodes = nodes_of(solution);
      draw_cells(nodes);
      draw_lines(nodes);
      draw_path(solution);
      draw_axes(solution);
      top_ += kPanelHeight + kGap;
    }
    draw_legend();
    return top_;
  }

 private:
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

  /// Returns the nodes that the cells of a panel show, by row and column.
  [[nodiscard]] std::vector<LatticeMap::Node> nodes_of(int solution) const {
    std::vector<LatticeMap::Node> nodes;
    for (int row = 0; row < cells_.rows; ++row)
      for (int column = 0; column < cells_.columns; ++column)
        nodes.push_back(cells_.node(solution, column, row));
    return nodes;
  }
  /// Left edge of a column, and lower edge of a row.
  [[nodiscard]] double left_of(int column) const { return x_of(column * cells_.layers_each - 0.5); }
  [[nodiscard]] double low_of(int row) const {
    return y_of(std::min(map_.angles, row * cells_.angles_each));
  }

  /// Draws the cells of a panel, those of one colour as one area, and notes their states for the
  /// legend.
  void draw_cells(const std::vector<LatticeMap::Node>& nodes) {
    std::map<std::string, char> colours;  // and whether they are hatched
    std::vector<std::string> colour_of;
    for (const LatticeMap::Node& node : nodes) {
      seen_.see(node);
      const bool drawn = node.state != NodeState::kNoIk;
      colour_of.push_back(drawn ? colour_of_node(map_, node) : "");
      if (drawn) colours[colour_of.back()] = node.state == NodeState::kJointLimit;
    }
    for (const auto& [colour, hatched] : colours) {
      const auto is = [&, &shown = colour](int row, int column) {
        return colour_of[static_cast<std::size_t>(row * cells_.columns + column)] == shown;
      };
      std::string d;
      for (const std::vector<GridCorner>& loop : outlines(cells_.rows, cells_.columns, is))
        d += around(loop);
      drawing_.area(d, colour);
      if (hatched != 0) drawing_.area(d, drawing_.hatching(palette::kHatch));
    }
  }
  /// Returns the loop of corners of cells as a closed path of SVG.
  [[nodiscard]] std::string around(const std::vector<GridCorner>& loop) const {
    const auto coordinate = [](double value) {
      std::string text = formatted("%.1f", value);
      if (text.ends_with(".0")) text.resize(text.size() - 2);
      return text;
    };
    std::string d =
        "M" + coordinate(left_of(loop[0].column)) + "," + coordinate(low_of(loop[0].row));
    for (std::size_t k = 1; k < loop.size(); ++k)
      d += k % 2 == 1 ? "H" + coordinate(left_of(loop[k].column))
                      : "V" + coordinate(low_of(loop[k].row));
    return d + "Z";
  }

  /// Returns the colour of the line between two cells, or null: where their contrast is low, or
  /// where one colour has two causes. Hatching parts a limit from all else.
  [[nodiscard]] const char* line(const LatticeMap::Node& one, const LatticeMap::Node& other) const {
    if (one == other) return nullptr;
    if ((one.state == NodeState::kJointLimit) != (other.state == NodeState::kJointLimit))
      return nullptr;
    return line_between(colour_of_node(map_, one), colour_of_node(map_, other));
  }
  /// Draws the lines between the cells of a panel, each as long as it goes straight on.
  void draw_lines(const std::vector<LatticeMap::Node>& nodes) {
    std::map<std::string, std::string> paths;
    std::map<std::uint64_t, const char*> known;
    const auto key = [](const LatticeMap::Node& node) {
      return static_cast<std::uint64_t>(node.state) << 9 | node.cause << 1 | node.proved;
    };
    const auto between = [&](std::size_t a, std::size_t b) {
      const auto [at, fresh] = known.emplace(key(nodes[a]) << 20 | key(nodes[b]), nullptr);
      if (fresh) at->second = line(nodes[a], nodes[b]);
      return at->second;
    };
    const auto columns = static_cast<std::size_t>(cells_.columns);
    for (int row = 1; row < cells_.rows; ++row)
      for (int column = 0, end = 0; column < cells_.columns; column = end) {
        const auto at = [&](int c) { return static_cast<std::size_t>(row) * columns + c; };
        const char* const stroke = between(at(column), at(column) - columns);
        for (end = column + 1;
             end < cells_.columns && between(at(end), at(end) - columns) == stroke;)
          ++end;
        if (stroke != nullptr)
          paths[stroke] += formatted("M%.1f,%.1fH%.1f", left_of(column), low_of(row), left_of(end));
      }
    for (int column = 1; column < cells_.columns; ++column)
      for (int row = 0, end = 0; row < cells_.rows; row = end) {
        const auto at = [&](int r) { return static_cast<std::size_t>(r) * columns + column; };
        const char* const stroke = between(at(row), at(row) - 1);
        for (end = row + 1; end < cells_.rows && between(at(end), at(end) - 1) == stroke;) ++end;
        if (stroke != nullptr)
          paths[stroke] += formatted("M%.1f,%.1fV%.1f", left_of(column), low_of(row), low_of(end));
      }
    for (const auto& [stroke, d] : paths) drawing_.path(d, stroke, 0.7);
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
    const std::string coordinate = map_.letter(solution) + ", " + map_.unit();
    if (coordinate.size() <= kMostInMargin)
      drawing_.text(kLeft - 6, top_ - 7, "end", coordinate);
    else
      drawing_.text(kLeft + kPanelWidth, top_ - 7, "end", "vertical: " + coordinate);
    for (const auto& [layer, name] : marks_along(map_.s))
      drawing_.text(x_of(layer), top_ + kPanelHeight + 15, "middle", name);
    drawing_.text(kLeft + kPanelWidth, top_ + kPanelHeight + 29, "end", "s, m");
  }

  void draw_legend() {
    if (!map_.path.empty()) explain("#000000", seen_.path_meaning() + "; dots: change of branch");
    for (const MapLegend::Group& group : seen_.groups())
      explain(colour_of_node(map_, group.node), group.words(),
              group.node.state == NodeState::kJointLimit);
    if (!map_.grid())
      remark(map_.letter(solutions_.empty() ? 0 : solutions_.front()) + ": " +
             (map_.joint < 0 ? map_.coordinate_name() : "position of the joint") + ", " +
             map_.unit() + ". Between two nodes of an arc of solutions the nearer one is shown" +
             (merges_nodes() ? ", of several a blocked one first, then a free one." : "."));
    else if (merges_nodes())
      remark("A cell stands for up to " + std::to_string(cells_.layers_each) + " x " +
             std::to_string(cells_.angles_each) +
             " nodes and shows a blocked one first, then a free one.");
  }
  /// Adds a line to the legend that explains a colour.
  void explain(const std::string& colour, const std::string& meaning, bool hatched = false) {
    drawing_.rectangle(kLeft, top_ - 10, 14, 12, colour);
    if (hatched) drawing_.hatch(kLeft, top_ - 10, 14, 12, palette::kHatch);
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
  Drawing& drawing_;
  double top_;  ///< upper edge of what is drawn next
};

}  // namespace

std::string to_svg(const LatticeMap& map) {
  Drawing drawing;
  const double end = MapDrawing(map, drawing, 0).draw();
  return drawing.document(MapDrawing::kWidth, end);
}

std::string to_svg(std::span<const RunMap> maps) {
  Drawing drawing;
  double end = 0;
  for (const RunMap& of : maps) end = MapDrawing(of.map, drawing, end).draw(of.name);
  return drawing.document(MapDrawing::kWidth, end);
}

}  // namespace swivel
