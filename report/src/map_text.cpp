// SPDX-License-Identifier: BSD-3-Clause

#include "map_cells.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

using namespace detail;

namespace {

struct Look {
  char symbol;
  int background;  // ANSI 256 colour
};

constexpr int kLightBlue = 153, kGrey = 252, kGreen = 72, kPaleGreen = 115, kOrange = 208,
              kMauve = 176;

Look look_of(const LatticeMap::Node& node) {
  switch (node.state) {
    case NodeState::kNoIk:
      return {' ', 231};
    case NodeState::kSingular:
      return {'s', kMauve};
    case NodeState::kJointLimit:
      return {static_cast<char>('1' + node.cause), kLightBlue};
    case NodeState::kNotLookedAt:
      return {'.', kGrey};
    case NodeState::kFree:
      return node.proved ? Look{'+', kPaleGreen} : Look{'o', kGreen};
    case NodeState::kBlocked:
      return {static_cast<char>(node.cause < 26 ? 'a' + node.cause : '#'), kOrange};
  }
  return {'?', 231};
}

void put(std::string& text, const Look& look, bool coloured) {
  if (coloured) {
    text += "\x1b[48;5;" + std::to_string(look.background) + ";38;5;16m" + look.symbol + "\x1b[0m";
  } else {
    text += look.symbol;
  }
}

}  // namespace

std::string to_text(const LatticeMap& map, int columns, bool coloured) {
  constexpr int kMargin = 8, kRows = 24;
  const MapCells cells(map, std::max(10, columns - kMargin), kRows);
  std::string text;
  MapLegend seen(map);
  for (const int solution : map.inhabited_solutions()) {
    text += map.solution_name(solution) + "\n";
    for (int row = cells.rows - 1; row >= 0; --row) {
      const double value = map.value(row * cells.angles_each);
      text += row % 4 == 0 ? formatted("%6.2f  ", value) : std::string(kMargin, ' ');
      for (int column = 0; column < cells.columns; ++column) {
        const LatticeMap::Node node = cells.node(solution, column, row);
        seen.see(node);
        Look look = look_of(node);
        if (cells.on_path(solution, column, row)) look = {'*', 231};
        put(text, look, coloured);
      }
      text += '\n';
    }
    text += std::string(kMargin, ' ') + formatted("s = 0 to %.3f m", map.s.back()) + "\n\n";
  }
  const auto legend = [&](const Look& look, const std::string& meaning) {
    put(text, look, coloured);
    text += " " + printable(meaning) + "\n";
  };
  if (!map.path.empty()) legend({'*', 231}, seen.path_meaning());
  for (const auto& [node, meaning] : seen.entries()) legend(look_of(node), meaning);
  const std::string name = map.coordinate_name();
  const std::string rows =
      "Rows are " + name + "s" + (map.turns ? ", in the last panel rolls, rad. " : ", rad. ");
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

}  // namespace swivel
