// SPDX-License-Identifier: BSD-3-Clause
// Measures how much sooner `lazy` answers than `eager_dp` on random problems for the robots of the
// given problems: paths of two to five waypoints, up to four obstacles, some of them meshes, with
// and without a start, with random limits; feasible and not.
//
//   eager_ratios [--count N] [--first N] [--seed N] [--rounds N] PROBLEM.yaml...
//       default: 500 problems from the first on, three rounds
//
// Problems go through the robots one after the other. Robots are prepared before and one thread
// plans; the two planners alternate within a round, and medians of the rounds count. Measured are
// the time until the verdict, and that of the whole call, which for both planners explains in the
// same way why there is no path. Prints each problem on which the verdict of `lazy` comes later,
// and percentiles.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace {

using namespace swivel;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53);
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  bool coin(double p) { return uniform(0, 1) < p; }
  Vector3d direction() {
    const double z = uniform(-1, 1), turn = uniform(-kPi, kPi), r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
  }

 private:
  std::mt19937_64 engine_;
};

/// Returns a ball of 1,200 triangles, dented so that it is not convex.
MeshPtr dented_ball(double radius) {
  constexpr int kRings = 25, kSides = 25;
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->source = "dented ball";
  mesh->vertices = {Vector3d(0, 0, radius), Vector3d(0, 0, -radius)};
  for (int i = 1; i < kRings; ++i)
    for (int j = 0; j < kSides; ++j) {
      const double a = kPi * i / kRings, b = kTwoPi * j / kSides,
                   r = radius * (1 - 0.2 * std::sin(a) * std::cos(3 * b));
      mesh->vertices.emplace_back(r * std::sin(a) * std::cos(b), r * std::sin(a) * std::sin(b),
                                  r * std::cos(a));
    }
  const auto at = [](int ring, int side) { return 2 + (ring - 1) * kSides + side % kSides; };
  for (int j = 0; j < kSides; ++j) {
    mesh->triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh->triangles.push_back({1, at(kRings - 1, j + 1), at(kRings - 1, j)});
    for (int i = 1; i + 1 < kRings; ++i) {
      mesh->triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh->triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  mesh->closed = true;
  return mesh;
}

Shape random_shape(Random& random) {
  const double size = random.uniform(0.02, 0.15);
  switch (random.below(5)) {
    case 0:
      return Sphere{size};
    case 1:
      return Box{Vector3d(size, 2 * size, size)};
    case 2:
      return Cylinder{size / 2, 3 * size};
    case 3:
      return Capsule{size / 2, 2 * size};
    default:
      return dented_ball(size);
  }
}

PathProblem random_problem(const PathProblem& robot, const Chain& chain, Random& random) {
  PathProblem problem = robot;
  problem.scene.clear();
  problem.vary.clear();
  problem.waypoints.clear();
  problem.start.reset();
  problem.start_at.reset();
  problem.path_frame.clear();
  Config q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    q[j] = limit.continuous ? random.uniform(-kPi, kPi)
                            : random.uniform(0.9 * limit.lower, 0.9 * limit.upper);
  }
  const Config first = q;
  const auto add_waypoint = [&] {
    const Pose tool = chain.tool(q);
    problem.waypoints.push_back({tool.translation(), Quaterniond(tool.linear()).normalized()});
  };
  add_waypoint();
  for (int more = 1 + random.below(4); more > 0; --more) {
    for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.25, 0.25);
    add_waypoint();
  }
  const Vector3d elbow = chain.displacements(first)[4] * chain.point[4],
                 tool = problem.waypoints[0].position;
  for (int k = random.below(5); k > 0; --k) {
    SceneObject object{"obstacle" + std::to_string(k), random_shape(random), Pose::Identity(), {}};
    object.pose.translation() =
        (k % 2 ? elbow : tool) + random.uniform(0.05, 0.45) * random.direction();
    object.pose.linear() =
        Eigen::AngleAxisd(random.uniform(-kPi, kPi), random.direction()).toRotationMatrix();
    problem.scene.push_back(object);
  }
  problem.resolution.ds = std::array{0.005, 0.01, 0.02}[static_cast<std::size_t>(random.below(3))];
  problem.resolution.dphi = std::array{0.05, 0.1, 0.2}[static_cast<std::size_t>(random.below(3))];
  Limits& limits = problem.limits;
  limits.clearance = random.uniform(0, 0.02);
  limits.tool_path_error =
      random.coin(0.5) ? std::optional(random.uniform(0.0005, 0.005)) : std::nullopt;
  limits.step_error = random.coin(0.2) ? std::optional(random.uniform(0.05, 0.5)) : std::nullopt;
  limits.manipulability = random.coin(0.3) ? random.uniform(0, 0.03) : 0;
  limits.edges = random.coin(0.5) ? EdgeMode::kContinuous : EdgeMode::kNodes;
  if (random.coin(0.3)) problem.start = first;
  return problem;
}

/// Times of one planner, by round.
struct Times {
  std::vector<double> verdict, whole;  // ms
};
PlanResult timed(const PreparedRobot& robot, const PathProblem& problem, PlannerKind planner,
                 Times& times) {
  PlanOptions options;
  options.check = false;  // the time of planning is measured
  options.planner = planner;
  options.threads = 1;
  const auto start = std::chrono::steady_clock::now();
  PlanResult result = plan(robot, problem, options);
  times.whole.push_back(
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  times.verdict.push_back(result.time_ms.at("plan"));
  return result;
}
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void print(const char* what, std::vector<double> ratios) {
  std::sort(ratios.begin(), ratios.end());
  const auto share = [&](double of) {
    return ratios[static_cast<std::size_t>(of * static_cast<double>(ratios.size() - 1))];
  };
  std::printf("eager_dp over lazy, %s: least %.2f, 5 %% %.2f, median %.1f, 95 %% %.1f\n", what,
              share(0), share(0.05), share(0.5), share(0.95));
}

struct Options {
  std::uint64_t count = 500, first = 0, seed = 1, rounds = 3;
  std::vector<std::string> files;
};

void run(const Options& options) {
  std::vector<PathProblem> problems;
  std::vector<PreparedRobot> robots;
  for (const std::string& file : options.files) {
    problems.push_back(io::load_path_problem(file));
    robots.emplace_back(problems.back());
  }
  std::vector<double> verdict, whole;
  int solved = 0, unequal = 0, slower = 0;
  for (std::uint64_t k = options.first; k < options.first + options.count; ++k) {
    const std::size_t which = k % robots.size();
    Random random(options.seed * 1'000'003 + k);
    const PathProblem problem = random_problem(problems[which], robots[which].arm().chain, random);
    Times lazy, eager;
    bool equal = true, found = false;
    for (std::uint64_t round = 0; round < options.rounds; ++round) {
      const PlanResult a = timed(robots[which], problem, PlannerKind::kLazy, lazy);
      const PlanResult b = timed(robots[which], problem, PlannerKind::kEagerDp, eager);
      found = a.status == PlanStatus::kSolved;
      equal = equal && a.status == b.status && (!found || a.cost == b.cost);
    }
    solved += found;
    unequal += !equal;
    verdict.push_back(median(eager.verdict) / median(lazy.verdict));
    whole.push_back(median(eager.whole) / median(lazy.whole));
    if (verdict.back() >= 1 && equal) continue;
    slower += verdict.back() < 1;
    std::printf("%llu %s: %s, lazy %.3f ms, eager_dp %.3f ms%s\n",
                static_cast<unsigned long long>(k), options.files[which].c_str(),
                found ? "solved" : "no path", median(lazy.verdict), median(eager.verdict),
                equal ? "" : ": answers differ");
    std::fflush(stdout);
  }
  if (verdict.empty()) return;
  std::printf(
      "%zu problems of %zu robots, %d solved, %d with unlike answers, the verdict of lazy later on "
      "%d\n",
      verdict.size(), robots.size(), solved, unequal, slower);
  print("verdict", verdict);
  print("whole call", whole);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "How much sooner `lazy` answers than `eager_dp` on random problems of the robots that the "
      "given problems have.",
      "eager_ratios");
  app.add_option("problems", options.files, "problem files, for their robots")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--count", options.count, "random problems, robots one after the other")
      ->capture_default_str();
  app.add_option("--first", options.first, "number of the first random problem")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the random problems")->capture_default_str();
  app.add_option("--rounds", options.rounds, "plans of each, of which the median counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  if (const auto code = bench::read_arguments(app, argc, argv)) return *code;
  try {
    run(options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
