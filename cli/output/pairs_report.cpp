// SPDX-License-Identifier: BSD-3-Clause
#include "output/pairs_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Pairs of bodies of the same two names of which the same is asked.
struct PairRow {
  std::array<std::string, 2> names;
  RobotPair pair;  ///< that of the least median
  std::size_t count = 0;
};

/// Returns what a pair keeps on layers and motions, and the tolerance, in mm; empty if it is
/// dropped.
std::string kept(const RobotPair& pair) {
  if (pair.dropped) return "";
  const RequiredClearance& asked = pair.required;
  return formatted("%.4g/%.4g/%.4g", 1e3 * asked.node, 1e3 * asked.motion, 1e3 * asked.tolerance);
}

/// Returns true if two rows of the table would differ by their medians alone.
bool alike(const PairRow& x, const PairRow& y) {
  return x.names == y.names && x.pair.dropped == y.pair.dropped &&
         x.pair.reduced == y.pair.reduced && kept(x.pair) == kept(y.pair);
}

/// Returns the rows of the table, pairs that are dropped or reduced first, as people look for
/// these.
std::vector<PairRow> folded(const World& world, const std::vector<RobotPair>& pairs) {
  std::vector<PairRow> rows;
  for (const RobotPair& pair : pairs) {
    const auto names = world.names(pair.pair);
    const PairRow row{{names[0], names[1]}, pair, 1};
    const auto known =
        std::ranges::find_if(rows, [&](const PairRow& other) { return alike(row, other); });
    if (known == rows.end()) {
      rows.push_back(row);
      continue;
    }
    ++known->count;
    if (pair.median < known->pair.median) known->pair = pair;
  }
  std::ranges::stable_sort(
      rows, {}, [](const PairRow& row) { return std::pair(!row.pair.dropped, !row.pair.reduced); });
  return rows;
}

/// Returns what most pairs keep, as of kept(), and how many these are.
std::pair<std::string, std::size_t> usual(const std::vector<PairRow>& rows) {
  std::map<std::string, std::size_t> counts;
  for (const PairRow& row : rows)
    if (!row.pair.dropped) counts[kept(row.pair)] += row.count;
  std::pair<std::string, std::size_t> most;
  for (const auto& [keeps, count] : counts)
    if (count > most.second) most = {keeps, count};
  return most;
}

/// Prints a table of the rows; what a pair keeps only where it is not as usual.
void print_rows(const std::vector<PairRow>& rows, const std::string& as_usual) {
  std::size_t width = 4;
  for (const PairRow& row : rows)
    for (const std::string& name : row.names) width = std::max(width, name.size());
  const int columns = static_cast<int>(width);
  say("%-*s %-*s %5s %-7s %9s\n", columns, "body", columns, "body", "pairs", "", "median mm");
  for (const PairRow& row : rows) {
    const RobotPair& pair = row.pair;
    const std::string keeps = kept(pair);
    say("%-*s %-*s %5zu %-7s %9s%s\n", columns, row.names[0].c_str(), columns, row.names[1].c_str(),
        row.count, pair.dropped ? "dropped" : (pair.reduced ? "reduced" : "counts"),
        pair.dropped              ? "touching"
        : std::isinf(pair.median) ? "-"
                                  : formatted("%.3f", 1e3 * pair.median).c_str(),
        keeps.empty() || keeps == as_usual ? "" : ("  " + keeps).c_str());
  }
}

}  // namespace

void print_pairs(const std::string& file) {
  if (std::filesystem::path(file).extension() == ".urdf")
    throw InputError(
        "--pairs: " + file +
        " is a URDF file: allowed is a problem file, whose limits say what pairs keep");
  const PathProblem problem = io::load_path_problem(file);
  const PreparedRobot robot(problem);
  const World& world = robot.world();
  const std::vector<RobotPair> pairs = world.robot_pairs_with_medians();
  const auto dropped = std::ranges::count_if(pairs, &RobotPair::dropped);
  const auto reduced = std::ranges::count_if(pairs, &RobotPair::reduced);
  const std::size_t counted = pairs.size() - static_cast<std::size_t>(dropped);
  say("%s, %zu robot pairs: %zu count, %zu of these reduced, %zu dropped\n",
      problem.model->has_srdf ? "with an SRDF" : "without an SRDF", pairs.size(), counted,
      static_cast<std::size_t>(reduced), static_cast<std::size_t>(dropped));
  const std::vector<PairRow> rows = folded(world, pairs);
  const auto [as_usual, count] = usual(rows);
  if (count > 0)
    say("%s keep %s mm (on layers/on motions/tolerance)%s\n",
        count == counted ? "all" : std::to_string(count).c_str(), as_usual.c_str(),
        count == counted ? "" : ", others what their row says");
  print_rows(rows, as_usual);
}

}  // namespace swivel::cli
