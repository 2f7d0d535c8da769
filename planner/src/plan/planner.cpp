// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/plan/planner.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "diagnosis/diagnosis.hpp"
#include "measure/measure_rows.hpp"
#include "plan/answer.hpp"
#include "plan/layout/lattice_cache.hpp"
#include "plan/layout/searched_lattices.hpp"
#include "plan/layout/told_turns.hpp"
#include "plan/search.hpp"
#include "plan/search_on_knots.hpp"
#include "plan/search_settings.hpp"
#include "plan/stopwatch.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/memory.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/unused_keys.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/eager/eager_validity.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/robot/planning_arm.hpp"
#include "validity/collision_validity.hpp"
#include "validity/hooked_validity.hpp"
#include "verify/answer_check.hpp"

namespace swivel {

namespace {

constexpr std::pair<PlannerKind, const char*> kNames[] = {{PlannerKind::kEager, "eager"},
                                                          {PlannerKind::kEagerDp, "eager_dp"},
                                                          {PlannerKind::kLazy, "lazy"},
                                                          {PlannerKind::kParallel, "parallel"}};

/// Returns the number of chunks of a batch. It is independent of the number of threads, so that
/// what is asked is too. The eager planners have none: their nodes are shared out one by one. Each
/// chunk finds its own bounds of distances, which takes a few per cent of a short plan.
int chunks_of(const PlanOptions& options, const Lattice& lattice) {
  constexpr std::int64_t kNodesPerChunk = 50'000, kFewest = 2, kMost = 8;
  if (options.planner == PlannerKind::kLazy) return 1;
  if (options.planner != PlannerKind::kParallel) return 0;
  return static_cast<int>(std::clamp(lattice.nodes() / kNodesPerChunk, kFewest, kMost));
}

ParallelFor shared_with(Executor& threads) {
  return {threads.threads(),
          [&threads](int parts, const auto& body) { threads.for_each_short(parts, body); }};
}

/// Throws InputError if the explicit graph of the eager planner does not fit in memory: it takes
/// about 64 bytes a node and 56 an edge.
void refuse_if_too_large(const Lattice& lattice, const std::string& source) {
  std::vector<Lattice::SlotRun> runs;
  double edges = 0;
  for (int layer = 0; layer + 1 < lattice.layers(); ++layer) {
    if (lattice.slots(layer) == 0) continue;
    lattice.successors(layer, 0, runs);  // every slot of the layer has as many
    for (const Lattice::SlotRun& run : runs)
      edges += static_cast<double>(lattice.slots(layer)) * (run.last - run.first);
  }
  const double needed = 64.0 * static_cast<double>(lattice.nodes()) + 56.0 * edges;
  if (!fits_in_memory(needed))
    throw InputError(
        source,
        "planner eager: its graph would need about " +
            std::to_string(static_cast<long long>(needed / 1e9)) +
            " GB: allowed are coarser resolutions or the planners eager_dp, lazy, parallel");
}

/// Returns the rows of a path that may end at any layer, as far as its joints stay within their
/// limits.
std::vector<TrajectoryRow> partial_rows(const Lattice& lattice, SlotPath path) {
  std::vector<TrajectoryRow> rows;
  for (; !path.empty() && rows.empty(); path.pop_back()) rows = lattice.path_rows(path);
  return rows;
}

/// Notes the furthest layer that a valid path reaches; -1: layer 0 is empty.
void note_reached(const Lattice& lattice, int deepest, Diagnosis& diagnosis) {
  if (deepest < 0) return;
  diagnosis.reached_layer = deepest;
  diagnosis.reached_s = lattice.path().layer(deepest).s;
}

bool same_pose(const Pose& a, const Pose& b) {
  return a.matrix() == b.matrix();
}
bool same_body(const SceneObject& a, const SceneObject& b) {
  return a.name == b.name && a.shape == b.shape && a.allow == b.allow;
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

/// The state kept between plans, each part with what it depends on; a change clears what depends on
/// it.
struct Planner::Impl {
  PathProblem problem;

  std::optional<PlanningArm> arm;                   // until the robot is prepared
  std::shared_ptr<const PreparedRobot> robot;       // shared with clones; depends on the robot
  std::shared_ptr<const PreparedRobot> last_robot;  // prepared with other attached bodies
  std::optional<World> world;                       // depends on robot, scene and limits
  bool world_is_old = true;                         // `world` only serves to make the next one from
  std::shared_ptr<LatticeCache> cache;              // null: lattices are this planner's own
  /// What depends on the task and on the pose of the path's frame.
  struct Layout {
    explicit Layout(std::shared_ptr<const TaskLattice> own)
        : task(std::move(own)), first{task->first(), nullptr}, lattices(task->first()) {}
    explicit Layout(std::shared_ptr<LatticeCache::Entry> entry) : Layout(entry->lattice()) {
      shared = std::move(entry);
    }
    std::shared_ptr<LatticeCache::Entry> shared;  // null: `task` is this planner's own
    std::shared_ptr<const TaskLattice> task;
    Searched first;  // searched by every plan
    SearchedLattices lattices;
    /// The lattice that the last plan searched after `first`, because the path there left the
    /// limits of joints that are treated as circles, each in its nearest turn, because joint 7 at
    /// rest had no path, or because a start beside a singular pose asked for arcs of self-motion.
    std::optional<Searched> second;
    // Answers of TaskLattice, where they were asked for.
    std::optional<bool> has_second;
    std::optional<CarriedStart> carried;
    [[nodiscard]] Searched& last() { return second ? *second : first; }
  };
  std::unique_ptr<Layout> layout;
  // robot_warnings(); kept, as a robot does not change
  std::optional<std::vector<std::string>> of_robot;
  std::unique_ptr<CostToGo> recycled;  // of a lattice before this one, for its memory
  // What failed on the lattice before this one, with the same bodies.
  std::vector<FailureHint> failure_hints;
  std::uint64_t plans = 0;  // number of plans so far
  // By object: the first plan in which it stands as it does now.
  std::vector<std::uint64_t> met;
  std::optional<Executor> executor;
  int executor_threads = 0;  // number of threads that `executor` was made with

  bool single_use = false;  // no plan follows, so that nothing is kept for it
  bool remembers = true;    // what is found out of obstacles is kept for the plans that follow
  // The path of the last plan, see PlanView::path.
  SlotPath path;
  bool viewable = false, was_eager = false;

  explicit Impl(PathProblem p) : problem(std::move(p)), met(problem.scene.size(), 1) {}

  void plan_once() {
    single_use = true;
    remembers = false;
  }

  // --- changes
  void path_changed() {
    if (layout) {
      if (layout->first.cost_to_go) recycled = std::move(layout->first.cost_to_go);
      auto failed = layout->lattices.memory_of(*layout->first.lattice).failure_hints();
      if (!failed.empty()) failure_hints = std::move(failed);
    }
    layout.reset();
    viewable = false;
  }
  void scene_changed() {
    world_is_old = true;
    viewable = false;
  }
  void bodies_changed() {
    failure_hints.clear();
    scene_changed();
  }
  void all_changed() {
    path_changed();
    bodies_changed();
  }
  void attached_changed() {
    if (robot) last_robot = std::exchange(robot, nullptr);
    of_robot.reset();
    world.reset();
    all_changed();
  }
  void moved(std::size_t object) {
    scene_changed();
    met[object] = plans + 1;
    if (problem.scene[object].name == problem.path_frame) path_changed();
  }
  /// Replaces the problem by `next`. Throws InvalidArgument, and changes nothing, if that is not
  /// valid.
  void replace(PathProblem next) {
    validate(next);
    problem = std::move(next);
  }
  [[nodiscard]] std::size_t object(const std::string& name) const {
    const auto found = std::find_if(problem.scene.begin(), problem.scene.end(),
                                    [&](const auto& o) { return o.name == name; });
    if (found == problem.scene.end())
      throw InvalidArgument("'" + name + "': no such object: allowed are names of the scene");
    return static_cast<std::size_t>(found - problem.scene.begin());
  }
  void set_scene(std::vector<SceneObject> scene) {
    if (!std::equal(scene.begin(), scene.end(), problem.scene.begin(), problem.scene.end(),
                    same_body)) {
      problem.scene = std::move(scene);
      met.assign(problem.scene.size(), 1);
      all_changed();
      return;
    }
    for (std::size_t k = 0; k < scene.size(); ++k) {
      if (same_pose(problem.scene[k].pose, scene[k].pose)) continue;
      problem.scene[k].pose = scene[k].pose;
      moved(k);
    }
  }
  void set_task(const Task& task) {
    Task& own = problem;
    if (same_task(task, own)) return;
    Task same_kinematics = own;
    same_kinematics.limits = Lattice::with_clearances(own.limits, task.limits);
    own = task;
    if (layout && !layout->shared && same_task(task, same_kinematics)) {
      layout->lattices.take_clearances(task.limits);
      scene_changed();
    } else {
      path_changed();
      scene_changed();
    }
  }

  // --- plans
  const PreparedRobot& prepare(const Budget& budget) {
    if (!robot) {
      const TraceSpan span("prepare");
      budget.tell(Stage::kPreparing);
      robot = last_robot ? std::make_shared<const PreparedRobot>(*last_robot, problem, budget)
              : arm      ? std::make_shared<const PreparedRobot>(problem, *arm, budget)
                         : std::make_shared<const PreparedRobot>(problem, budget);
      arm.reset();
      last_robot.reset();
    }
    return *robot;
  }
  Executor& threads_of(const PlanOptions& options) {
    const int wanted = options.planner == PlannerKind::kLazy ? 1 : options.threads;
    if (!executor || executor_threads != wanted) executor.emplace(wanted);
    executor_threads = wanted;
    return *executor;
  }
  /// `hooks`: as TaskLattice takes them.
  void lay_out(const Hooks& hooks, const Budget& budget, PlanResult& result) {
    Stopwatch watch;
    budget.tell(Stage::kLattice);
    require_joints_that_move(*robot, problem);
    if (layout && !layout->task->serves(hooks)) path_changed();
    if (!layout && cache)
      layout = std::make_unique<Layout>(cache->of(*robot, problem, hooks, budget));
    if (!layout)
      layout = std::make_unique<Layout>(
          std::make_shared<const TaskLattice>(*robot, problem, hooks, budget));
    layout->second.reset();
    layout->lattices.forget_old();
    result.time_ms["lattice"] = watch.lap();
    if (world_is_old) world = World(world ? *world : robot->world(), problem, budget);
    world_is_old = false;
    result.time_ms["world"] = watch.lap();
    result.held = robot->arm().held;
    if (!of_robot) of_robot = robot_warnings(*robot, problem);
    result.warnings = *of_robot;
    for (const auto& lines :
         {unused_key_warnings(unused_keys(robot->arm().chain, robot->arm_class()), problem),
          layout->first.lattice->has_layers_between()
              ? std::vector<std::string>()
              : unused_key_warnings(
                    unused_knot(hooks.cost                ? "paths whose states cost something"
                                : problem.resolution.arcs ? "paths with resolution.arcs"
                                                          : "paths with limits.step_error"),
                    problem),
          path_warnings(*robot, problem, layout->task->path(), *world)})
      result.warnings.insert(result.warnings.end(), lines.begin(), lines.end());
    SpecialPairs pairs;
    pairs.add(*world);
    result.dropped_pairs = std::move(pairs.dropped);
    result.reduced_pairs = std::move(pairs.reduced);
    result.lattice = info_of(*layout->first.lattice, robot->arm_class());
  }
  /// Searches the lattices of the task one after the other until one answers.
  Found search(const EdgeRule& rule, const PlanOptions& options, const Budget& budget,
               PlanResult& result) {
    was_eager = is_eager(options);
    // The cost of a state by the caller's hook may depend on joint 7, which must then be free.
    std::optional<Found> first;
    if (!(layout->task->coaxial() && options.hooks.cost)) {
      first = search_knots(layout->first, rule, options, budget, result);
      first = tell_turns_apart(*std::move(first), rule, options, budget, result);
      if (!first->decided) return *std::move(first);
      if (!first->outcome.path.empty())
        return or_cheaper_arcs(*std::move(first), rule, options, budget, result);
    }
    if (!layout->has_second) layout->has_second = layout->task->has_second(*robot, problem, budget);
    return *layout->has_second ? search_second(rule, options, budget, result) : *std::move(first);
  }
  /// Searches TaskLattice::second() after layout->first.
  Found search_second(const EdgeRule& rule, const PlanOptions& options, const Budget& budget,
                      PlanResult& result) {
    const auto make = [&] { return layout->task->second(*robot, problem, budget); };
    const std::shared_ptr<Lattice> lattice = single_use ? make() : layout->lattices.second(make);
    layout->second = Searched{lattice, nullptr};
    result.lattice = info_of(*lattice, robot->arm_class());
    Found found = search_knots(*layout->second, rule, options, budget, result);
    return tell_turns_apart(std::move(found), rule, options, budget, result);
  }
  /// Returns `first`, a path of the lattice searched first, or a cheaper one on arcs of
  /// self-motion. These are searched where the start, carried past a singular pose, promises a path
  /// that is cheaper by more than 5 % and meets no obstacle; they take longer than a grid.
  Found or_cheaper_arcs(Found first, const EdgeRule& rule, const PlanOptions& options,
                        const Budget& budget, PlanResult& result) {
    constexpr double kWorth = 1.05;
    if (!layout->carried) layout->carried = layout->task->carried_start(*robot, problem, budget);
    const double cost = cost_of(first);
    if (!(layout->carried->cost * kWorth < cost)) return first;
    World::Query query(*world, distance_proofs_of(options));
    for (const Config& q : layout->carried->joints)
      if (query.find_violating_pair(q, ClearanceRule::kNode)) return first;
    std::optional<Searched> before = std::exchange(layout->second, std::nullopt);
    const LatticeInfo info = result.lattice;
    const std::vector<std::string> warnings = result.warnings;
    try {
      const Budget time = most_of(budget, options);
      Found found = search_second(rule, options, time, result);
      if (found.decided && !found.outcome.path.empty() && cost_of(found) < cost) return found;
    } catch (const Stopped&) {  // the path that was found first is the answer
    }
    layout->second = std::move(before);
    result.lattice = info;
    result.warnings = warnings;
    return first;
  }
  /// Returns what the rows of a path cost that was found on layout->last().
  double cost_of(Found& found) {
    const Lattice& lattice = *layout->last().lattice;
    if (found.rows.empty()) found.rows = lattice.path_rows(found.outcome.path);
    return cost_of_rows(lattice, found.outcome.path, found.rows, found.outcome.cost);
  }
  /// Returns `found`, the answer of the lattice searched last, if its path is the answer of the
  /// task. A path on which a joint that is treated as a circle leaves its limits
  /// (Lattice::off_limits()) is not: the next lattice tells the values of such joints apart, and
  /// its answer is returned. Where that has no path, a warning says what the cheapest path would
  /// have asked of the joint.
  Found tell_turns_apart(Found found, const EdgeRule& rule, const PlanOptions& options,
                         const Budget& budget, PlanResult& result) {
    std::string note;
    std::vector<std::vector<int>> failed;
    for (;;) {
      const std::shared_ptr<Lattice> circles = layout->last().lattice;
      const Lattice& lattice = *circles;
      if (found.decided && found.outcome.path.empty() && !note.empty())
        result.warnings.push_back(note);
      if (!found.decided || found.outcome.path.empty()) return found;
      if (found.rows.empty()) found.rows = lattice.path_rows(found.outcome.path);
      if (!found.rows.empty()) return found;
      const Lattice::Joints off = lattice.off_limits(found.outcome.path);
      if (note.empty()) note = turns_note(lattice, found.outcome.path, off, problem);
      Searched wound{
          single_use ? lattice.with_windings(off) : layout->lattices.with_windings(circles, off),
          nullptr};
      if (!was_eager) {
        const CostToGo& before = *layout->last().cost_to_go;
        add_failed_nodes(before.verdicts(), lattice, failed);
        wound.cost_to_go = make_cost_to_go(*wound.lattice, pruning_of(*wound.lattice), budget);
        wound.cost_to_go->bound_by(before);
      }
      layout->second = std::move(wound);
      result.lattice = info_of(*layout->second->lattice, robot->arm_class());
      found = search_knots(*layout->second, rule, options, budget, result,
                           was_eager ? nullptr : &failed);
    }
  }
  /// What a search begins with, of a search before it.
  struct Known {
    /// What add_failed_nodes() found before turns were told apart.
    const std::vector<std::vector<int>>* failed = nullptr;
    /// A search of the lattice from which this one was made by halving steps.
    const Searched* coarser = nullptr;
  };
  /// Searches a lattice, and lattices with more knots where that is worth it (search_on_knots());
  /// layout->last() is the lattice of the answer. Other parameters as of search().
  Found search_knots(Searched& searched, const EdgeRule& rule, const PlanOptions& options,
                     const Budget& budget, PlanResult& result,
                     const std::vector<std::vector<int>>* failed = nullptr) {
    FoundOnKnots on_knots = search_on_knots(
        searched,
        [&](Searched& level, const Searched* coarser, const Budget& time, KnotSearch* knots) {
          return search(level, rule, options, time, result,
                        {coarser == nullptr ? failed : nullptr, coarser}, knots);
        },
        [&](const std::shared_ptr<Lattice>& lattice, const std::set<int>& steps,
            const Budget& time) {
          return single_use ? halve_steps(lattice, steps, time)
                            : layout->lattices.with_knots(lattice, steps, time);
        },
        options, budget);
    if (on_knots.finer) layout->second = std::move(*on_knots.finer);
    if (on_knots.knots) {
      result.lattice = info_of(*layout->last().lattice, robot->arm_class());
      result.lattice.knots = on_knots.knots;
    }
    return std::move(on_knots.found);
  }
  /// Makes the cost-to-go of a lattice that was not searched before.
  std::unique_ptr<CostToGo> begin_cost_to_go(const Searched& searched, const Budget& budget) {
    auto made = make_cost_to_go(*searched.lattice, pruning_of(*searched.lattice), budget,
                                std::move(recycled));
    if (layout->shared && &searched == &layout->first) layout->shared->begin(*made);
    return made;
  }
  /// Searches one lattice. `knots` as search_lazily() takes it.
  Found search(Searched& searched, const EdgeRule& rule, const PlanOptions& options,
               const Budget& budget, PlanResult& result, const Known& known, KnotSearch* knots) {
    const Lattice& lattice = *searched.lattice;
    Executor& threads = threads_of(options);
    Counters counters;
    Found found;
    if (was_eager && !knots) {
      if (options.planner == PlannerKind::kEager) refuse_if_too_large(lattice, problem.source);
      CollisionValidity validity(lattice, *world, rule, problem.limits.edges,
                                 distance_proofs_of(options), threads, 0, budget);
      HookedValidity hooked(lattice, validity, options.hooks, budget);
      found = search_eagerly(lattice, hooked, options, budget, counters);
      add_counters(validity, counters);
      add_counters(counters, result.counters);
      return found;
    }
    std::unique_ptr<CostToGo>& cost_to_go = searched.cost_to_go;
    if (!cost_to_go) cost_to_go = begin_cost_to_go(searched, budget);
    if (single_use || known.coarser) cost_to_go->set_single_use();
    const bool shares = shares_work(lattice);
    if (shares) threads.start_helpers();
    cost_to_go->share(shares ? shared_with(threads) : ParallelFor());
    const bool swept = cost_to_go->restart(budget);
    if (known.failed) remove_failed_nodes(*known.failed, lattice, cost_to_go->verdicts());
    if (known.coarser) take_from_coarser(*known.coarser, searched, !options.hooks.cost);
    std::optional<World> changed;
    ClearanceMemory* const memory = remembers ? &layout->lattices.memory_of(lattice) : nullptr;
    if (memory) {
      memory->begin(plans, met, *world, problem.scene);
      if (!memory->changed().empty()) changed.emplace(*world, memory->changed());
    }
    CollisionValidity validity(lattice, *world, rule, problem.limits.edges,
                               distance_proofs_of(options), threads, chunks_of(options, lattice),
                               budget, memory, changed ? &*changed : nullptr);
    HookedValidity hooked(lattice, validity, options.hooks, budget);
    std::optional<EagerValidity> eager;
    if (was_eager) eager.emplace(lattice, hooked, true, budget);
    const std::vector<FailureHint> asked_before = memory && &searched == &layout->first
                                                      ? std::exchange(failure_hints, {})
                                                      : std::vector<FailureHint>();
    found = search_lazily(*cost_to_go, swept, eager ? static_cast<Validity&>(*eager) : hooked,
                          memory ? memory->failures() : PriorFailures{}, asked_before, options,
                          counters, result.time_ms, knots);
    add_counters(validity, counters);
    add_counters(counters, result.counters);
    return found;
  }
  /// If a second thread may run, it builds the trees of heavy meshes while the first thread finds
  /// paths without obstacles.
  std::jthread meshes_ahead(const PlanOptions& options) {
    constexpr std::size_t kHeavy = 5000;  // triangles, which take some milliseconds
    if (threads_of(options).threads() == 1 || world->triangles_to_make_ready() < kHeavy) return {};
    try {
      return std::jthread([world = &*world](const std::stop_token& stop) {
        try {
          world->make_ready([&] { return stop.stop_requested(); });
        } catch (...) {  // the query that needs the tree will meet the same error
        }
      });
    } catch (const std::system_error&) {  // the system has no thread to spare
      return {};
    }
  }
  void find(const PlanOptions& options, const Budget& budget, PlanResult& result) {
    Stopwatch watch, whole;
    if (problem.closed && options.hooks.cost)
      throw InvalidArgument(
          "closed: is not supported beside a cost of states: allowed is one of the two");
    lay_out(options.hooks, budget, result);
    const EdgeRule rule = world->edge_rule(robot->radii());
    watch.lap();
    Found found = [&] {
      const std::jthread ahead = meshes_ahead(options);
      return search(rule, options, budget, result);
    }();
    result.time_ms["find"] = watch.lap();
    const Lattice& lattice = *layout->last().lattice;
    path = found.valid_path;
    viewable = true;
    if (!found.decided) {
      result.partial = partial_rows(lattice, path);
      throw Stopped();
    }
    result.status = found.outcome.path.empty() ? PlanStatus::kInfeasible : PlanStatus::kSolved;
    if (result.status == PlanStatus::kSolved) {
      result.cost = result.lattice.cost = found.outcome.cost;
      result.trajectory = std::move(found.rows);
      require_same_turns(lattice, result.trajectory, problem.source);
      measure_margins(robot->arm().chain, layout->task->path(), result.trajectory, result);
      result.cost = cost_of_rows(lattice, path, result.trajectory, result.cost);
      describe_knots(result.cost, lattice, path, problem.resolution.arc_of_nodes(), result.lattice);
    }
    result.time_ms["plan"] = whole.lap();
    watch.lap();
    if (result.status == PlanStatus::kSolved)
      prove_answer(options, budget, result,
                   [&] { check_answer(*world, *robot, problem, result.trajectory, budget); });
    watch.lap();
    explain(rule, found, options, budget, result);
    result.time_ms["report"] = watch.lap();
  }
  /// Computes the evidence and the diagnosis that the options ask for, as far as the budget allows.
  void explain(const EdgeRule& rule, const Found& found, const PlanOptions& options,
               const Budget& budget, PlanResult& result) {
    const TraceSpan span("report");
    const Lattice& lattice = *layout->last().lattice;
    try {
      if (result.status == PlanStatus::kSolved) {
        result.tool_path_error_mm.allowed = problem.limits.tool_path_error;
        measure_rows(*robot, layout->task->path(), *world, result.trajectory, options.evidence,
                     budget, result);
        return;
      }
      Diagnosis& diagnosis = result.diagnosis.emplace();
      diagnosis.complete = false;  // until diagnose() has finished
      if (lattice.is_closed() && found.deepest == lattice.layers() - 1) {
        explain_open(rule, found, options, budget, result);
        return;
      }
      if (found.deepest) budget.tell(Stage::kDiagnosis);
      if (was_eager && found.deepest.value_or(-1) >= 0)
        path = best_path_to(lattice, *world, rule, *found.deepest, budget, options.hooks);
      result.partial = partial_rows(lattice, path);
      if (!found.deepest) return;
      if (!options.evidence.cause) {
        diagnosis.cause.kind = Cause::Kind::kNotAsked;
        note_reached(lattice, *found.deepest, diagnosis);
        return;
      }
      diagnose(lattice, *world, rule, path, options.evidence.layers, budget, diagnosis,
               options.hooks.check);
      result.evidence.layers = options.evidence.layers;
    } catch (const Stopped&) {
    }
  }
  /// Says that paths lead to the end of a closed path, but none back to where it begins.
  void explain_open(const EdgeRule& rule, const Found& found, const PlanOptions& options,
                    const Budget& budget, PlanResult& result) {
    const Lattice& lattice = *layout->last().lattice;
    if (was_eager)
      path = best_path_to(lattice, *world, rule, *found.deepest, budget, options.hooks);
    result.partial = partial_rows(lattice, path);
    Diagnosis& diagnosis = *result.diagnosis;
    diagnosis.cause.kind = Cause::Kind::kNotClosed;
    note_reached(lattice, *found.deepest, diagnosis);
    diagnosis.layers_known = lattice.layers();
    diagnosis.complete = true;
  }
  PlanResult plan(const PlanOptions& options) {
    const TraceSpan span("plan");
    const Budget budget = options.budget();
    Stopwatch watch;
    PlanResult result;
    result.planner = to_string(options.planner);
    result.threads = threads_of(options).threads();
    viewable = false;
    ++plans;
    try {
      prepare(budget);
      result.time_ms["prepare"] = watch.lap();
      result.joint_names = robot->arm().chain.joint_names;
      find(options, budget, result);
    } catch (const Stopped&) {
      result.status = stopped_status(budget);
      result.time_ms[!result.time_ms.contains("prepare") ? "prepare"
                     : result.time_ms.contains("plan")   ? "check"
                                                         : "plan"] = watch.lap();
    }
    return result;
  }
};

Planner::Planner(const Robot& robot)
    : Planner([&] {
        PathProblem problem;
        static_cast<Robot&>(problem) = robot;
        return problem;
      }()) {}
Planner::Planner(PathProblem problem) : impl_(std::make_unique<Impl>(std::move(problem))) {
  const PathProblem& p = impl_->problem;
  validate(p);
  validate(*p.model);
  impl_->arm = planning_arm(p);
}
Planner::Planner(std::shared_ptr<const PreparedRobot> robot, PathProblem problem)
    : impl_(std::make_unique<Impl>(std::move(problem))) {
  validate(impl_->problem);
  robot->require_prepared_for(impl_->problem);
  impl_->robot = std::move(robot);
}
Planner::~Planner() = default;
Planner::Planner(Planner&&) noexcept = default;
Planner& Planner::operator=(Planner&&) noexcept = default;

void Planner::share_lattices(std::shared_ptr<LatticeCache> cache) {
  impl_->cache = std::move(cache);
  impl_->remembers = false;
}

Planner Planner::clone() const {
  return impl_->robot ? Planner(impl_->robot, impl_->problem) : Planner(impl_->problem);
}

const PathProblem& Planner::problem() const {
  return impl_->problem;
}
const PreparedRobot& Planner::prepare(const Budget& budget) {
  return impl_->prepare(budget);
}

void Planner::set_task(const Task& task) {
  PathProblem next = impl_->problem;
  static_cast<Task&>(next) = task;
  validate(next);
  impl_->set_task(task);
}

void Planner::set_scene(std::vector<SceneObject> scene) {
  PathProblem next = impl_->problem;
  next.scene = std::move(scene);
  validate(next);
  impl_->set_scene(std::move(next.scene));
}

void Planner::set_problem(PathProblem problem) {
  validate(problem);
  if (impl_->robot) impl_->robot->require_prepared_for(problem);
  impl_->problem.source = problem.source;
  impl_->problem.vary = problem.vary;
  impl_->set_scene(std::move(problem.scene));
  impl_->set_task(problem);
  // Problems have little in common, and what one of them takes must not depend on the one before.
  impl_->failure_hints.clear();
}

void Planner::add(SceneObject object) {
  PathProblem next = impl_->problem;
  next.scene.push_back(std::move(object));
  impl_->replace(std::move(next));
  impl_->met.push_back(impl_->plans + 1);
  impl_->bodies_changed();
}

void Planner::move(const std::string& object, const Pose& pose) {
  const std::size_t k = impl_->object(object);
  validate(pose, object);
  impl_->problem.scene[k].pose = pose;
  impl_->moved(k);
}

void Planner::remove(const std::string& object) {
  const std::size_t k = impl_->object(object);
  PathProblem next = impl_->problem;
  next.scene.erase(next.scene.begin() + static_cast<std::ptrdiff_t>(k));
  std::erase_if(next.vary, [&](const Variation& vary) { return vary.object == object; });
  impl_->replace(std::move(next));
  impl_->met.erase(impl_->met.begin() + static_cast<std::ptrdiff_t>(k));
  if (impl_->layout) impl_->layout->lattices.object_removed(static_cast<int>(k));
  impl_->bodies_changed();
}

void Planner::attach(AttachedBody body) {
  PathProblem next = impl_->problem;
  next.attached.push_back(std::move(body));
  impl_->replace(std::move(next));
  impl_->attached_changed();
}

void Planner::detach(const std::string& body) {
  PathProblem next = impl_->problem;
  if (std::erase_if(next.attached, [&](const AttachedBody& b) { return b.name == body; }) == 0)
    throw InvalidArgument("'" + body + "': no such body: allowed are names of attached bodies");
  for (SceneObject& object : next.scene)
    std::erase_if(object.allow, [&](const Allowed& allowed) { return allowed.body == body; });
  impl_->replace(std::move(next));
  impl_->attached_changed();
}

PlanResult Planner::plan(const PlanOptions& options) {
  return impl_->plan(options);
}

PlanView Planner::view() const {
  if (!impl_->viewable)
    throw InvalidArgument(
        "there is nothing to see: allowed after a plan() that came as far as its search");
  const Impl& x = *impl_;
  const Searched& last = x.layout->last();
  return {*x.robot,
          x.problem,
          *last.lattice,
          *x.world,
          x.was_eager ? nullptr : &last.cost_to_go->verdicts(),
          x.path,
          x.layout->task->states_cost() ? on_all_layers(x.problem, x.robot->arm_class()).resolution
                                        : x.problem.resolution};
}

PlanResult plan(const PathProblem& problem, const PlanOptions& options) {
  Planner planner(problem);
  planner.impl_->plan_once();
  return planner.plan(options);
}

PlanResult plan(const PreparedRobot& robot, const PathProblem& problem,
                const PlanOptions& options) {
  // The pointer does not own the robot, which outlives this call.
  Planner planner(std::shared_ptr<const PreparedRobot>(std::shared_ptr<void>(), &robot), problem);
  planner.impl_->plan_once();
  return planner.plan(options);
}

}  // namespace swivel
