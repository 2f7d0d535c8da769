// SPDX-License-Identifier: BSD-3-Clause
#include "page/page_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "map_cells.hpp"
#include "page/packed.hpp"
#include "swivel/core/base/angle.hpp"

namespace swivel::detail {

namespace {

/// Clearances of cells in tenths of a millimetre and 16 bits; kUnknown where nothing is near or the
/// clearance was not asked for.
class Clearances {
 public:
  /// Prepares for `cells` calls of add(), of which about `most` ask.
  Clearances(const World& world, std::size_t cells, std::size_t most)
      : query_(world, DistanceProofs::kOn), each_(cells / most + 1) {}
  /// Adds the clearance of a posture. Asks for it if `surely`, or if it is the one in so many that
  /// there is time for.
  void add(const Config& q, bool surely) {
    values.push_back(kUnknown);
    if (asked_++ % each_ != 0 && !surely) return;
    if (const auto clearance = query_.clearance(q))
      values.back() = static_cast<std::uint16_t>(
          std::lround(std::clamp(1e4 * clearance->distance, 0.0, kUnknown - 1.0)));
  }
  /// Adds a cell whose clearance is not asked for.
  void skip() { values.push_back(kUnknown); }
  std::vector<std::uint16_t> values;

 private:
  static constexpr std::uint16_t kUnknown = 65535;
  World::Query query_;
  std::size_t each_, asked_ = 0;
};

/// Returns true if the clearance of the node was asked for.
bool looked_at(const LatticeMap::Node& node) {
  return node.state >= NodeState::kFree;
}

/// Returns how many rows of cells each panel of a map has at most.
int most_rows(std::size_t most_cells) {
  return most_cells >= kMostCells ? 252 : most_cells >= kMostCells / 4 ? 126 : 63;
}

/// Returns how many columns of cells each panel of a map has at most.
int most_columns(std::size_t panels, std::size_t most_cells) {
  const std::size_t rows =
      std::max<std::size_t>(1, panels) * static_cast<std::size_t>(most_rows(most_cells));
  return std::max(most_cells >= kMostCells ? 100 : 50, static_cast<int>(most_cells / rows));
}

/// Writes the map for the page: the state of each cell and the posture of one node for each cell.
/// Cells above each other that show the same node share its posture.
class MapWriter {
 public:
  /// `rows`: of the path that is shown; postures turn their joints towards them.
  MapWriter(const LatticeMap& map, const Lattice& lattice, const World& world,
            const std::vector<int>& path, const std::vector<PageRow>& rows, std::size_t most_cells,
            const Budget& budget)
      : map_(map),
        lattice_(lattice),
        path_(path),
        rows_(rows),
        budget_(budget),
        solutions_(map.inhabited_solutions()),
        cells_(map, most_columns(solutions_.size(), most_cells), most_rows(most_cells)),
        turned_(may_turn(lattice)),
        // A question costs up to a millisecond.
        clearances_(world, cells_looked_at(), most_cells / 100),
        panel_of_(static_cast<std::size_t>(map.panels()), -1) {
    for (const int solution : solutions_) {
      panel_of_[solution] = static_cast<int>(panels_.size());
      panels_.push_back({{"sheet", solution},
                         {"name", map.solution_name(solution)},
                         {"rolls", map.shows_rolls(solution)}});
    }
    posed_.rows = static_cast<std::size_t>(cells_.rows);
    posed_.column = posed_.rows * solutions_.size();
    for (std::size_t row = 0; row < rows.size(); ++row)
      if (rows[row].layer == static_cast<double>(row_of_layer_.size()))
        row_of_layer_.push_back(row);
  }

  /// Returns the map. Throws Stopped.
  Json write() {
    for (int column = 0; column < cells_.columns; ++column) write_column(column, shown_in(column));
    return json();
  }

 private:
  /// The node that a cell shows; layer -1: none.
  struct Shown {
    int layer = -1, slot = -1;
    double phi = 0, roll = 0;  ///< rad; phi: of the map's coordinate, of a slide m
    Config q;
  };
  /// The cells of a column, by panel and row.
  using Column = std::vector<Shown>;

  [[nodiscard]] std::size_t cells_looked_at() const {
    std::size_t count = 0;
    for (const int solution : solutions_)
      for (int column = 0; column < cells_.columns; ++column)
        for (int row = 0; row < cells_.rows; ++row)
          count += looked_at(cells_.node(solution, column, row));
    return count;
  }

  /// Returns the nodes that a column shows: for each cell the first that looks like the cell.
  Column shown_in(int column) {
    Column shown(solutions_.size() * static_cast<std::size_t>(cells_.rows));
    const int first = column * cells_.layers_each,
              last = std::min(map_.layers, first + cells_.layers_each);
    for (int layer = first; layer < last; ++layer) {
      budget_.poll();
      lattice_.layer_nodes(layer, listed_);
      const bool on_path = layer < static_cast<int>(path_.size());
      if (turned_ && on_path)
        rank_ = lattice_.grid_place(layer, path_[static_cast<std::size_t>(layer)]).rank;
      if (map_.grid())
        offer_grid_nodes(shown, column, layer);
      else
        offer_arc_nodes(shown, column, layer);
      if (map_.turns && on_path) offer_rolls(shown, column, layer);
    }
    return shown;
  }

  /// Offers the nodes of a layer of a grid, at the path's roll if the tool may stand turned.
  void offer_grid_nodes(Column& shown, int column, int layer) const {
    for (const Lattice::Node& node : listed_) {
      if (turned_ && lattice_.grid_place(layer, node.slot).rank != rank_) continue;
      const int cell = map_cell(map_, lattice_, layer, node.slot);
      offer(shown, column, layer, node, cell / map_.angles, cell % map_.angles);
    }
  }
  /// Offers the nodes that the map shows in a layer of a lattice without a grid.
  void offer_arc_nodes(Column& shown, int column, int layer) const {
    const int panel_cells = map_.panels() * map_.angles;
    for (int cell = 0; cell < panel_cells; ++cell)
      if (const int slot = map_.slots[static_cast<std::size_t>(layer) * panel_cells + cell];
          slot >= 0)
        offer(shown, column, layer, listed_[static_cast<std::size_t>(slot)], cell / map_.angles,
              cell % map_.angles);
  }
  /// Offers the nodes of the panel of rolls in a layer that the path reaches.
  void offer_rolls(Column& shown, int column, int layer) const {
    const std::vector<int> slots =
        slots_of_rolls(lattice_, layer, path_[static_cast<std::size_t>(layer)], map_.angles);
    for (int k = 0; k < map_.angles; ++k) {
      const auto at =
          std::lower_bound(listed_.begin(), listed_.end(), slots[static_cast<std::size_t>(k)],
                           [](const Lattice::Node& node, int slot) { return node.slot < slot; });
      if (at != listed_.end() && at->slot == slots[static_cast<std::size_t>(k)])
        offer(shown, column, layer, *at, map_.solutions(), k);
    }
  }

  /// Shows a node in its cell if the cell shows none yet and looks like the node.
  void offer(Column& shown, int column, int layer, const Lattice::Node& node, int solution,
             int angle) const {
    const int row = angle / cells_.angles_each, k = panel_of_[solution] * cells_.rows + row;
    if (panel_of_[solution] < 0 || shown[k].layer >= 0 ||
        map_.at(layer, solution, angle) != cells_.node(solution, column, row))
      return;
    const auto near = static_cast<std::size_t>(layer);
    const Config q =
        turned_towards(lattice_, lattice_.exact_config(layer, node.slot, node.q).value_or(node.q),
                       rows_, near < row_of_layer_.size() ? row_of_layer_[near] : rows_.size());
    const double roll =
        turned_ ? roll_between(lattice_.path().layer(layer).tool, lattice_.chain().tool(q)) : 0;
    shown[k] = {layer, node.slot, map_.value_at(lattice_.phi(layer, node.slot), q), roll, q};
  }

  /// Appends states, postures and clearances of a column's cells.
  void write_column(int column, const Column& shown) {
    std::size_t k = 0;
    for (const int solution : solutions_)
      for (int row = 0; row < cells_.rows; ++row, ++k) {
        const LatticeMap::Node cell = cells_.node(solution, column, row);
        const bool posed = shown[k].layer >= 0, is_again = posed && row > 0 &&
                                                           shown[k].slot == shown[k - 1].slot &&
                                                           shown[k].layer == shown[k - 1].layer;
        states_.push_back(
            static_cast<std::uint8_t>(static_cast<unsigned>(cell.state) | (is_again ? 32u : 0u) |
                                      (cell.proved ? 64u : 0u) | (posed ? 128u : 0u)));
        causes_.push_back(cell.cause);
        posed_.pose.push_back(posed ? static_cast<int>(poses_.size()) - (is_again ? 1 : 0) : -1);
        if (!posed || is_again) continue;
        budget_.poll();
        if (looked_at(cell))
          clearances_.add(shown[k].q,
                          cells_.on_path(solution, column, row) || is_of_path(shown[k]));
        else
          clearances_.skip();
        poses_.push_back(shown[k]);
        poses_.back().layer -= column * cells_.layers_each;
      }
  }
  [[nodiscard]] bool is_of_path(const Shown& pose) const {
    const auto layer = static_cast<std::size_t>(pose.layer);
    return layer < path_.size() && path_[layer] == pose.slot;
  }

  /// Returns all that was appended, with the postures' joints in 16 bits, which is enough to draw.
  Json json() {
    double reach = 1;  // rad, of the largest number in 16 bits
    for (const Shown& pose : poses_) reach = std::max(reach, pose.q.cwiseAbs().maxCoeff());
    std::vector<std::int16_t> joints;
    std::vector<std::uint16_t> layers;
    std::vector<float> phis, rolls;
    for (const Shown& pose : poses_) {
      for (const double q : pose.q.coordinates())
        joints.push_back(static_cast<std::int16_t>(std::lround(q / reach * 32767)));
      layers.push_back(static_cast<std::uint16_t>(pose.layer));
      phis.push_back(static_cast<float>(pose.phi));
      if (turned_) rolls.push_back(static_cast<float>(pose.roll));
    }
    return {{"layers", map_.layers},
            {"angles", map_.angles},
            {"columns", cells_.columns},
            {"rows", cells_.rows},
            {"layers_each", cells_.layers_each},
            {"angles_each", cells_.angles_each},
            {"coordinate", map_.coordinate_name()},
            {"letter", map_.letter(0)},
            {"slides", map_.slides},
            {"low", map_.low},
            {"step", map_.step},
            {"closed", map_.closed},
            {"arcs", !map_.grid()},
            {"nothing", map_.emptiness()},
            {"panels", std::move(panels_)},
            {"states", Json::binary(states_)},
            {"causes", Json::binary(causes_)},
            {"joints", Json::binary(encode_poses(joints, kDof, posed_))},
            {"clearances", Json::binary(bytes_of(clearances_.values))},
            {"joint_unit", reach / 32767},
            {"pose_layers", Json::binary(bytes_of(layers))},
            {"pose_phis", Json::binary(bytes_of(phis))},
            {"pose_rolls", Json::binary(bytes_of(rolls))},
            {"blockers", map_.blockers},
            {"complete", map_.complete},
            {"s", map_.s}};
  }

  const LatticeMap& map_;
  const Lattice& lattice_;
  const std::vector<int>& path_;
  const std::vector<PageRow>& rows_;
  const Budget& budget_;
  const std::vector<int> solutions_;  ///< whose panels are written
  const MapCells cells_;
  const bool turned_;  ///< the tool may stand turned
  Clearances clearances_;
  std::vector<int> panel_of_;  ///< by solution; -1: not written
  Json panels_ = Json::array();
  std::vector<std::size_t> row_of_layer_;  ///< by layer of the lattice, as far as there are rows
  std::vector<Lattice::Node> listed_;      ///< nodes of the layer
  int rank_ = 0;  ///< of the roll that the path has in the layer, or had last
  std::vector<std::uint8_t> states_, causes_;  ///< of all cells
  std::vector<Shown> poses_;                   ///< layers counted from the cell's first
  PosedCells posed_;
};

}  // namespace

Json map_json(const LatticeMap& map, const Lattice& lattice, const World& world,
              const std::vector<int>& path, const std::vector<PageRow>& rows,
              std::size_t most_cells, const Budget& budget) {
  return MapWriter(map, lattice, world, path, rows, most_cells, budget).write();
}

}  // namespace swivel::detail
