// SPDX-License-Identifier: BSD-3-Clause
#include <map>

#include "map_cells.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/report/run_map.hpp"

namespace swivel {

using namespace detail;

namespace {

/// Returns the letter that stands for a node where there are no colours.
char symbol_of(const LatticeMap::Node& node) {
  switch (node.state) {
    case NodeState::kNoIk:
      return ' ';
    case NodeState::kSingular:
      return 's';
    case NodeState::kJointLimit:
      return static_cast<char>('1' + node.cause);
    case NodeState::kNotLookedAt:
      return '.';
    case NodeState::kFree:
      return node.proved ? '+' : 'o';
    case NodeState::kBlocked:
      return static_cast<char>(node.cause < 26 ? 'a' + node.cause : '#');
  }
  return '?';
}

/// Writes symbols on the colours of the map's nodes.
class MapText {
 public:
  MapText(const LatticeMap& map, bool coloured) : map_(map), coloured_(coloured) {}
  /// Returns a node's symbol.
  std::string node(const LatticeMap::Node& node) {
    if (!coloured_) return {symbol_of(node)};
    const std::string colour = colour_of_node(map_, node);
    const auto known = ansi_.find(colour);
    const AnsiColour ansi =
        known != ansi_.end() ? known->second : ansi_[colour] = ansi_colour(colour);
    return on_colour(ansi, {symbol_of(node)});
  }
  /// Returns the symbol of the path.
  [[nodiscard]] std::string path() const { return coloured_ ? on_colour({231, 16}, "*") : "*"; }

 private:
  const LatticeMap& map_;
  const bool coloured_;
  std::map<std::string, AnsiColour> ansi_;
};

}  // namespace

std::string to_text(const LatticeMap& map, int columns, bool coloured) {
  constexpr int kMargin = 8, kRows = 24;
  const MapCells cells(map, std::max(10, columns - kMargin), kRows);
  std::string text;
  MapLegend seen(map);
  MapText symbols(map, coloured);
  for (const int solution : map.inhabited_solutions()) {
    text += map.solution_name(solution) + "\n";
    for (int row = cells.rows - 1; row >= 0; --row) {
      const double value = map.value(row * cells.angles_each);
      text += row % 4 == 0 ? formatted(map.slides ? "%6.3f  " : "%6.1f  ", value * map.scale())
                           : std::string(kMargin, ' ');
      for (int column = 0; column < cells.columns; ++column) {
        const LatticeMap::Node node = cells.node(solution, column, row);
        seen.see(node);
        text += cells.on_path(solution, column, row) ? symbols.path() : symbols.node(node);
      }
      text += '\n';
    }
    const std::string from = map.s.front() > 0 ? formatted("%.3f", map.s.front()) : "0";
    text +=
        std::string(kMargin, ' ') + "s = " + from + formatted(" to %.3f m", map.s.back()) + "\n\n";
  }
  if (!map.path.empty()) text += symbols.path() + " " + seen.path_meaning() + "\n";
  for (const auto& [node, meaning] : seen.entries())
    text += symbols.node(node) + " " + printable(meaning) + "\n";
  const std::string name = map.coordinate_name();
  const std::string rows = "Rows are " + (map.joint < 0 ? name + "s" : "positions of " + name) +
                           (map.turns ? ", in the last panel rolls" : "") + ", " + map.unit() +
                           ". ";
  if (!map.grid())
    text += rows + "Between two nodes of an arc of solutions the nearer one is shown" +
            (cells.layers_each * cells.angles_each > 1
                 ? ", of several a blocked node before a free one, and that before the others.\n"
                 : ".\n");
  else if (cells.layers_each * cells.angles_each > 1)
    text += rows + "A cell stands for up to " + std::to_string(cells.layers_each) + " layers x " +
            std::to_string(cells.angles_each) +
            " arm angles and shows a blocked node before a free one, and that before the others.\n";
  else
    text += rows + "\n";
  return text;
}

std::string to_text(std::span<const RunMap> maps, int columns, bool coloured) {
  std::string text;
  for (const RunMap& of : maps) {
    if (!of.name.empty()) text += (text.empty() ? "" : "\n") + printable(of.name) + "\n\n";
    text += to_text(of.map, columns, coloured);
  }
  return text;
}

}  // namespace swivel
