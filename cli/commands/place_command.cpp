// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "options/shard_option.hpp"
#include "output/placement_output.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/study/grid_refinement.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/tables/placement.hpp"
#include "swivel/io/tables/shards.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/place.hpp"
#include "terminal/progress.hpp"

namespace swivel::cli {

namespace {

namespace fs = std::filesystem;

struct PlaceArguments {
  std::string problem, shard, out, svg, report, write;
  std::size_t top = 10;
  std::optional<double> timeout;
  bool refine_grid = false;
  PlacementRequest request;
  SearchOptions search;
};

/// The cells of a share, in their order.
std::vector<PlacementCell> cells_of(const PlacementRequest& request, const PlacementGrid& grid,
                                    const Shard& shard) {
  std::vector<PlacementCell> cells(shard.size(request.total()));
  for (std::uint64_t k = 0; k < cells.size(); ++k) {
    const std::uint64_t cell = shard.episode(k);
    cells[k] = {
        cell, request.sample ? sampled_offset(grid.axes(), request.seed, cell) : grid.offset(cell)};
  }
  return cells;
}

std::string problem_text(const PlaceArguments& arguments) {
  std::error_code error;
  if (!fs::is_regular_file(arguments.problem, error))
    throw InputError("--write: " + arguments.problem +
                     " is not a regular file: allowed is a problem file that can be read again");
  const fs::path folder = fs::path(arguments.problem).parent_path(),
                 target = fs::path(arguments.write).parent_path();
  if (!fs::equivalent(folder / ".", target / ".", error))
    throw InputError("--write: " + arguments.write + " is in another folder than " +
                     arguments.problem +
                     ", which names its files relative to itself: allowed is a file beside it");
  std::ostringstream text;
  text << std::ifstream(arguments.problem, std::ios::binary).rdbuf();
  return text.str();
}

int run(const PlaceArguments& arguments) {
  PlanOptions options = arguments.search.plan_options();
  if (arguments.timeout) options.timeout_s = positive(*arguments.timeout, "--timeout");
  const PlacementRequest& request = arguments.request;
  const std::vector<PlacementCriterion> criteria = request.criteria();
  const PlacementGrid grid(request.axes());
  const Shard shard = arguments.shard.empty() ? Shard() : shard_from_string(arguments.shard);
  const std::vector<PlacementCell> cells = cells_of(request, grid, shard);
  if (arguments.refine_grid && request.sample)
    throw InputError("--refine-grid: a sample has no neighbours: allowed without --sample");
  if (arguments.refine_grid && !arguments.shard.empty())
    throw InputError(
        "--refine-grid: which cells come next hangs on those of other shards: allowed without "
        "--shard");
  if (!arguments.write.empty() && !arguments.shard.empty())
    throw InputError("--write: the best of all may be in another shard: allowed without --shard");
  if (!arguments.report.empty()) require_pages();
  require_table_name("--out", arguments.out, "the table of placements",
                     "--svg and --report for drawings");
  std::string text;
  if (!arguments.write.empty()) text = problem_text(arguments);
  std::vector<io::InputFiles::File> inputs;
  Problem problem = [&] {
    const io::InputFiles noted(arguments.shard.empty() ? io::InputFiles::Contents::kIgnore
                                                       : io::InputFiles::Contents::kHash);
    Problem loaded = io::load_problem(arguments.problem);
    inputs = noted.files();
    return loaded;
  }();
  arguments.search.apply(problem);
  const Movable thing = request.placement.thing(problem);
  if (!arguments.write.empty())  // what cannot be written is said before it is sought
    in_the_name_of("--write", [&] {
      Offset everywhere{};
      for (const PlacementAxis& axis : grid.axes())
        everywhere[static_cast<std::size_t>(axis.coordinate)] =
            axis.from != 0 ? axis.from : axis.to;
      return io::with_poses(text, problem, placed_problem(problem, thing, everywhere));
    });
  require_drawable(request, arguments.svg);
  io::ShardRecord record{"place",
                         run_settings(arguments.problem, problem, arguments.search, inputs),
                         shard,
                         request.total(),
                         fs::path(arguments.problem).filename().string(),
                         "swivel plan " + quoted(arguments.problem) + arguments.search.words()};
  request.note(record.settings);

  io::OutputFiles outputs(inputs);
  outputs.add("--out", arguments.out);
  outputs.add("--svg", arguments.svg);
  outputs.add("--report", arguments.report);
  outputs.add("--write", arguments.write);

  catch_interrupts();
  const auto begun = std::chrono::steady_clock::now();
  const auto prepared = std::make_shared<const PreparedRobot>(problem);
  record.held = prepared->arm().held;
  warn_of_held(record.held);
  PlacementPlanner planner(prepared, problem, thing, options);
  ProgressLine progress(isatty(STDERR_FILENO) != 0);
  std::vector<PlacementRow> rows;
  std::size_t done = 0, solved = 0;
  const auto plan = [&](const std::vector<PlacementCell>& wanted) {
    const std::size_t of = rows.size() + wanted.size();
    const std::vector<PlacementRow> more = planner.plan(wanted, [&](const PlacementRow& row) {
      ++done;
      solved += row.status == PlanStatus::kSolved;
      progress.show(std::to_string(done) + " of " + (arguments.refine_grid ? "at least " : "") +
                    std::to_string(of) + " placements, " + std::to_string(solved) + " with a path");
    });
    rows.insert(rows.end(), more.begin(), more.end());
    return more;
  };
  if (arguments.refine_grid) {
    GridRefinement refinement(grid, criteria);
    for (std::vector<std::uint64_t> next = refinement.next(); !next.empty() && !planner.stopped();
         next = refinement.next()) {
      std::vector<PlacementCell> wanted;
      for (const std::uint64_t cell : next) wanted.push_back(cells[cell]);
      for (const PlacementRow& row : plan(wanted)) refinement.learn(row);
    }
    std::sort(rows.begin(), rows.end(),
              [](const auto& a, const auto& b) { return a.cell < b.cell; });
  } else {
    plan(cells);
  }
  progress.clear();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();

  outputs.write("--out", (arguments.shard.empty() ? "" : io::to_line(record)) + io::to_csv(rows));
  if (outputs.wants("--write")) {
    const std::vector<PlacementRow> best = best_placements(rows, criteria, 1);
    if (best.empty())
      outputs.remove("--write");
    else
      outputs.write("--write",
                    io::with_poses(text, problem, placed_problem(problem, thing, best[0].offset)));
  }
  char rate[64];
  std::snprintf(rate, sizeof rate, "; %.1f s, %.0f a second", seconds,
                static_cast<double>(rows.size()) / seconds);
  PlacementScene scene;
  if (outputs.wants("--report")) {
    constexpr std::size_t kShown = 20;  // as the page lists
    std::vector<PlacementCell> shown;
    for (const PlacementRow& row : best_placements(rows, criteria, kShown))
      shown.push_back({row.cell, row.offset});
    scene = {prepared.get(), &problem, thing, planner.trajectories(shown)};
  }
  show_placements(outputs, rows, request, record, arguments.top, rate, scene);
  const int code = placement_exit_code(rows);
  if (code == kInternalError) return code;
  if (planner.stopped()) return kStopped;
  return arguments.shard.empty()
             ? code
             : kOk;  // whether there is a placement with a path, all shards say together
}

}  // namespace

void add_place(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "place", "Plan many placements of the part, the path or the robot: where should it stand?");
  auto arguments =
      std::make_shared<PlaceArguments>();  // shared: lives as long as the callback that reads it
  command->add_option("problem", arguments->problem, "problem file")->required();
  arguments->request.placement.add_to(*command,
                                      ": FROM:TO:STEP, or a number; with --sample FROM:TO");
  command->add_option("--sample", arguments->request.sample,
                      "so many placements drawn at random instead of a grid");
  command->add_option("--seed", arguments->request.seed, "what they are drawn from")
      ->capture_default_str();
  command->add_option("--shard", arguments->shard,
                      "I/N: plan the cells I, I + N, I + 2 N, ... alone; auto: the share of this "
                      "task of a Slurm job array");
  command->add_flag("--refine-grid", arguments->refine_grid,
                    "plan a coarse grid first, then between neighbours of unlike verdict and "
                    "beside the best: a third of the cells at most");
  command
      ->add_option("--best", arguments->request.best,
                   "clearance | cost | margin (to a joint limit) | speed; ties are settled by the "
                   "next one named, then by the "
                   "order of cells")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  command->add_option("--top", arguments->top, "how many of the best are listed")
      ->capture_default_str();
  arguments->search.add_to(*command);
  command->add_option("--timeout", arguments->timeout,
                      "seconds for all; what is known then is told and written");
  command->add_option("--out", arguments->out, "one row a placement (CSV)");
  command->add_option("--svg", arguments->svg,
                      "the map over the first two varied coordinates as a drawing");
  command->add_option("--report", arguments->report,
                      "the placements as one HTML file: maps by verdict, cause and quality, each "
                      "cell with its command");
  command->add_option("--write", arguments->write,
                      "the best placement as a problem file beside the given one, which is "
                      "otherwise copied as it is");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
