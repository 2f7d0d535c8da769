// SPDX-License-Identifier: BSD-3-Clause
// Measures where the time of a plan goes on arms without an arm angle. It plans random straight
// paths of 0.5 m at 5 mm, without obstacles, on one thread with the planner `lazy`.
//
//   arc_benchmark [--count N] [--seed N] [--rounds N] PROBLEM.yaml...
//       default: 20 paths that are solved, seed 1, 3 rounds
//
// A problem gives robot, roll, limits and cost. A path begins at random joints within the limits
// and turns by at most 0.5 rad. For each path the round with the least whole time counts. Printed
// are medians over the paths, in ms of processor time: `arcs` is the time to make nodes, `sweep`
// that to compare every node with those of the next layer, at first and again where nodes were
// removed, `questions` that of validity, and `rest` what remains of the plan. The parts are shares
// of wall time. A hash of all rows shows whether answers changed.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace {

using namespace swivel;

constexpr double kLength = 0.5, kSpacing = 0.005, kLargestTurn = 0.5;  // m, m, rad

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53);
  }
  Vector3d direction() {
    const double z = uniform(-1, 1), turn = uniform(-kPi, kPi), r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
  }

 private:
  std::mt19937_64 engine_;
};

PathProblem random_problem(const PathProblem& base, const Chain& chain, Random& random) {
  PathProblem problem = base;
  problem.scene.clear();
  problem.vary.clear();
  problem.start.reset();
  problem.start_at.reset();
  problem.path_frame.clear();
  Config q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    q[j] = limit.continuous ? random.uniform(-kPi, kPi) : random.uniform(limit.lower, limit.upper);
  }
  const Pose tool = chain.tool(q);
  const Quaterniond first = Quaterniond(tool.linear()).normalized();
  const Eigen::AngleAxisd turn(random.uniform(0, kLargestTurn), random.direction());
  problem.waypoints = {{tool.translation(), first},
                       {tool.translation() + kLength * random.direction(),
                        (Quaterniond(turn) * first).normalized()}};
  problem.resolution.ds = kSpacing;
  return problem;
}

struct Times {
  std::map<std::string, double> ms;
  [[nodiscard]] double whole() const { return ms.at("whole"); }
};

Times timed(const PreparedRobot& robot, const PathProblem& problem, PlanResult& result) {
  PlanOptions options;
  options.check = false;  // the time of planning is measured
  options.planner = PlannerKind::kLazy;
  options.threads = 1;
  Times times;
  const Timeline timeline;
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t clock = std::clock();
  result = plan(robot, problem, options);
  const double processor = 1e3 * static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC;
  times.ms["whole"] =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const std::map<std::string, std::string> kParts = {{"arcs", "arcs"},
                                                     {"sweep", "sweep"},
                                                     {"repair", "sweep"},
                                                     {"nodes asked", "questions"},
                                                     {"edges asked", "questions"}};
  for (const auto& [span, part] : kParts) times.ms[part];
  double rest = times.ms["whole"];
  for (const Timeline::Event& event : timeline.events()) {
    const auto part = kParts.find(event.name);
    if (part == kParts.end()) continue;
    const double ms = 1e-6 * static_cast<double>(event.end_ns - event.begin_ns);
    times.ms[part->second] += ms;
    rest -= ms;
  }
  times.ms["rest"] = rest;
  const double busy = processor / times.whole();  // less than 1 if other programs run
  for (auto& [part, ms] : times.ms) ms *= busy;
  return times;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Options {
  std::uint64_t count = 20, seed = 1, rounds = 3;
  std::vector<std::string> files;
};

void run(const Options& options, const std::string& file) {
  constexpr std::uint64_t kMostTries = 1000;  // for each path asked for
  const PathProblem base = io::load_path_problem(file);
  const PreparedRobot robot(base);
  Random random(options.seed);
  std::map<std::string, std::vector<double>> parts;
  double nodes = 0;
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  std::uint64_t solved = 0, tries = 0;
  for (; solved < options.count && tries < kMostTries * options.count; ++tries) {
    const PathProblem problem = random_problem(base, robot.arm().chain, random);
    PlanResult result;
    Times best = timed(robot, problem, result);
    if (result.status != PlanStatus::kSolved) continue;
    for (std::uint64_t round = 1; round < options.rounds; ++round)
      if (Times times = timed(robot, problem, result); times.whole() < best.whole())
        best = std::move(times);
    for (const auto& [part, ms] : best.ms) parts[part].push_back(ms);
    nodes += static_cast<double>(result.lattice.nodes) / static_cast<double>(result.lattice.layers);
    for (const TrajectoryRow& row : result.trajectory)
      for (const double value : row.q.coordinates()) {
        std::array<unsigned char, sizeof value> bytes;
        std::memcpy(bytes.data(), &value, sizeof value);
        for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211u;
      }
    ++solved;
  }
  std::printf("%s: %llu of %llu paths", file.c_str(), static_cast<unsigned long long>(solved),
              static_cast<unsigned long long>(tries));
  if (solved > 0) {
    std::printf(", %.0f nodes a layer; ms: whole %.1f", nodes / static_cast<double>(solved),
                median(parts["whole"]));
    for (const char* part : {"arcs", "sweep", "questions", "rest"})
      std::printf(", %s %.1f", part, median(parts[part]));
    std::printf("; rows %016llx", static_cast<unsigned long long>(hash));
  }
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Where the time of a plan goes on arms without an arm angle: random straight paths without "
      "obstacles.",
      "arc_benchmark");
  app.add_option("problems", options.files, "problem files, for robot, roll, limits and cost")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--count", options.count, "paths that are solved, of each problem")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the random paths")->capture_default_str();
  app.add_option("--rounds", options.rounds, "plans of each path, of which the fastest counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  if (const auto code = bench::read_arguments(app, argc, argv)) return *code;
  try {
    for (const std::string& file : options.files) run(options, file);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
