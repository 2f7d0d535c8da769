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
  SearchOutcome outcome;
  int deepest = -1;  // where there is no path
};

/// The eager planners are the baseline: FCL used well, without certificates. The verdicts are the same.
Certificates certificates_of(const PlanOptions& options) {
  if (options.planner == PlannerKind::kEager || options.planner == PlannerKind::kEagerDp) return Certificates::kOff;
  return options.compare_with_fcl ? Certificates::kCompared : Certificates::kOn;
}

/// Fixed, as the batch is. The eager planners have none: their nodes are shared out one by one.
int lanes_of(const PlanOptions& options) {
  if (options.planner == PlannerKind::kLazy) return 1;
  return options.planner == PlannerKind::kParallel ? 4 : 0;
}

/// The explicit graph keeps about 64 bytes a node and 56 an edge.
void refuse_if_too_large(const Lattice& lattice, const std::string& source) {
  const double edges = static_cast<double>(lattice.nodes()) * (2 * lattice.window() + 1);
  const double needed = 64.0 * static_cast<double>(lattice.nodes()) + 56.0 * edges;
  if (!fits_in_memory(needed))
    throw InputError(source + ": --planner eager: its graph would need about " +
                     std::to_string(static_cast<long long>(needed / 1e9)) +
                     " GB: allowed are coarser resolutions or the planners eager_dp, lazy, parallel");
}

Found search(const Lattice& lattice, CollisionValidity& validity, const PlanOptions& options, PlanResult& result) {
  Found found;
  Counters& counters = result.counters;
  if (options.planner == PlannerKind::kEager || options.planner == PlannerKind::kEagerDp) {
    const EagerOutcome eager = options.planner == PlannerKind::kEager ? eager_search(lattice, validity, options.eager_search)
                                                                      : eager_dp(lattice, validity);
    found = {eager, eager.deepest};
    if (options.record) options.record->path = eager.path;
    counters.ik_nodes = eager.ik_nodes;
    counters.edges = eager.edges;
    counters.expansions = eager.expansions;
    return found;
  }
  Stopwatch watch;
  constexpr int kFewLayers = 64;  // where chords are too long to bound much
  CostToGo togo(lattice, lattice.layers() < kFewLayers ? CostToGo::Extent::kWhole : CostToGo::Extent::kBounded);
  found.outcome.stopped = !togo.sweep(lattice.layers() - 1, [&] { return validity.stopped(); });
  result.time_ms["sweep"] = watch.lap();
  if (found.outcome.stopped) return found;
  // A fixed batch, so that what is asked (and counted) does not depend on the number of threads.
  const PathFirstOptions path_first_options{.batch = options.planner == PlannerKind::kParallel ? 32 : 1};
  SearchCounters searched;
  found.outcome = path_first(togo, validity, path_first_options, searched);
  result.time_ms["search"] = watch.lap();
  if (found.outcome.path.empty() && !found.outcome.stopped) {
    const auto deepest = deepest_valid_layer(togo, validity, path_first_options, searched);
    found.outcome.stopped = !deepest.has_value();
    found.deepest = deepest.value_or(-1);
    result.time_ms["reach"] = watch.lap();
  }
  if (options.record) {
    watch.lap();
    options.record->nodes = togo.node_verdicts();
    options.record->path = found.outcome.path;
    std::int64_t expansions = 0;  // no part of the search
    if (found.deepest >= 0) options.record->path = best_path(togo, expansions);
    result.time_ms["record"] = watch.lap();
  }
  counters.ik_nodes = togo.ik_nodes();
  counters.edges = togo.edges();
  counters.expansions = searched.expansions;
  counters.iterations = searched.iterations;
  return found;
}

/// Measured between the base's vertical and the elbow, in the plane normal to S->W: the convention of vendors and of Shimizu 2008.
double conventional_arm_angle(const SrsArm& arm, const Pose& tool, const Config& q) {
  const double axis_angle = first_plane(arm, tool).angle_of(arm.elbow_axis(q));
  return wrap_angle(axis_angle +
                    (std::sin(arm.elbow_angle(q)) > 0 ? kPi : 0));  // axis 4 stands at a right angle to the elbow, by its sign
}

void fill_trajectory(const Lattice& lattice, const SlotPath& path, PlanResult& result) {
  LayerNodes nodes;
  for (int i = 0; i < lattice.layers(); ++i) {
    const int slot = path[static_cast<std::size_t>(i)];
    lattice.solve(i, lattice.angle_of(slot), 1, nodes);
    TrajectoryRow row;
    row.s = lattice.path().layer(i).s;
    row.phi = lattice.phi(i, slot);
    row.branch = lattice.branch_of(slot);
    row.q = nodes.config(lattice.label_of(slot), 0);
    if (i > 0) row.q = result.trajectory.back().q + lattice.delta(result.trajectory.back().q, row.q);  // unwraps continuous joints
    result.trajectory.push_back(row);
  }
}

void fill_report(const PreparedRobot& robot, const Lattice& lattice, const World& world, PlanResult& result) {
  const Span span("report");
  World::Query query(world);
  double sum = 0;
  std::int64_t samples = 0;
  result.min_manipulability = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < result.trajectory.size(); ++i) {
    const Config& q = result.trajectory[i].q;
    result.min_manipulability = std::min(result.min_manipulability, robot.arm().chain.manipulability(q));
    result.arm_angle.push_back(conventional_arm_angle(robot.srs(), lattice.path().layer(static_cast<int>(i)).tool, q));
    const auto clearance = query.clearance(q);
    if (clearance) result.min_clearance = std::min(result.min_clearance.value_or(clearance->distance), clearance->distance);
    if (i + 1 == result.trajectory.size()) break;
    const auto deviation =
        path_deviation(robot.arm().chain, lattice.path(), static_cast<int>(i), q, result.trajectory[i + 1].q - q);
    for (const double error : deviation) {
      sum += error;
      ++samples;
      result.tool_path_error_mm.max = std::max(result.tool_path_error_mm.max, 1e3 * error);
    }
  }
  result.tool_path_error_mm.mean = 1e3 * sum / static_cast<double>(samples);
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
  throw InputError("--planner: unknown planner '" + name + "': allowed are eager, eager_dp, lazy, parallel");
}

PlanResult plan(const Problem& problem, const PlanOptions& options) {
  Stopwatch watch;
  const PreparedRobot robot = [&] {
    const Span span("prepare");
    return PreparedRobot(problem);
  }();
  const double prepare = watch.lap();
  PlanResult result = plan(robot, problem, options);
  result.time_ms["prepare"] += prepare;
  return result;
}

PlanResult plan(const PreparedRobot& robot, const Problem& problem, const PlanOptions& options) {
  const Span span("plan");
  validate(problem);
  robot.require_prepared_for(problem);
  Stopwatch watch;
  PlanResult result;
  result.planner = to_string(options.planner);
  result.joint_names = robot.arm().chain.joint_names;
  const Stop stop(options.timeout_s ? std::optional(std::chrono::duration<double>(*options.timeout_s)) : std::nullopt,
                  options.cancel);
  Executor executor(options.planner == PlannerKind::kLazy ? 1 : options.threads, options.backend);
  result.threads = executor.threads();
  result.time_ms["prepare"] = 0;

  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const Lattice lattice(robot.arm().chain, robot.srs(), path, problem);
  result.time_ms["lattice"] = watch.lap();
  const World world(robot.world(), problem.scene);
  result.time_ms["world"] = watch.lap();
  result.warnings = limit_warnings(robot.arm().chain);
  result.warnings.insert(result.warnings.end(), world.warnings().begin(), world.warnings().end());
  result.lattice = {lattice.layers(), lattice.angles(),       kBranches, lattice.windings(), lattice.window(),
                    lattice.nodes(),  path.merged_waypoints()};

  const EdgeRule rule = edge_rule(problem.limits, robot.radii());
  if (options.planner == PlannerKind::kEager) refuse_if_too_large(lattice, problem.source);
  CollisionValidity validity(lattice, world, rule, certificates_of(options), executor, lanes_of(options), stop, options.progress);
  const Found found = search(lattice, validity, options, result);
  result.time_ms["find"] = watch.lap() - (result.time_ms.contains("record") ? result.time_ms["record"] : 0);
  result.counters.nodes_checked = validity.nodes_checked();
  result.counters.edges_checked = validity.edges_checked();
  const CollisionCounters collision = validity.counters();
  result.counters.fcl_calls = collision.fcl_calls;
  result.counters.certified_free = collision.certified_free;
  result.counters.certified_colliding = collision.certified_colliding;
  if (collision.contradictions > 0)
    throw std::logic_error(std::to_string(collision.contradictions) + " certificates contradict FCL");
  if (found.outcome.stopped) {
    result.status = stop.reason() == Stop::Reason::kCancelled ? PlanStatus::kCancelled : PlanStatus::kTimeout;
  } else if (found.outcome.path.empty()) {
    result.status = PlanStatus::kInfeasible;
  } else {
    result.status = PlanStatus::kSolved;
    result.cost = found.outcome.cost;
    fill_trajectory(lattice, found.outcome.path, result);
  }
  result.time_ms["plan"] = result.time_ms["lattice"] + result.time_ms["world"] + result.time_ms["find"] + watch.lap();
  if (options.report) {
    if (result.status == PlanStatus::kSolved) fill_report(robot, lattice, world, result);
    if (result.status == PlanStatus::kInfeasible) result.diagnosis = diagnose(lattice, world, rule, found.deepest);
  }
  result.time_ms["report"] = watch.lap();
  return result;
}

}  // namespace swivel
