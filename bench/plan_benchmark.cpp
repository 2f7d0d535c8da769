// SPDX-License-Identifier: BSD-3-Clause
// Measures whole plans on a prepared robot, by scene / planner / resolution / edge mode / threads.
// Scenes are the paper's experiments, an arm without an arm angle (`arcs`), an arm that also
// chooses the roll of its tool (`roll`), and an arm whose links are meshes (`meshes`). Rows
// contact/PAD/TRIANGLES lead a pad across a dome that it may touch, with the measures of the
// answer (report_ms). The planner lazy_fcl_alone is lazy without Swivel's own proofs
// (PlanOptions::fcl_alone). Report stages are not timed. Rows have counters eager_ms, eager_dp_ms
// and the speed-ups over both: the eager planners run on the same problem before and after each
// repetition, in the same process; a plan of more than a second runs once for all rows of its
// problem.
//
//   plan_benchmark [--benchmark_filter=^c/lazy] [--plan_limit=60]
//       --plan_limit=S    do not run rows of which a plan takes longer than S seconds; they say so
//
// Every argument of google-benchmark applies.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "context.hpp"
#include "mesh_bodies.hpp"
#include "pads.hpp"
#include "settings.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace {

using namespace swivel;

constexpr double kOncePerProcess = 1;  // s: a slower eager plan serves all rows of its problem
constexpr double kOnce = 5;            // s: a row with slower plans has one repetition
double plan_limit = 60;                // s

struct Scene {
  const char* name;
  const char* file;
  /// Whether it runs with every planner and edge mode; otherwise with those that compare eager with
  /// lazy and parallel.
  bool of_the_paper;
  int settings;  ///< number of bench::kSettings to run
  bool mesh_bodies = false;
};
constexpr int kAllSettings = static_cast<int>(std::size(bench::kSettings));
constexpr Scene kScenes[] = {{"a", "experiment_a", true, bench::kPaperSettings},
                             {"b", "experiment_b", true, bench::kPaperSettings},
                             {"c", "experiment_c", true, kAllSettings},
                             {"c_20k", "experiment_c_20k", true, bench::kPaperSettings},
                             {"arcs", "panda_weld_seam", false, bench::kPaperSettings},
                             {"roll", "torch_door", false, bench::kPaperSettings},
                             {"meshes", "iiwa14_bench", false, bench::kPaperSettings, true}};

/// A problem, and its robot prepared with everything that questions about meshes need.
struct Prepared {
  PathProblem problem;
  PreparedRobot robot;
  explicit Prepared(PathProblem of) : problem(std::move(of)), robot(problem) {
    // m, so that bounds prove nothing and FCL's trees are built as well
    constexpr double kFar = 100;
    const World& world = robot.world();
    world.make_ready([] { return false; });
    World::Query query(world);
    for (const BodyPair& pair : world.pairs())
      benchmark::DoNotOptimize(query.pair_violates(Config::Zero(), pair, kFar));
  }
};

const Prepared& prepared(const Scene& scene) {
  static std::map<std::string, std::unique_ptr<const Prepared>> all;
  auto& entry = all[scene.name];
  if (!entry) {
    PathProblem problem = io::load_path_problem(std::filesystem::path(SWIVEL_DATA_DIR) /
                                                "problems" / (std::string(scene.file) + ".yaml"));
    entry = std::make_unique<const Prepared>(
        scene.mesh_bodies ? bench::with_mesh_bodies(std::move(problem)) : std::move(problem));
  }
  return *entry;
}

struct Case {
  PlannerKind planner;
  EdgeMode edges;
  int threads;
  bool fcl_alone = false;
  bool over_eager = false, over_eager_dp = false;  ///< the planners it is compared with
};

std::string label_of(const Scene& scene, const Case& what, const bench::Setting& setting) {
  std::string label = std::string(scene.name) + "/" + to_string(what.planner) +
                      (what.fcl_alone ? "_fcl_alone" : "") + "/" + setting.name +
                      (what.edges == EdgeMode::kNodes ? "/nodes" : "/continuous");
  if (what.planner == PlannerKind::kParallel || what.threads > 1)
    label += "/threads:" + std::to_string(what.threads);
  return label;
}

PlanOptions options_for(PlannerKind planner, int threads) {
  PlanOptions options;
  options.check = false;  // the time of planning is measured
  options.planner = planner;
  options.threads = threads;
  options.timeout_s = plan_limit;
  return options;
}

bool in_time(const PlanResult& result) {
  return result.status != PlanStatus::kTimeout;
}

/// Times of plans that take longer than a second, by label; they are not repeated for every row
/// that is compared with them.
struct SlowPlan {
  /// s; the limit if the plan took more.
  double s = 0;
  bool has_row = false;    ///< whether its own row was measured
  bool too_large = false;  ///< the plan was refused: the eager graph does not fit in memory
};
std::map<std::string, SlowPlan> slow_plans;

SlowPlan slow_plan(const std::string& label) {
  const auto found = slow_plans.find(label);
  return found == slow_plans.end() ? SlowPlan() : found->second;
}

/// Notes how long a plan took, if that was more than a second.
void note_time(const std::string& label, const PlanResult& result, bool for_its_row) {
  const double s = in_time(result) ? result.time_ms.at("plan") / 1e3 : plan_limit;
  if (s > kOncePerProcess) slow_plans[label] = {s, for_its_row || slow_plan(label).has_row};
}

/// Plans; returns nothing, and notes it, where the eager planner refuses a graph that does not fit
/// in memory.
std::optional<PlanResult> plan_if_it_fits(const std::string& label, const Scene& scene,
                                          const PathProblem& problem, const PlanOptions& options) {
  try {
    return plan(prepared(scene).robot, problem, options);
  } catch (const InputError&) {
    if (options.planner != PlannerKind::kEager) throw;
    slow_plans[label] = {.s = plan_limit, .has_row = false, .too_large = true};
    return std::nullopt;
  }
}

/// Returns the time of one eager plan, ms; nothing if it takes more than the limit, or does not fit
/// in memory.
std::optional<double> eager_ms(const std::string& label, const Scene& scene,
                               const PathProblem& problem, PlannerKind planner) {
  if (const SlowPlan slow = slow_plan(label); slow.s > 0)
    return slow.s < plan_limit ? std::optional(1e3 * slow.s) : std::nullopt;
  const auto result = plan_if_it_fits(label, scene, problem, options_for(planner, 1));
  if (!result) return std::nullopt;
  note_time(label, *result, false);
  return in_time(*result) ? std::optional(result->time_ms.at("plan")) : std::nullopt;
}

/// Times of an eager plan before and after the row that is compared with it.
struct EagerTimes {
  const Scene& scene;
  const PathProblem& problem;
  PlannerKind planner;
  std::string label;  ///< label of the eager planner's row
  bool asked;
  std::optional<double> sum = 0.0;
  void measure() {
    if (!asked || !sum) return;
    const auto ms = eager_ms(label, scene, problem, planner);
    sum = ms ? std::optional(*sum + *ms) : std::nullopt;
  }
  void count(benchmark::State& state, double ms) const {
    if (!asked || !sum) return;
    const std::string name = to_string(planner);
    state.counters[name + "_ms"] = *sum / 2;
    state.counters["speed_up_over_" + name] = *sum / 2 / ms;
  }
};

/// Sets the counters of a row to the work of its last plan.
void count_work(benchmark::State& state, const PlanResult& result) {
  state.SetItemsProcessed(state.iterations() * result.lattice.nodes);
  const Counters& work = result.counters;
  for (const auto& [name, value] : {std::pair{"nodes_checked", work.nodes_checked},
                                    {"edges_checked", work.edges_checked},
                                    {"fcl_calls", work.fcl_calls},
                                    {"certified", work.proved_free + work.proved_colliding},
                                    {"expansions", work.expansions},
                                    {"iterations", work.iterations},
                                    {"ik_nodes", work.ik_nodes},
                                    {"edges", work.edges}})
    state.counters[name] = static_cast<double>(value);
  state.counters["nodes"] = static_cast<double>(result.lattice.nodes);
  state.counters["layers"] = result.lattice.layers;
  state.counters["cost"] = result.cost;
  state.counters["solved"] = result.status == PlanStatus::kSolved;
}

void run(benchmark::State& state, const Scene& scene, const Case& what,
         const bench::Setting& setting) {
  const std::string label = label_of(scene, what, setting);
  const auto not_run = [&] {
    state.SkipWithError(slow_plan(label).too_large
                            ? "not run: more memory than there is"
                            : formatted("not run: more than %g s a plan", plan_limit).c_str());
  };
  if (const SlowPlan slow = slow_plan(label); slow.s >= plan_limit)
    return not_run();
  else if (slow.has_row && slow.s > kOnce)
    return state.SkipWithError("not repeated: a plan takes seconds");
  PathProblem problem = prepared(scene).problem;
  bench::set_resolution(problem, setting);
  // `eager` is measured on the paper's lattice, with nodes at every layer
  if (!problem.roll) problem.resolution.knot = 0;
  problem.limits.edges = what.edges;
  const auto eager_times = [&](PlannerKind planner, bool asked) {
    return EagerTimes{scene, problem, planner, label_of(scene, {planner, what.edges, 1}, setting),
                      asked};
  };
  EagerTimes eager = eager_times(PlannerKind::kEager, what.over_eager);
  EagerTimes eager_dp = eager_times(PlannerKind::kEagerDp, what.over_eager_dp);
  eager.measure();
  eager_dp.measure();
  PlanOptions options = options_for(what.planner, what.threads);
  options.fcl_alone = what.fcl_alone;
  PlanResult result;
  double ms = 0;
  for (auto _ : state) {
    auto found = plan_if_it_fits(label, scene, problem, options);
    if (!found) {
      not_run();
      return;
    }
    result = *std::move(found);
    benchmark::DoNotOptimize(result.trajectory.data());
    note_time(label, result, true);
    if (!in_time(result)) {
      not_run();
      break;
    }
    ms += result.time_ms.at("plan");
  }
  if (!in_time(result)) return;
  count_work(state, result);
  state.counters["plan_ms"] = ms / static_cast<double>(state.iterations());
  eager.measure();
  eager_dp.measure();
  eager.count(state, state.counters["plan_ms"]);
  eager_dp.count(state, state.counters["plan_ms"]);
}

std::vector<Case> cases(const Scene& scene, int setting) {
  const bool paper = setting < bench::kPaperSettings;
  const int most_threads = std::max(2, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<Case> all;
  // Eager planners with continuous edges take minutes, because every edge of the lattice is swept
  // through FCL.
  if (setting <= bench::kPaperSettings) {
    all.push_back({.planner = PlannerKind::kEager, .edges = EdgeMode::kNodes, .threads = 1});
    if (scene.of_the_paper)
      all.push_back({.planner = PlannerKind::kEagerDp, .edges = EdgeMode::kNodes, .threads = 1});
  }
  if (paper) {
    all.push_back({.planner = PlannerKind::kEager,
                   .edges = EdgeMode::kNodes,
                   .threads = 2,
                   .over_eager = true});
    all.push_back({.planner = PlannerKind::kLazy,
                   .edges = EdgeMode::kNodes,
                   .threads = 1,
                   .fcl_alone = true,
                   .over_eager = true});
  }
  for (const EdgeMode edges : {EdgeMode::kNodes, EdgeMode::kContinuous}) {
    if (edges == EdgeMode::kContinuous && !scene.of_the_paper) continue;
    const bool over_eager = paper && edges == EdgeMode::kNodes,
               over_eager_dp = over_eager && scene.of_the_paper;
    const auto add = [&](PlannerKind planner, int threads) {
      all.push_back({.planner = planner,
                     .edges = edges,
                     .threads = threads,
                     .over_eager = over_eager,
                     .over_eager_dp = over_eager_dp});
    };
    add(PlannerKind::kLazy, 1);
    for (int threads = scene.of_the_paper ? 1 : 2; threads <= most_threads; threads *= 2)
      add(PlannerKind::kParallel, threads);
  }
  return all;
}

/// Plans a pad's stroke across a dome with everything that is told of it.
void run_pad(benchmark::State& state, const char* pad, int triangles, double depth) {
  const PathProblem problem =
      bench::pad_on_dome(io::load_path_problem(std::filesystem::path(SWIVEL_DATA_DIR) / "problems" /
                                               "iiwa14_bench.yaml"),
                         pad, triangles, depth);
  const PreparedRobot robot(problem);
  PlanOptions options = options_for(PlannerKind::kLazy, 1);
  options.evidence = Evidence::all();
  PlanResult result;
  for (auto _ : state) {
    result = plan(robot, problem, options);
    benchmark::DoNotOptimize(result.trajectory.data());
    if (!in_time(result)) return state.SkipWithError("not run: longer than the limit");
  }
  count_work(state, result);
  state.counters["report_ms"] = result.time_ms["report"];
  if (result.deepest_contact) state.counters["depth_mm"] = 1e3 * result.deepest_contact->depth;
}

void register_pads() {
  for (const char* const pad : bench::kPads)
    for (const int triangles : {200, 4400, 100'000})
      for (const double depth : {0.0, 0.003}) {
        if (depth > 0 && std::string_view(pad) == "mesh") continue;  // refused of two meshes
        const std::string label =
            formatted("contact/%s/%d%s", pad, triangles, depth > 0 ? "/at most 3 mm deep" : "");
        benchmark::RegisterBenchmark(
            label.c_str(), [=](benchmark::State& state) { run_pad(state, pad, triangles, depth); })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
      }
}

/// Removes --plan_limit=S from the arguments. Returns false if S is no number of seconds.
bool take_plan_limit(int& argc, char** argv) {
  constexpr std::string_view kFlag = "--plan_limit=";
  char** const last = std::remove_if(argv + 1, argv + argc, [&](const char* word) {
    if (!std::string_view(word).starts_with(kFlag)) return false;
    char* end = nullptr;
    plan_limit = std::strtod(word + kFlag.size(), &end);
    if (*end != '\0' || end == word + kFlag.size()) plan_limit = 0;
    return true;
  });
  argc = static_cast<int>(last - argv);
  if (plan_limit > 0) return true;
  std::fprintf(stderr, "plan_benchmark: --plan_limit: allowed is a number of seconds above 0\n");
  return false;
}

void print_help() {
  benchmark::PrintDefaultHelp();
  std::printf(
      "          [--plan_limit=<seconds>]   rows of which a plan takes longer are not run (default "
      "60)\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (!take_plan_limit(argc, argv)) return 2;
  for (const Scene& scene : kScenes)
    for (int k = 0; k < scene.settings; ++k) {
      const bench::Setting& setting = bench::kSettings[k];
      for (const Case& what : cases(scene, k)) {
        const std::string label = label_of(scene, what, setting);
        benchmark::RegisterBenchmark(
            label.c_str(), [&, what](benchmark::State& state) { run(state, scene, what, setting); })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
      }
    }
  register_pads();
  for (const auto& [key, value] : bench::context()) benchmark::AddCustomContext(key, value);
  benchmark::Initialize(&argc, argv, print_help);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
