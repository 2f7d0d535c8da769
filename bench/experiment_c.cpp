// SPDX-License-Identifier: BSD-3-Clause
// Experiment C of the paper: the door at random poses, by every method of Table I and by the
// planners that the paper has not.
//   experiment_c OUT.json [EPISODES]
// EPISODES defaults to 100. All methods run one after the other on each episode.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "baselines.hpp"
#ifdef SWIVEL_OMPL
#include "constrained_sampling.hpp"
#endif
#include "arguments.hpp"
#include "context.hpp"
#include "settings.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"

namespace {

using namespace swivel;
using nlohmann::json;

constexpr std::uint64_t kSeed = 1;
// OMPL's planners use up their time on most episodes, so they get the first of them only.
[[maybe_unused]] constexpr std::uint64_t kSampledEpisodes = 20;
[[maybe_unused]] constexpr double kSampledSeconds = 2;

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// One row of the table over all episodes.
struct Method {
  std::string name, setting;
  int threads = 1;
  EdgeMode edges = EdgeMode::kNodes;
  json episodes = json::array();
};

json to_json(const PlanResult& result, const PathProblem& problem) {
  const EpisodeRow row(0, answer_of(result), one_path(problem));
  json answer{{"status", to_string(result.status)}, {"ms", row.plan_ms},
              {"nodes", result.lattice.nodes},      {"reason", row.reason},
              {"fcl_calls", row.fcl_calls},         {"nodes_checked", row.nodes_checked}};
  if (row.tool_path_error_mm_mean) answer["error_mm"] = *row.tool_path_error_mm_mean;
  if (row.tool_path_error_mm_max) answer["error_max_mm"] = *row.tool_path_error_mm_max;
  return answer;
}

PlanResult plan_at(const PreparedRobot& robot, PathProblem problem, PlannerKind planner,
                   const bench::Setting& setting, EdgeMode edges, int threads) {
  bench::set_resolution(problem, setting);
  problem.limits.edges = edges;
  PlanOptions options;
  options.check = false;  // the time of planning is measured
  options.planner = planner;
  options.threads = threads;
  options.evidence = {.tool_path_error = true};
  return plan(robot, problem, options);
}

/// The first valid node of layer 0 in (branch, j) order at #4; none where there is none.
std::optional<Config> first_start(const PreparedRobot& robot, PathProblem problem) {
  bench::set_resolution(problem, bench::kSettings[3]);
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const SrsLattice lattice(robot.arm().chain, robot.srs(), path, problem);
  const World world(robot.world(), problem);
  World::Query query(world);
  for (int slot = 0; slot < lattice.width(); ++slot) {
    const auto q = lattice.exact_config(0, slot);
    if (q && lattice.manipulable(*q) && !query.find_violating_pair(*q, ClearanceRule::kNode))
      return q;
  }
  return std::nullopt;
}

/// What a local method did; `possible`: a path from its start exists at #4.
json to_json(const baselines::TrackResult& result, double ms, const PreparedRobot& robot,
             const PathProblem& problem, bool possible) {
  json answer{{"status", result.finished ? "solved" : "failed"},
              {"ms", ms},
              {"s", result.s},
              {"possible_from_start", possible}};
  answer["reason"] = result.finished ? "" : std::string(baselines::to_string(result.reason));
  answer["blocking"] = result.blocking;
  if (!result.finished) return answer;
  const baselines::TrackOptions options;
  const ToolPath path(waypoints_in_base(problem),
                      Resolution{.ds = options.step, .dalpha = options.turn_step}, problem.source);
  double sum = 0, most = 0;
  for (int i = 0; i + 1 < path.size(); ++i) {
    const Config& q = result.rows[static_cast<std::size_t>(i)];
    for (const double error : path_deviation(robot.arm().chain, path, i, q,
                                             result.rows[static_cast<std::size_t>(i) + 1] - q)) {
      sum += 1e3 * error;
      most = std::max(most, 1e3 * error);
    }
  }
  answer["error_mm"] = sum / (3.0 * (path.size() - 1));
  answer["error_max_mm"] = most;
  return answer;
}

template <class Track>
json track(const PreparedRobot& robot, const PathProblem& problem, bool possible,
           const Track& tracker) {
  if (!problem.start)
    return {{"status", "failed"}, {"reason", "no start"}, {"possible_from_start", false}};
  const auto begin = std::chrono::steady_clock::now();
  const baselines::TrackResult result = tracker(robot, problem);
  return to_json(result, ms_since(begin), robot, problem, possible);
}

#ifdef SWIVEL_OMPL
json sample(const PreparedRobot& robot, const PathProblem& problem, bool possible,
            baselines::Manifold manifold) {
  if (!problem.start)
    return {{"status", "failed"}, {"reason", "no start"}, {"possible_from_start", false}};
  const baselines::ConstrainedResult result =
      baselines::plan_constrained(robot, problem, manifold, kSampledSeconds);
  json answer{{"status", result.finished ? "solved" : "failed"},
              {"ms", result.ms},
              {"reason", result.reason},
              {"connected", result.connected},
              {"possible_from_start", possible}};
  if (result.finished)
    answer["error_mm"] = result.error_mm, answer["error_max_mm"] = result.error_max_mm;
  return answer;
}
#endif

/// Lists the rows of the table for the planners: each planner at each of its settings.
std::vector<Method> planned_methods() {
  std::vector<Method> planned;
  const bench::Setting* const settings = bench::kSettings;
  for (const PlannerKind planner :
       {PlannerKind::kEager, PlannerKind::kEagerDp, PlannerKind::kLazy, PlannerKind::kParallel})
    for (std::size_t k = 0; k < std::size(bench::kSettings); ++k)
      if (planner == PlannerKind::kLazy || k < bench::kPaperSettings)
        planned.push_back({.name = to_string(planner),
                           .setting = settings[k].name,
                           .threads = planner == PlannerKind::kParallel ? 2 : 1});
  for (const PlannerKind planner : {PlannerKind::kLazy, PlannerKind::kParallel})
    planned.push_back({.name = to_string(planner),
                       .setting = "#4",
                       .threads = planner == PlannerKind::kParallel ? 2 : 1,
                       .edges = EdgeMode::kContinuous});
  return planned;
}

/// The rows of the table whose methods begin at a start of their own.
struct StartedMethods {
  Method jacobian{.name = "jacobian", .setting = ""},
      null_space{.name = "null_space", .setting = ""};
  Method projected{.name = "ompl_projected", .setting = ""},
      tangent_bundle{.name = "ompl_tangent_bundle", .setting = ""};
};

/// Plans an episode by each method and appends what it found.
void run_planned(const PreparedRobot& robot, const PathProblem& problem,
                 std::vector<Method>& planned) {
  for (Method& method : planned) {
    const auto* const setting =
        std::find_if(std::begin(bench::kSettings), std::end(bench::kSettings),
                     [&](const bench::Setting& s) { return s.name == method.setting; });
    method.episodes.push_back(to_json(plan_at(robot, problem, planner_from_string(method.name),
                                              *setting, method.edges, method.threads),
                                      problem));
  }
}

/// Runs episode k by each method that begins at a start, and appends what it did.
void run_started(const PreparedRobot& robot, const PathProblem& problem,
                 [[maybe_unused]] std::uint64_t k, StartedMethods& methods) {
  PathProblem started = problem;
  started.start = first_start(robot, problem);
  const bool possible = started.start && plan_at(robot, started, PlannerKind::kLazy,
                                                 bench::kSettings[3], EdgeMode::kNodes, 1)
                                                 .status == PlanStatus::kSolved;
  methods.jacobian.episodes.push_back(
      track(robot, started, possible,
            [](const auto& r, const auto& p) { return baselines::track_jacobian(r, p); }));
  methods.null_space.episodes.push_back(
      track(robot, started, possible,
            [](const auto& r, const auto& p) { return baselines::track_null_space(r, p); }));
#ifdef SWIVEL_OMPL
  if (k < kSampledEpisodes) {
    methods.projected.episodes.push_back(
        sample(robot, started, possible, baselines::Manifold::kProjected));
    methods.tangent_bundle.episodes.push_back(
        sample(robot, started, possible, baselines::Manifold::kTangentBundle));
  }
#endif
}

json run(const PathProblem& base, std::uint64_t episodes) {
  const PreparedRobot robot(base);
  std::vector<Method> planned = planned_methods();
  StartedMethods started;
  for (std::uint64_t k = 0; k < episodes; ++k) {
    const PathProblem problem = episode_problem(base, kSeed, k);
    run_planned(robot, problem, planned);
    run_started(robot, problem, k, started);
    std::fprintf(stderr, "\repisode %llu of %llu", static_cast<unsigned long long>(k + 1),
                 static_cast<unsigned long long>(episodes));
  }
  std::fprintf(stderr, "\n");
  planned.insert(planned.begin(),
                 {std::move(started.jacobian), std::move(started.null_space),
                  std::move(started.projected), std::move(started.tangent_bundle)});
  json rows = json::array();
  for (const Method& method : planned)
    rows.push_back({{"method", method.name},
                    {"setting", method.setting},
                    {"threads", method.threads},
                    {"edges", method.edges == EdgeMode::kNodes ? "nodes" : "continuous"},
                    {"episodes", method.episodes}});
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  std::string file;
  std::uint64_t episodes = 100;
  CLI::App app(
      "Experiment C of the paper: the door at random poses, by every method of Table I and by the "
      "planners of this project.",
      "experiment_c");
  app.add_option("out", file, "file for the results, JSON")->required();
  app.add_option("episodes", episodes, "random poses")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  if (const auto code = bench::read_arguments(app, argc, argv)) return *code;
  try {
    json out;
    for (const auto& [key, value] : bench::context()) out["context"][key] = value;
    out["seed"] = kSeed;
    out["rows"] = run(io::load_path_problem(std::filesystem::path(SWIVEL_DATA_DIR) /
                                            "problems/experiment_c.yaml"),
                      episodes);
    io::write_file(file, out.dump(1) + "\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "experiment_c: %s\n", error.what());
    return 2;
  }
  return 0;
}
