// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/planner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "collision_validity.hpp"
#include "diagnosis.hpp"
#include "swivel/core/angle.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/core/memory.hpp"
#include "swivel/core/srs_lattice.hpp"
#include "swivel/core/timeline.hpp"
#include "swivel/core/validate.hpp"
#include "swivel/graph/path_first.hpp"

namespace swivel {

namespace {

class Stopwatch {
 public:
  /// Milliseconds since construction or the last lap.
  double lap() {
    const auto now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

constexpr std::pair<PlannerKind, const char*> kNames[] = {{PlannerKind::kEager, "eager"},
                                                          {PlannerKind::kEagerDp, "eager_dp"},
                                                          {PlannerKind::kLazy, "lazy"},
                                                          {PlannerKind::kParallel, "parallel"}};

struct Found {
  bool decided = false;  // whether there is a path
  SearchOutcome outcome;
  std::optional<int> deepest;  // where there is no path: of the layers reached; none where that was not found in time
};

/// The eager planners are the baseline: FCL used well, without certificates. The verdicts are the same.
Certificates certificates_of(const PlanOptions& options) {
  if (options.planner == PlannerKind::kEager || options.planner == PlannerKind::kEagerDp) return Certificates::kOff;
  return options.compare_with_fcl ? Certificates::kCompared : Certificates::kOn;
}

void say(const PlanOptions& options, const char* phrase) {
  if (options.progress) options.progress(phrase);
}

/// Fixed, as the batch is. The eager planners have none: their nodes are shared out one by one.
int lanes_of(const PlanOptions& options) {
  if (options.planner == PlannerKind::kLazy) return 1;
  return options.planner == PlannerKind::kParallel ? 4 : 0;
}

/// The explicit graph keeps about 64 bytes a node and 56 an edge.
void refuse_if_too_large(const SrsLattice& lattice, const std::string& source) {
  const double edges = static_cast<double>(lattice.nodes()) * (2 * lattice.window() + 1);
  const double needed = 64.0 * static_cast<double>(lattice.nodes()) + 56.0 * edges;
  if (!fits_in_memory(needed))
    throw InputError(source + ": planner eager: its graph would need about " +
                     std::to_string(static_cast<long long>(needed / 1e9)) +
                     " GB: allowed are coarser resolutions or the planners eager_dp, lazy, parallel");
}

void search_eagerly(const Lattice& lattice, CollisionValidity& validity, const PlanOptions& options, const Budget& budget,
                    Found& found, Counters& counters) {
  EagerOutcome eager;
  try {
    if (options.planner == PlannerKind::kEager)
      eager_search(lattice, validity, options.eager_search, budget, eager);
    else
      eager_dp(lattice, validity, budget, eager);
    found = {true, eager, eager.deepest};
  } catch (const Stopped&) {
  }
  if (options.record) options.record->path = eager.path;
  counters.ik_nodes = eager.ik_nodes;
  counters.edges = eager.edges;
  counters.expansions = eager.expansions;
}

void search_lazily(const Lattice& lattice, CollisionValidity& validity, const PlanOptions& options, const Budget& budget,
                   Found& found, PlanResult& result) {
  Stopwatch watch;
  constexpr int kFewLayers = 64;  // where chords are too long to bound much
  const auto cost_to_go = make_cost_to_go(lattice, lattice.layers() < kFewLayers ? Extent::kWhole : Extent::kBounded, budget);
  CostToGo& togo = *cost_to_go;
  SearchCounters searched;
  try {
    say(options, "sweeping the lattice");
    togo.sweep(lattice.layers() - 1);
    result.time_ms["sweep"] = watch.lap();
    // A fixed batch, so that what is asked (and counted) does not depend on the number of threads.
    const PathFirstOptions path_first_options{.batch = options.planner == PlannerKind::kParallel ? 32 : 1};
    found.outcome = path_first(togo, validity, path_first_options, searched);
    found.decided = true;
    result.time_ms["search"] = watch.lap();
    if (found.outcome.path.empty()) {
      say(options, "no path; seeking the furthest layer");
      found.deepest = deepest_valid_layer(togo, validity, path_first_options, searched);
      result.time_ms["reach"] = watch.lap();
    }
    if (options.record) {
      std::int64_t expansions = 0;  // no part of the search
      options.record->path = found.deepest.value_or(-1) >= 0 ? best_path(togo, expansions) : found.outcome.path;
      options.record->nodes = togo.verdicts().nodes();
      result.time_ms["record"] = watch.lap();
    }
  } catch (const Stopped&) {
  }
  Counters& counters = result.counters;
  counters.ik_nodes = togo.ik_nodes();
  counters.edges = togo.edges();
  counters.expansions = searched.expansions;
  counters.iterations = searched.iterations;
}

Found search(const SrsLattice& lattice, CollisionValidity& validity, const PlanOptions& options, const Budget& budget,
             PlanResult& result) {
  Found found;
  if (options.planner == PlannerKind::kEager || options.planner == PlannerKind::kEagerDp)
    search_eagerly(lattice, validity, options, budget, found, result.counters);
  else
    search_lazily(lattice, validity, options, budget, found, result);
  return found;
}

/// Measured between the base's vertical and the elbow, in the plane normal to S->W: the convention of vendors and of Shimizu 2008.
double conventional_arm_angle(const SrsArm& arm, const Pose& tool, const Config& q) {
  const double axis_angle = first_plane(arm, tool).angle_of(arm.elbow_axis(q));
  return wrap_angle(axis_angle +
                    (std::sin(arm.elbow_angle(q)) > 0 ? kPi : 0));  // axis 4 stands at a right angle to the elbow, by its sign
}

void fill_trajectory(const Lattice& lattice, const SlotPath& path, PlanResult& result) {
  for (int i = 0; i < lattice.layers(); ++i) {
    const int slot = path[static_cast<std::size_t>(i)];
    TrajectoryRow row;
    row.s = lattice.path().layer(i).s;
    row.phi = lattice.phi(i, slot);
    row.branch = lattice.branch(i, slot);
    row.q = *lattice.node(i, slot);
    if (i > 0) row.q = result.trajectory.back().q + lattice.delta(result.trajectory.back().q, row.q);  // unwraps continuous joints
    result.trajectory.push_back(row);
  }
}

void fill_tool_path_error(const PreparedRobot& robot, const Lattice& lattice, const Budget& budget, PlanResult& result) {
  double sum = 0;
  std::int64_t samples = 0;
  for (std::size_t i = 0; i + 1 < result.trajectory.size(); ++i) {
    if (i % 64 == 0) budget.poll();
    const Config& q = result.trajectory[i].q;
    const auto deviation =
        path_deviation(robot.arm().chain, lattice.path(), static_cast<int>(i), q, result.trajectory[i + 1].q - q);
    for (const double error : deviation) {
      sum += error;
      ++samples;
      result.tool_path_error_mm.max = std::max(result.tool_path_error_mm.max, 1e3 * error);
    }
  }
  result.tool_path_error_mm.mean = 1e3 * sum / static_cast<double>(samples);
  result.evidence.tool_path_error = true;
}

void list_special_pairs(const World& world, PlanResult& result) {
  for (const RobotPair& p : world.robot_pairs())
    if (p.dropped || p.reduced)
      (p.dropped ? result.dropped_pairs : result.reduced_pairs)
          .push_back({world.names(p.pair), p.median, p.keeps.node, p.keeps.motion});
}

void fill_postures(const PreparedRobot& robot, const Lattice& lattice, const World& world, const Budget& budget,
                   PlanResult& result) {
  World::Query query(world);
  std::optional<double> least;
  std::optional<LeastMargin> margin;
  double manipulability = std::numeric_limits<double>::infinity();
  std::vector<double> arm_angle;
  for (std::size_t i = 0; i < result.trajectory.size(); ++i) {
    budget.poll();
    const Config& q = result.trajectory[i].q;
    manipulability = std::min(manipulability, robot.arm().chain.manipulability(q));
    arm_angle.push_back(conventional_arm_angle(robot.srs(), lattice.path().layer(static_cast<int>(i)).tool, q));
    const auto clearance = query.clearance(q);
    if (!clearance) continue;
    least = std::min(least.value_or(clearance->least), clearance->least);
    if (!margin || clearance->margin() < margin->margin)
      margin = {clearance->margin(), clearance->distance, clearance->required, world.names(clearance->pair), static_cast<int>(i)};
  }
  result.min_clearance = least;
  result.min_margin = std::move(margin);
  result.min_manipulability = manipulability;
  result.arm_angle = std::move(arm_angle);
  result.evidence.postures = true;
}

/// What the options ask for, as far as the budget goes.
void fill_evidence(const PreparedRobot& robot, const SrsLattice& lattice, const World& world, const EdgeRule& rule,
                   const Found& found, const PlanOptions& options, const Budget& budget, PlanResult& result) {
  const Span span("report");
  try {
    if (result.status == PlanStatus::kSolved) {
      say(options, "measuring the trajectory");
      if (options.evidence.tool_path_error) fill_tool_path_error(robot, lattice, budget, result);
      if (options.evidence.postures) fill_postures(robot, lattice, world, budget, result);
    } else if (!found.deepest) {
      result.diagnosis.complete = false;
    } else {
      say(options, "no path; finding out why");
      diagnose(lattice, world, rule, *found.deepest, options.evidence.layers, budget, result.diagnosis);
      result.evidence.layers = options.evidence.layers;
    }
  } catch (const Stopped&) {
  }
}

PlanStatus stopped_status(const Budget& budget) {
  return budget.cancelled() ? PlanStatus::kCancelled : PlanStatus::kTimeout;
}

Executor make_executor(const PlanOptions& options) {
  return Executor(options.planner == PlannerKind::kLazy ? 1 : options.threads, options.backend);
}

/// What is known before anything is done.
PlanResult blank_result(const PlanOptions& options, const Executor& executor) {
  PlanResult result;
  result.planner = to_string(options.planner);
  result.threads = executor.threads();
  result.time_ms["prepare"] = 0;
  return result;
}

void find(const PreparedRobot& robot, const Problem& problem, const PlanOptions& options, Executor& executor, const Budget& budget,
          PlanResult& result) {
  Stopwatch watch, whole;
  say(options, "laying out the lattice");
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source, budget);
  const SrsLattice lattice(robot.arm().chain, robot.srs(), path, problem, budget);
  result.time_ms["lattice"] = watch.lap();
  const World world(robot.world(), problem, budget);
  result.time_ms["world"] = watch.lap();
  result.warnings = limit_warnings(robot.arm().chain);
  result.warnings.insert(result.warnings.end(), world.warnings().begin(), world.warnings().end());
  list_special_pairs(world, result);
  result.lattice = {lattice.layers(), lattice.angles(),       kBranches, lattice.windings(), lattice.window(),
                    lattice.nodes(),  path.merged_waypoints()};

  const EdgeRule rule = world.edge_rule(robot.radii());
  if (options.planner == PlannerKind::kEager) refuse_if_too_large(lattice, problem.source);
  CollisionValidity validity(lattice, world, rule, certificates_of(options), executor, lanes_of(options), budget, options.progress);
  const Found found = search(lattice, validity, options, budget, result);
  const double record = result.time_ms.contains("record") ? result.time_ms["record"] : 0;
  result.time_ms["find"] = watch.lap() - record;
  result.counters.nodes_checked = validity.nodes_checked();
  result.counters.edges_checked = validity.edges_checked();
  const CollisionCounters collision = validity.counters();
  result.counters.fcl_calls = collision.fcl_calls;
  result.counters.certified_free = collision.certified_free;
  result.counters.certified_colliding = collision.certified_colliding;
  if (collision.contradictions > 0)
    throw std::logic_error(std::to_string(collision.contradictions) + " certificates contradict FCL");
  if (!found.decided) throw Stopped();
  result.status = found.outcome.path.empty() ? PlanStatus::kInfeasible : PlanStatus::kSolved;
  if (result.status == PlanStatus::kSolved) {
    result.cost = found.outcome.cost;
    fill_trajectory(lattice, found.outcome.path, result);
  }
  result.time_ms["plan"] = whole.lap() - record;
  watch.lap();
  fill_evidence(robot, lattice, world, rule, found, options, budget, result);
  result.time_ms["report"] = watch.lap();
}

PlanResult plan_within(const PreparedRobot& robot, const Problem& problem, const PlanOptions& options, const Budget& budget) {
  const Span span("plan");
  validate(problem);
  robot.require_prepared_for(problem);
  Stopwatch watch;
  Executor executor = make_executor(options);
  PlanResult result = blank_result(options, executor);
  result.joint_names = robot.arm().chain.joint_names;
  try {
    find(robot, problem, options, executor, budget, result);
  } catch (const Stopped&) {
    result.status = stopped_status(budget);
    result.time_ms["plan"] = watch.lap();
  }
  return result;
}

}  // namespace

const char* to_string(PlannerKind kind) {
  for (const auto& [value, name] : kNames)
    if (value == kind) return name;
  return "?";
}

PlannerKind planner_from_string(const std::string& name) {
  for (const auto& [value, known] : kNames)
    if (name == known) return value;
  throw InputError("unknown planner '" + name + "': allowed are eager, eager_dp, lazy, parallel");
}

PlanResult plan(const Problem& problem, const PlanOptions& options) {
  const Budget budget(options.timeout_s, options.cancel);
  Stopwatch watch;
  std::optional<PreparedRobot> robot;
  PlanResult result;
  double prepare = 0;
  try {
    const Span span("prepare");
    say(options, "preparing the robot");
    robot.emplace(problem, budget);
    prepare = watch.lap();
    result = plan_within(*robot, problem, options, budget);
  } catch (const Stopped&) {
    prepare = watch.lap();
    result = blank_result(options, make_executor(options));
    result.status = stopped_status(budget);
  }
  result.time_ms["prepare"] += prepare;
  return result;
}

PlanResult plan(const PreparedRobot& robot, const Problem& problem, const PlanOptions& options) {
  return plan_within(robot, problem, options, Budget(options.timeout_s, options.cancel));
}

}  // namespace swivel
