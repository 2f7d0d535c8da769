// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "options/chosen_problem.hpp"
#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "options/shard_option.hpp"
#include "output/placement_output.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/study/grid_refinement.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"
#include "swivel/io/tables/placement.hpp"
#include "swivel/io/tables/shards.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/place.hpp"
#include "terminal/large_pages.hpp"
#include "terminal/progress.hpp"

namespace swivel::cli {

namespace {

namespace fs = std::filesystem;

/// The command line of `swivel place`.
struct PlaceArguments {
  std::string problem, shard, out, svg, report, write;
  std::size_t top = 10;
  std::optional<double> timeout;
  bool refine_grid = false;
  PlacementRequest request;
  SearchOptions search;
};

/// Returns the cells of a shard in their order.
std::vector<PlacementCell> cells_of(const PlacementRequest& request, const PlacementGrid& grid,
                                    const Shard& shard) {
  std::vector<PlacementCell> cells(shard.size(request.total()));
  for (std::uint64_t k = 0; k < cells.size(); ++k) {
    const std::uint64_t cell = shard.episode(k);
    Placement at =
        request.sample ? sampled_placement(grid.axes(), request.seed, cell) : grid.placement(cell);
    cells[k] = {cell, at.offset, std::move(at.hold)};
  }
  return cells;
}

/// The placements that the command line asks for, and how they are ranked.
struct AskedPlacements {
  std::vector<PlacementCriterion> criteria;
  PlacementGrid grid;
  Shard shard;
  std::vector<PlacementCell> cells;  ///< of the shard
};

/// Returns the placements that the command line asks for. Throws InputError.
AskedPlacements asked_placements(const PlaceArguments& arguments) {
  const PlacementRequest& request = arguments.request;
  std::vector<PlacementCriterion> criteria = request.criteria();
  PlacementGrid grid(request.axes());
  const Shard shard = arguments.shard.empty() ? Shard() : shard_from_string(arguments.shard);
  std::vector<PlacementCell> cells = cells_of(request, grid, shard);
  return {std::move(criteria), std::move(grid), shard, std::move(cells)};
}

/// Throws InputError if options contradict each other, or need what this build lacks.
void require_options_agree(const PlaceArguments& arguments) {
  if (arguments.refine_grid && arguments.request.sample)
    throw InputError("--refine-grid: a sample has no neighbours: allowed without --sample");
  for (const PlacementAxis& axis : arguments.request.placement.axes())
    if (arguments.request.sample && axis.step > 0)
      throw InputError("--" + (axis.joint.empty() ? "" : std::string("hold ")) + axis.name() +
                       ": a range with a step, of which --sample makes no use: allowed is FROM:TO, "
                       "or no --sample");
  if (arguments.refine_grid && !arguments.shard.empty())
    throw InputError(
        "--refine-grid: which cells come next hangs on those of other shards: allowed without "
        "--shard");
  if (!arguments.write.empty() && !arguments.shard.empty())
    throw InputError("--write: the best of all may be in another shard: allowed without --shard");
  if (!arguments.report.empty()) require_pages();
  require_table_name("--out", arguments.out, "the table of placements",
                     "--svg and --report for drawings");
}

/// Returns the text of the problem file, of which --write writes a copy with other poses. Throws
/// InputError if the file cannot be read twice, or if the copy would be in another folder.
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

/// The problem whose thing is placed.
struct PlacedProblem : ChosenProblem {
  std::string text;  ///< of the problem file; empty without --write
  Movable thing;
};

/// Loads the problem file and notes which files were read: with hashes of their contents for a
/// shard. Throws InputError.
PlacedProblem load_placed(const PlaceArguments& arguments) {
  std::string text;
  if (!arguments.write.empty()) text = problem_text(arguments);
  PlacedProblem placed{load_chosen(arguments.problem, arguments.search,
                                   arguments.shard.empty() ? io::InputFiles::Contents::kIgnore
                                                           : io::InputFiles::Contents::kHash),
                       std::move(text),
                       {}};
  placed.thing =
      arguments.request.placement.thing(placed.first, placed.problem.scene, placed.problem.source);
  return placed;
}

/// Calls `work`, and puts the name of an option before the message of an InvalidArgument.
template <class Work>
void in_the_name_of_option(const std::string& option, const Work& work) {
  try {
    work();
  } catch (const InvalidArgument& error) {
    throw InputError(option + error.what());
  }
}

/// Returns the problem file with a placement. Throws InputError where that moves a path in its
/// frame, which files cannot say.
std::string text_with(const PlacedProblem& placed, const Placement& at) {
  const Problem& problem = placed.problem;
  Problem moved = placed_problem(problem, placed.thing, at.offset);
  hold_joints(moved, at.hold);
  const auto moves = [](const Stroke& path, const Stroke& other) {
    return path.waypoints != other.waypoints;
  };
  if (problem.arms.size() == 2) {
    const std::size_t arm = moves(moved.arms[1].path(), problem.arms[1].path()) ? 1 : 0;
    return io::with_poses(placed.text, problem_of_arm(problem, arm), problem_of_arm(moved, arm));
  }
  const std::vector<Stroke>&strokes = problem.arm().strokes, &now = moved.arm().strokes;
  std::size_t stroke = 0;  // the first that moves
  while (stroke < strokes.size() && !moves(now[stroke], strokes[stroke])) ++stroke;
  if (stroke == strokes.size()) stroke = 0;
  return io::with_poses(placed.text, problem_of_run(problem, {stroke, false}),
                        problem_of_run(moved, {stroke, false}));
}

/// Returns a placement along every axis of the grid.
Placement placement_along_all(const PlacementGrid& grid) {
  Placement everywhere;
  for (const PlacementAxis& axis : grid.axes())
    if (axis.joint.empty())
      everywhere.offset[static_cast<std::size_t>(axis.coordinate)] =
          axis.from != 0 ? axis.from : axis.to;
    else
      everywhere.hold[axis.joint] = axis.from;
  return everywhere;
}

/// Throws InputError if joints cannot be held along the axes of the grid, or if the paths of a
/// workcell cannot be moved along them.
void require_placeable(const PlacedProblem& placed, const PlacementGrid& grid, bool sample) {
  for (const PlacementAxis& axis : grid.axes())
    if (!axis.joint.empty())
      for (const double position : {axis.from, sample ? axis.to : axis.at(axis.count - 1)}) {
        Problem copy = placed.problem;
        in_the_name_of_option("--hold: ", [&] { hold_joints(copy, {{axis.joint, position}}); });
      }
  const Offset offset = placement_along_all(grid).offset;
  in_the_name_of_option(
      "--", [&] { static_cast<void>(placed_problem(placed.problem, placed.thing, offset)); });
}

/// Throws InputError if --write could not write the best placement, before it is sought: writes, to
/// nowhere, a placement along every axis of the grid.
void require_writable(const PlacedProblem& placed, const PlacementGrid& grid) {
  in_the_name_of("--write", [&] { return text_with(placed, placement_along_all(grid)); });
}

/// Returns which joints along axes of the grid are prismatic.
std::set<std::string> slides_of(const RobotModel& model, const PlacementGrid& grid) {
  std::set<std::string> slides;
  for (const PlacementAxis& axis : grid.axes())
    if (const int joint = model.find_joint(axis.joint);
        joint >= 0 && model.joints[static_cast<std::size_t>(joint)].type == Joint::Type::kPrismatic)
      slides.insert(axis.joint);
  return slides;
}

/// Returns the joints of a list that no axis of the grid varies, nor follow one that it does.
std::vector<HeldJoint> still_held(std::vector<HeldJoint> held, const PlacementGrid& grid) {
  std::erase_if(held, [&](const HeldJoint& joint) {
    return std::any_of(grid.axes().begin(), grid.axes().end(), [&](const PlacementAxis& axis) {
      return !axis.joint.empty() && (axis.joint == joint.name || axis.joint == joint.leader);
    });
  });
  return held;
}

/// Returns the record of this run, which a shard's results begin with, but for the held joints.
io::ShardRecord record_of(const PlaceArguments& arguments, const PlacedProblem& placed,
                          const Shard& shard) {
  io::ShardRecord record{
      "place",
      run_settings(arguments.problem, placed.first, arguments.search, placed.inputs),
      shard,
      arguments.request.total(),
      fs::path(arguments.problem).filename().string(),
      "swivel plan " + quoted(arguments.problem) + arguments.search.words()};
  arguments.request.note(record.settings);
  return record;
}

/// Returns a planner of the placements. `robot`: the prepared one, or null of two arms.
PlacementPlanner planner_of(const PlacedProblem& placed, std::shared_ptr<const PreparedRobot> robot,
                            const PlanOptions& options) {
  if (!robot) return {placed.problem, placed.thing, options};
  return {std::move(robot), placed.problem, placed.thing, options};
}

/// Adds the files of the command line to `outputs`. Throws InputError if one cannot be written.
void add_outputs(const PlaceArguments& arguments, io::OutputFiles& outputs) {
  outputs.add("--out", arguments.out);
  outputs.add("--svg", arguments.svg);
  outputs.add("--report", arguments.report);
  outputs.add("--write", arguments.write);
}

/// Plans cells, and shows on standard error how many are done.
struct PlacementRun {
  PlacementPlanner& planner;
  bool grows;  ///< more cells may follow than those asked for so far
  ProgressLine progress{isatty(STDERR_FILENO) != 0};
  std::vector<PlacementRow> rows{};  ///< of all cells so far
  std::size_t done = 0, solved = 0;

  /// Plans the cells, returns their rows and adds them to `rows`.
  std::vector<PlacementRow> plan(const std::vector<PlacementCell>& cells) {
    const std::size_t of = rows.size() + cells.size();
    std::vector<PlacementRow> more = planner.plan(cells, [&](const PlacementRow& row) {
      ++done;
      solved += row.status == PlanStatus::kSolved;
      progress.show(std::to_string(done) + " of " + (grows ? "at least " : "") +
                    std::to_string(of) + " placements, " + std::to_string(solved) + " with a path" +
                    (grows ? "" : time_to_go(done, of, progress.seconds())));
    });
    rows.insert(rows.end(), more.begin(), more.end());
    return more;
  }
};

/// Plans a coarse grid, then refines it where verdicts differ and beside the best placements. The
/// run's rows are then in the order of cells.
void plan_refined_grid(PlacementRun& run, const AskedPlacements& asked) {
  GridRefinement refinement(asked.grid, asked.criteria);
  for (std::vector<std::uint64_t> next = refinement.next(); !next.empty() && !run.planner.stopped();
       next = refinement.next()) {
    std::vector<PlacementCell> cells;
    for (const std::uint64_t cell : next) cells.push_back(asked.cells[cell]);
    for (const PlacementRow& row : run.plan(cells)) refinement.learn(row);
  }
  std::sort(run.rows.begin(), run.rows.end(),
            [](const auto& a, const auto& b) { return a.cell < b.cell; });
}

/// Plans the placements that are asked for and returns their rows in the order of cells.
std::vector<PlacementRow> plan_placements(PlacementPlanner& planner, const AskedPlacements& asked,
                                          bool refine_grid) {
  PlacementRun run{planner, refine_grid};
  if (refine_grid)
    plan_refined_grid(run, asked);
  else
    run.plan(asked.cells);
  run.progress.clear();
  return std::move(run.rows);
}

/// Gives --write the problem file with the best placement, or marks an earlier file for removal if
/// no placement has a path.
void write_best(const PlacedProblem& placed, const std::vector<PlacementRow>& rows,
                const std::vector<PlacementCriterion>& criteria, io::OutputFiles& outputs) {
  const std::vector<PlacementRow> best = best_placements(rows, criteria, 1);
  if (best.empty())
    outputs.remove("--write");
  else
    outputs.write("--write", text_with(placed, {best[0].offset, best[0].hold}));
}

/// Returns the cells of the best placements, as many as the page of --report lists.
std::vector<PlacementCell> cells_on_page(const std::vector<PlacementRow>& rows,
                                         const std::vector<PlacementCriterion>& criteria) {
  constexpr std::size_t kShown = 20;
  std::vector<PlacementCell> shown;
  for (const PlacementRow& row : best_placements(rows, criteria, kShown))
    shown.push_back({row.cell, row.offset, row.hold});
  return shown;
}

/// Returns how far paths go in those of the placements without a path that the page shows: all, or
/// some that are spread evenly among them.
std::vector<PlacedEnd> ends_on_page(PlacementPlanner& planner,
                                    const std::vector<PlacementRow>& rows) {
  constexpr std::size_t kShown = 40;
  std::vector<PlacementCell> unsolved, shown;
  for (const PlacementRow& row : rows)
    if (row.status == PlanStatus::kInfeasible) unsolved.push_back({row.cell, row.offset, row.hold});
  const std::size_t count = std::min(kShown, unsolved.size());
  for (std::size_t k = 0; k < count; ++k) shown.push_back(unsolved[k * unsolved.size() / count]);
  std::vector<PlacedEnd> ends;
  planner.plan_again(
      shown, [&](const PlacementCell& cell, const PlanResult& result, const PlanView& view) {
        if (result.status != PlanStatus::kInfeasible) return;
        if (auto end = placed_end(cell, view, io::to_json(result))) ends.push_back(std::move(*end));
      });
  return ends;
}

/// Plans the placements of the command line, writes and prints them. Returns the exit code; that of
/// a shard does not say whether a placement has a path, which all shards say together.
int run(PlaceArguments arguments) {
  use_heaps_of_threads();
  PlanOptions options = arguments.search.plan_options();
  if (arguments.timeout) options.timeout_s = positive(*arguments.timeout, "--timeout");
  const AskedPlacements asked = asked_placements(arguments);
  require_options_agree(arguments);
  const PlacedProblem placed = load_placed(arguments);
  require_placeable(placed, asked.grid, arguments.request.sample.has_value());
  arguments.request.placement.slides = slides_of(*placed.first.model, asked.grid);
  if (!arguments.write.empty()) require_writable(placed, asked.grid);
  require_drawable(arguments.request, arguments.svg);
  io::ShardRecord record = record_of(arguments, placed, asked.shard);
  io::OutputFiles outputs(placed.inputs);
  add_outputs(arguments, outputs);

  catch_interrupts();
  const auto begun = std::chrono::steady_clock::now();
  const auto prepared = placed.problem.arms.size() == 2
                            ? nullptr
                            : std::make_shared<const PreparedRobot>(placed.first);
  record.held = still_held(held_joints(placed.problem), asked.grid);
  warn_of_held(record.held);
  PlacementPlanner planner = planner_of(placed, prepared, options);
  const std::vector<PlacementRow> rows = plan_placements(planner, asked, arguments.refine_grid);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();

  outputs.write("--out", (arguments.shard.empty() ? "" : io::to_line(record)) + io::to_csv(rows));
  if (outputs.wants("--write")) write_best(placed, rows, asked.criteria, outputs);
  char rate[64];
  const double a_second = static_cast<double>(rows.size()) / seconds;
  std::snprintf(rate, sizeof rate,
                a_second < 10 ? "; %.1f s, %.2g a second" : "; %.1f s, %.0f a second", seconds,
                a_second);
  PlacementScene scene;
  io::VisualRobot visual;
  if (outputs.wants("--report") && is_path(placed.problem)) {
    visual = io::load_visuals(*placed.first.model);
    scene = {prepared.get(),
             &placed.first,
             placed.thing,
             planner.trajectories(cells_on_page(rows, asked.criteria)),
             ends_on_page(planner, rows),
             visual.model.get(),
             visual.left_out};
  }
  show_placements(outputs, rows, arguments.request, record, arguments.top, rate, scene);
  const int code = placement_exit_code(rows);
  if (code == kInternalError) return code;
  if (planner.stopped()) return kStopped;
  return arguments.shard.empty() ? code : kOk;
}

}  // namespace

void add_place(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "place",
      "Plan many placements of the part, the path, the robot or a joint that is held: where should "
      "it stand?");
  // The callback shares the arguments, which must live as long as it does.
  auto arguments = std::make_shared<PlaceArguments>();
  command->add_option("problem", arguments->problem, "problem file, job or workcell")->required();
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
      ->add_option(
          "--best", arguments->request.best,
          "clearance | cost | margin (to a limit of a joint that turns) | slide (to one of "
          "a joint that slides) | speed; ties are settled by the next one named, then by "
          "the order of cells")
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
