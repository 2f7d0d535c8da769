// SPDX-License-Identifier: BSD-3-Clause
// Measures how many plans a second are made of many problems of one robot that differ in where
// things are, by set of problems / way of planning / threads. An iteration plans all problems of a
// set.
//
//   batch_benchmark [--benchmark_filter=^seam/plan_many]
//
// Sets, each drawn by a fixed seed, SplitMix64 of it and of the problem's number:
//   doors      experiment C, whose door moves as its file says, and the path with it
//   obstacles  experiment C, whose post and rail move, while the path stays
//   starts     obstacles, from 16 given starts by turns
//   seam       the weld of panda_weld_seam: an arm along arcs; post and bottle move
//   pipe       the weld of kr6_weld_pipe: six joints and a roll; its post moves
//
// Ways, all with `lazy` and one thread for each plan but for the last:
//   plan       plan() of each problem, on a robot that is prepared
//   planner    a Planner for each thread, made at the begin of an iteration, by set_problem()
//   campaign   run_campaign(), of doors alone
//   plan_many  plan_many()
//   eager      plan() with `eager` of the first five problems, on one thread
//
// Clearance is asked of nodes alone, as `eager` would take minutes otherwise; answers are proved.
// plan_many() and campaigns measure the tool-path error, so all ways do. Time is that of all
// threads (cpu_time) and of the clock (real_time). Counters:
//   plans_per_cpu_s  plans in a second of processor time of all threads
//   plans_per_s      plans in a second of the clock
//   sleeps, faults   voluntary context switches and page faults without a disk, for each plan
//   solved           share of the problems that have a path
//
// The label of a row is a hash of all answers of its last iteration: of status, cost and joints, to
// the last bit. Each answer is compared with that of plan() with `lazy` on one thread. A row in
// which one differs is an error, and the program ends with 1; with 2 after bad input.
//
// Every argument of google-benchmark applies.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "context.hpp"
#include "swivel/core/base/fnv1a.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/io/io.hpp"
#include "swivel/parallel/executor.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/campaign.hpp"
#include "swivel/planner/study/plan_many.hpp"

namespace {

using namespace swivel;

constexpr std::uint64_t kSeed = 1;
constexpr double kMoved = 0.05;  // m: objects move by at most this along each axis
constexpr std::size_t kStarts = 16;
constexpr std::size_t kEagerPlans = 5;

bool unequal = false;  // an answer differed from that of plan()

/// Where the problems of a set come from.
struct Kind {
  const char* name;
  const char* file;
  std::size_t problems;  ///< how many
  /// Names of the objects that move by kMoved at most; empty where the file says what moves.
  std::array<std::string_view, 2> moved = {};
  bool starts = false;  ///< whether paths begin at given joints
  [[nodiscard]] bool moves_as_in_file() const { return moved.front().empty(); }
};
constexpr Kind kKinds[] = {
    {.name = "doors", .file = "experiment_c", .problems = 100},
    {.name = "obstacles", .file = "experiment_c", .problems = 100, .moved = {"post", "rail"}},
    {.name = "starts",
     .file = "experiment_c",
     .problems = 6 * kStarts,
     .moved = {"post", "rail"},
     .starts = true},
    {.name = "seam", .file = "panda_weld_seam", .problems = 30, .moved = {"post", "bottle"}},
    {.name = "pipe", .file = "kr6_weld_pipe", .problems = 30, .moved = {"post"}}};

/// What is kept of an answer, to compare it.
struct Kept {
  PlanStatus status = PlanStatus::kError;
  double cost = 0;
  std::vector<Config> joints;  ///< of all rows; none unless solved

  void keep(PlanStatus of_plan, double its_cost, const std::vector<TrajectoryRow>& rows) {
    status = of_plan;
    cost = its_cost;
    joints.clear();  // its memory stays, so that the next iteration takes none
    for (const TrajectoryRow& row : rows) joints.push_back(row.q);
  }
  void keep(const PlanResult& result) { keep(result.status, result.cost, result.trajectory); }
  void keep(const Answer& answer) { keep(answer.status, answer.cost, answer.arms.front().rows()); }
  /// Returns the FNV-1a checksum of everything, continued from that of the answers before.
  [[nodiscard]] std::uint64_t hash(std::uint64_t from = fnv1a("")) const {
    const auto add = [&from](const auto& value) {
      const auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
      from = fnv1a({bytes.data(), bytes.size()}, from);
    };
    add(static_cast<int>(status));
    add(cost);
    add(joints.size());
    for (const Config& q : joints)
      for (const double value : q.coordinates()) add(value);
    return from;
  }
};

/// The problems of one kind.
struct Set {
  PathProblem like;  ///< the problem of the file, of which the others are made
  std::shared_ptr<const PreparedRobot> robot;
  std::vector<PathProblem> problems;
  std::vector<std::uint64_t> expected;  ///< by problem: Kept::hash() of what plan() answers
  std::vector<Kept> kept;               ///< by problem, of the last iteration
};

PlanOptions options_of(PlannerKind planner, int threads) {
  PlanOptions options;
  options.planner = planner;
  options.threads = threads;
  options.evidence.tool_path_error = true;
  return options;
}

// --- ways to plan the first kept.size() problems of a set and to keep their answers

/// Calls plan_one(number, worker) for each number below `count`, on several threads; worker
/// is below `threads`.
void for_each_problem(std::size_t count, int threads,
                      const std::function<void(std::size_t, std::size_t)>& plan_one) {
  Executor executor(threads);
  // Numbers are counted, as plan_many() does, so that both plan in the same order.
  std::atomic<std::size_t> next = 0;
  executor.for_each(static_cast<int>(count),
                    [&](int, int worker) { plan_one(next++, static_cast<std::size_t>(worker)); });
}

void plan_each(PlannerKind planner, const Set& set, int threads, std::span<Kept> kept) {
  const PlanOptions options = options_of(planner, 1);
  for_each_problem(kept.size(), threads, [&](std::size_t number, std::size_t) {
    kept[number].keep(plan(*set.robot, set.problems[number], options));
  });
}

void by_plan(const Set& set, int threads, std::span<Kept> kept) {
  plan_each(PlannerKind::kLazy, set, threads, kept);
}

void by_eager(const Set& set, int threads, std::span<Kept> kept) {
  plan_each(PlannerKind::kEager, set, threads, kept);
}

void by_planner(const Set& set, int threads, std::span<Kept> kept) {
  const PlanOptions options = options_of(PlannerKind::kLazy, 1);
  std::vector<Planner> planners;
  for (int worker = 0; worker < threads; ++worker) planners.emplace_back(set.robot, set.like);
  for_each_problem(kept.size(), threads, [&](std::size_t number, std::size_t worker) {
    planners[worker].set_problem(set.problems[number]);
    kept[number].keep(planners[worker].plan(options));
  });
}

/// The set must be one whose problems are the episodes of its file.
void by_campaign(const Set& set, int threads, std::span<Kept> kept) {
  CampaignOptions options;
  options.episodes = kept.size();
  options.seed = kSeed;
  options.plan = options_of(PlannerKind::kLazy, threads);
  options.planned = [kept](std::uint64_t number, const Answer& answer) {
    kept[number].keep(answer);
  };
  run_campaign(*set.robot, set.like, options, [](const EpisodeRow&) {});
}

void by_plan_many(const Set& set, int threads, std::span<Kept> kept) {
  ManyOptions options;
  options.plan = options_of(PlannerKind::kLazy, threads);
  options.planned = [kept](std::uint64_t number, const Answer& answer) {
    kept[number].keep(answer);
  };
  plan_many(
      *set.robot, one_path(set.like), kept.size(),
      [&](std::uint64_t number) { return one_path(set.problems[number]); }, options,
      [](const EpisodeRow&) {});
}

struct Way {
  const char* name;
  void (*plan_all)(const Set& set, int threads, std::span<Kept> kept);
};
constexpr Way kEager = {"eager", by_eager};
constexpr Way kWays[] = {{"plan", by_plan}, {"planner", by_planner}, {"plan_many", by_plan_many}};
constexpr Way kCampaign = {"campaign", by_campaign};

// --- sets

/// Returns the problem of a kind's file, with what moves in `vary`.
PathProblem problem_of(const Kind& kind) {
  PathProblem problem = io::load_path_problem(std::filesystem::path(SWIVEL_DATA_DIR) / "problems" /
                                              (std::string(kind.file) + ".yaml"));
  problem.limits.edges = EdgeMode::kNodes;
  if (kind.moves_as_in_file()) return problem;
  problem.vary.clear();
  for (const std::string_view name : kind.moved)
    if (!name.empty())
      problem.vary.push_back({.object = std::string(name), .xyz = Vector3d::Constant(kMoved)});
  return problem;
}

/// Returns at least kStarts joint configurations in which the path of `like` may begin, and from
/// which it can be followed to its end: those among nodes spread over the first layer of its
/// lattice. Throws std::runtime_error if there are fewer.
std::vector<Config> starts_of(const PathProblem& like,
                              const std::shared_ptr<const PreparedRobot>& robot) {
  constexpr std::size_t kTries = 4 * kStarts;
  const PlanOptions options = options_of(PlannerKind::kLazy, 1);
  Planner planner(robot, like);
  static_cast<void>(planner.plan(options));  // makes the lattice
  std::vector<Lattice::Node> nodes;
  planner.view().lattice.layer_nodes(0, nodes);
  std::vector<Config> starts;
  PathProblem problem = like;
  for (std::size_t k = 0; k < nodes.size(); k += std::max<std::size_t>(1, nodes.size() / kTries)) {
    problem.start = nodes[k].q;
    if (plan(*robot, problem, options).status == PlanStatus::kSolved) starts.push_back(nodes[k].q);
  }
  if (starts.size() < kStarts) throw std::runtime_error("the path has too few starts");
  return starts;
}

/// Makes the problems of a kind, and plans each with plan().
std::unique_ptr<Set> made(const Kind& kind) {
  auto set = std::make_unique<Set>();
  set->like = problem_of(kind);
  set->robot = std::make_shared<const PreparedRobot>(set->like);
  for (std::uint64_t number = 0; number < kind.problems; ++number)
    set->problems.push_back(episode_problem(set->like, kSeed, number));
  if (kind.starts) {
    const std::vector<Config> starts = starts_of(set->like, set->robot);
    for (std::size_t number = 0; number < kind.problems; ++number)
      set->problems[number].start = starts[number % kStarts * starts.size() / kStarts];
  }
  set->kept.resize(kind.problems);
  by_plan(*set, 1, set->kept);
  for (const Kept& one : set->kept) set->expected.push_back(one.hash());
  return set;
}

/// Returns the set of a kind, which is made when it is asked for first.
Set& set_of(const Kind& kind) {
  static std::map<const Kind*, std::unique_ptr<Set>> all;
  std::unique_ptr<Set>& entry = all[&kind];
  if (!entry) entry = made(kind);
  return *entry;
}

// --- rows

/// What this process has used so far.
struct Usage {
  double cpu_s = 0;      ///< processor time of all threads, s
  long sleeps = 0;       ///< voluntary context switches
  long page_faults = 0;  ///< those that needed no disk
};

Usage usage() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return {static_cast<double>(std::clock()) / CLOCKS_PER_SEC, used.ru_nvcsw, used.ru_minflt};
}

/// Sets the counters of a row that planned so many problems in each of its iterations.
void set_counters(benchmark::State& state, std::span<const Kept> kept, const Usage& before,
                  const Usage& after) {
  const double plans = static_cast<double>(state.iterations()) * static_cast<double>(kept.size());
  const auto solved = std::count_if(
      kept.begin(), kept.end(), [](const Kept& one) { return one.status == PlanStatus::kSolved; });
  state.counters["problems"] = static_cast<double>(kept.size());
  state.counters["plans_per_cpu_s"] = plans / (after.cpu_s - before.cpu_s);
  state.counters["plans_per_s"] = benchmark::Counter(plans, benchmark::Counter::kIsRate);
  state.counters["sleeps"] = static_cast<double>(after.sleeps - before.sleeps) / plans;
  state.counters["faults"] = static_cast<double>(after.page_faults - before.page_faults) / plans;
  state.counters["solved"] = static_cast<double>(solved) / static_cast<double>(kept.size());
}

void run(benchmark::State& state, const Kind& kind, const Way& way, int threads,
         std::size_t problems) {
  Set& set = set_of(kind);
  const std::span<Kept> kept = std::span(set.kept).first(problems);
  const Usage before = usage();
  for (auto _ : state) {
    for (Kept& one : kept) one.status = PlanStatus::kError;  // until it has an answer
    way.plan_all(set, threads, kept);
  }
  const Usage after = usage();
  std::uint64_t hash = fnv1a("");
  for (std::size_t number = 0; number < problems; ++number) {
    if (kept[number].hash() != set.expected[number]) {
      unequal = true;
      state.SkipWithError(
          formatted("problem %zu: the answer is not that of plan()", number).c_str());
      return;
    }
    hash = kept[number].hash(hash);
  }
  set_counters(state, kept, before, after);
  state.SetLabel(formatted("answers %016llx", static_cast<unsigned long long>(hash)));
}

void register_row(const Kind& kind, const Way& way, int threads, std::size_t problems) {
  const std::string label = formatted("%s/%s/threads:%d", kind.name, way.name, threads);
  benchmark::RegisterBenchmark(label.c_str(),
                               [&kind, &way, threads, problems](benchmark::State& state) {
                                 run(state, kind, way, threads, problems);
                               })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

void register_rows() {
  const int most_threads = std::max(2, static_cast<int>(std::thread::hardware_concurrency()));
  for (const Kind& kind : kKinds) {
    for (int threads = 1; threads <= most_threads; threads *= 2) {
      for (const Way& way : kWays) register_row(kind, way, threads, kind.problems);
      if (kind.moves_as_in_file()) register_row(kind, kCampaign, threads, kind.problems);
    }
    register_row(kind, kEager, 1, kEagerPlans);
  }
}

}  // namespace

int main(int argc, char** argv) {
  register_rows();
  for (const auto& [key, value] : bench::context()) benchmark::AddCustomContext(key, value);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  try {
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "batch_benchmark: %s\n", error.what());
    return 2;
  }
  return unequal ? 1 : 0;
}
