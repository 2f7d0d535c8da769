// SPDX-License-Identifier: BSD-3-Clause
// A caller's own rules and costs on jobs, against a dense program over all nodes, edges and
// straight transitions, which asks FCL and the caller's functions one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <thread>

#include "random_jobs.hpp"
#include "seed.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "validity/collision_validity.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Refuses states on one side of a plane in joint space, and motions whose middle lies beyond
/// another. Notes the threads that call it.
class Plane final : public StateCheck {
 public:
  Plane(Config normal, double most, bool of_motions)
      : normal_(std::move(normal)), most_(most), of_motions_(of_motions) {}
  [[nodiscard]] std::string name() const override { return "plane"; }
  [[nodiscard]] bool allowed(const Config& q) const { return joint_dot(normal_, q) <= most_; }
  [[nodiscard]] bool allowed(const Config& from, const Config& to) const {
    return !of_motions_ || joint_dot(normal_, Config((from + to) / 2)) <= most_ - 0.002;
  }
  void states(std::span<const Config> states, std::span<bool> answers) override {
    other_threads += std::this_thread::get_id() != own_ ? 1 : 0;
    for (std::size_t k = 0; k < states.size(); ++k) answers[k] = allowed(states[k]);
  }
  [[nodiscard]] bool checks_motions() const override { return of_motions_; }
  void motions(std::span<const Motion> motions, std::span<bool> answers) override {
    for (std::size_t k = 0; k < motions.size(); ++k)
      answers[k] = allowed(motions[k].from, motions[k].to);
  }
  int other_threads = 0;

 private:
  Config normal_;
  double most_;
  bool of_motions_;
  std::thread::id own_ = std::this_thread::get_id();
};

/// Costs more the further the arm is from a configuration.
class Bowl final : public StateCost {
 public:
  explicit Bowl(Config middle) : middle_(std::move(middle)) {}
  [[nodiscard]] std::string name() const override { return "bowl"; }
  [[nodiscard]] double cost(const Config& q) const {
    return 0.05 * joint_norm(Config(q - middle_));
  }
  void costs(std::span<const Config> states, std::span<double> costs) override {
    for (std::size_t k = 0; k < states.size(); ++k) costs[k] = cost(states[k]);
  }

 private:
  Config middle_;
};

/// A dense program over a job without detours.
class DenseJob {
 public:
  DenseJob(const PreparedRobot& robot, const Problem& job, const Plane* plane, const Bowl* bowl)
      : robot_(robot), job_(job), plane_(plane), bowl_(bowl) {}

  /// Returns the cost of the cheapest job whose transitions are straight; kNone where there is
  /// none.
  double least() {
    std::vector<Config> ends;
    std::vector<double> values;
    if (job_.arm().home) {
      ends.push_back(*job_.arm().home);
      values.push_back(0);
    }
    for (std::size_t k = 0; k < job_.arm().strokes.size(); ++k) {
      run(problem_of_run(job_, {k, false}), ends, values);
      if (ends.empty()) return kNone;
    }
    if (!job_.arm().home) return *std::min_element(values.begin(), values.end());
    return best_to(*job_.arm().home, ends, values);
  }

 private:
  /// Returns the least value with which a configuration is reached by a straight transition.
  double best_to(const Config& to, const std::vector<Config>& ends,
                 const std::vector<double>& values) {
    std::vector<std::pair<double, std::size_t>> sorted;
    for (std::size_t k = 0; k < ends.size(); ++k)
      sorted.emplace_back(values[k] + joint_norm(Config(to - ends[k])), k);
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [value, k] : sorted)
      if (is_free(ends[k], to)) return value;
    return kNone;
  }
  bool is_free(const Config& from, const Config& to) {
    if (!world_) {
      PathProblem between = problem_of_run(job_, {0, false});
      between.limits = limits_of_transitions(job_);
      world_.emplace(robot_.world(), between);
      query_.emplace(*world_, DistanceProofs::kOff);
    }
    const Config move = to - from;
    double most = 0;
    for (const double part : move.coordinates()) most = std::max(most, std::abs(part));
    const int steps = std::max(1, static_cast<int>(std::ceil(most / 0.05)));
    for (int k = 0; plane_ && k <= steps; ++k) {
      const Config q = from + move * (static_cast<double>(k) / steps);
      if (!plane_->allowed(q)) return false;
      if (k > 0 && !plane_->allowed(from + move * (static_cast<double>(k - 1) / steps), q))
        return false;
    }
    return !edge_blocked(*query_, world_->edge_rule(robot_.radii()), from, to);
  }

  /// Replaces the ends reached so far, and what it costs to reach them, by those of a run.
  void run(const PathProblem& problem, std::vector<Config>& ends, std::vector<double>& values) {
    const ToolPath path = problem_path(problem, robot_.arm().chain);
    const auto lattice = make_lattice(robot_.arm().chain, robot_.arm_class(), path, problem);
    const World world(robot_.world(), problem);
    Executor alone(1);
    CollisionValidity validity(*lattice, world, world.edge_rule(robot_.radii()),
                               problem.limits.edges, DistanceProofs::kOff, alone, 0, {});
    const bool first = ends.empty();
    std::vector<Lattice::Node> before;
    std::vector<double> cost_before;
    for (int layer = 0; layer < lattice->layers(); ++layer) {
      std::vector<Lattice::Node> nodes = valid_nodes(*lattice, validity, layer);
      std::vector<double> costs;
      for (const Lattice::Node& node : nodes) {
        double least = kNone;
        if (layer == 0)
          least = first ? 0 : best_to(node.q, ends, values);
        else
          least = best_step(*lattice, validity, layer - 1, before, cost_before, node);
        costs.push_back(least + (bowl_ ? lattice->rounded_cost(bowl_->cost(node.q)) : 0));
      }
      before.clear();
      cost_before.clear();
      for (std::size_t k = 0; k < nodes.size(); ++k)
        if (costs[k] != kNone) before.push_back(nodes[k]), cost_before.push_back(costs[k]);
    }
    ends.clear();
    for (const Lattice::Node& node : before) ends.push_back(node.q);
    values = cost_before;
  }
  std::vector<Lattice::Node> valid_nodes(const Lattice& lattice, CollisionValidity& validity,
                                         int layer) {
    std::vector<Lattice::Node> nodes, valid;
    lattice.layer_nodes(layer, nodes);
    for (const Lattice::Node& node : nodes) {
      const NodeQuestion question{layer, node.slot, node.q};
      NodeAnswer answer;
      validity.nodes({&question, 1}, {&answer, 1});
      if (answer.valid && (!plane_ || plane_->allowed(node.q))) valid.push_back(node);
    }
    return valid;
  }
  double best_step(const Lattice& lattice, CollisionValidity& validity, int layer,
                   const std::vector<Lattice::Node>& before, const std::vector<double>& costs,
                   const Lattice::Node& node) {
    std::vector<std::pair<double, std::size_t>> sorted;
    std::vector<Lattice::SlotRun> runs;
    for (std::size_t k = 0; k < before.size(); ++k) {
      lattice.successors(layer, before[k].slot, runs);
      const Config delta = lattice.delta(before[k].q, node.q);
      const bool near = std::any_of(runs.begin(), runs.end(), [&](const Lattice::SlotRun& run) {
        return node.slot >= run.first && node.slot < run.last;
      });
      if (near && lattice.step_allowed(layer, delta))
        sorted.emplace_back(costs[k] + lattice.edge_cost(delta), k);
    }
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [value, k] : sorted) {
      const EdgeQuestion question{layer, before[k].slot, node.slot, before[k].q, node.q};
      std::uint8_t valid = 1;
      if (validity.asks_edges()) validity.edges({&question, 1}, {&valid, 1});
      if (valid != 0 && (!plane_ || plane_->allowed(before[k].q, node.q))) return value;
    }
    return kNone;
  }

  const PreparedRobot& robot_;
  const Problem& job_;
  const Plane* plane_;
  const Bowl* bowl_;
  std::optional<World> world_;
  std::optional<World::Query> query_;
};

/// Draws a small job of the door, each stroke with a coarse lattice.
Problem small_job(const JobCase& of, Random& random) {
  Problem job = of.episode(static_cast<std::uint64_t>(random.below(1000)));
  job.arm().order = StrokeOrder::kGiven;
  while (job.arm().strokes.size() > 2) job.arm().strokes.pop_back();
  if (random.coin()) job.arm().home.reset();
  for (Stroke& stroke : job.arm().strokes) {
    stroke.reversible = false;
    if (random.coin()) stroke.retract = Vector3d(0, 0, -0.03);
    stroke.resolution.ds = 0.06;
    stroke.resolution.dphi = 0.35;
    stroke.resolution.knot = 0;
    stroke.limits.joint_step = 1.0;
    stroke.limits.tool_path_error = 0.05;
  }
  return job;
}

/// Draws a plane that the cheapest job without it does not keep.
std::shared_ptr<Plane> random_plane(const Answer& without, Random& random) {
  Config normal = Config::Zero();
  for (int j = 0; j < kDof; ++j) normal[j] = random.uniform(-1, 1);
  double least = kNone, most = -kNone;
  for (const Part& part : without.arm().parts)
    for (const TrajectoryRow& row : part.rows) {
      least = std::min(least, joint_dot(normal, row.q));
      most = std::max(most, joint_dot(normal, row.q));
    }
  return std::make_shared<Plane>(normal, most - 0.12 * random.uniform(0, 1) * (most - least),
                                 random.coin());
}

void expect_kept(const Answer& found, const Plane& plane, const std::string& what) {
  for (const Part& part : found.arm().parts)
    for (std::size_t k = 0; k < part.rows.size(); ++k) {
      ASSERT_TRUE(plane.allowed(part.rows[k].q)) << what;
      if (part.run && k > 0) {
        ASSERT_TRUE(plane.allowed(part.rows[k - 1].q, part.rows[k].q)) << what;
      }
    }
}

TEST(JobHooks, FindTheCheapestJobThatKeepsThem) {
  Random random(seed("JobHooks"));
  const JobCase door("door_job.yaml");
  int solved = 0, equal = 0, dearer = 0, none = 0, around = 0;
  const int count = trials(100);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what = "trial " + std::to_string(trial);
    const Problem job = small_job(door, random);
    const Answer without = plan_job(door.robot, job);
    if (!without.has_rows()) continue;
    const auto plane = random.coin(0.8) ? random_plane(without, random) : nullptr;
    const auto bowl = !plane || random.coin()
                          ? std::make_shared<Bowl>(without.arm().parts.front().rows.front().q)
                          : nullptr;
    PlanOptions options;
    options.threads = 4;
    options.hooks = {plane, bowl};
    constexpr PlannerKind kKinds[] = {PlannerKind::kEager, PlannerKind::kEagerDp,
                                      PlannerKind::kLazy, PlannerKind::kParallel};
    options.planner = kKinds[trial % 4];
    const Answer found = plan_job(door.robot, job, options);
    if (plane) {
      ASSERT_EQ(plane->other_threads, 0) << what;
    }
    const double least = DenseJob(door.robot, job, plane.get(), bowl.get()).least();
    if (!found.has_rows()) {
      ASSERT_EQ(least, kNone) << what;
      ++none;
      continue;
    }
    ++solved;
    if (plane) expect_kept(found, *plane, what);
    if (HasFatalFailure()) return;
    const AnswerCheck check = check_job(door.robot, job, found.arm().parts);
    ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
    ASSERT_LE(found.cost, least + 1e-6) << what;
    const bool straight =
        std::all_of(found.arm().parts.begin(), found.arm().parts.end(),
                    [](const Part& part) { return part.run || part.rows.size() == 2; });
    around += !straight;
    if (straight && found.arm().transitions.searches == 0) {
      ASSERT_NEAR(found.cost, least, 1e-6) << what;
      ++equal;
    }
    dearer += found.cost > without.cost + 1e-9;
  }
  std::printf(
      "%d jobs, %d solved, %d equal to the dense program, %d dearer than without, %d with "
      "none, %d with ways around\n",
      count, solved, equal, dearer, none, around);
  EXPECT_GE(solved, at_least(40));
  EXPECT_GE(equal, at_least(25));
  EXPECT_GE(dearer, at_least(20));
}

/// Arms without an arm angle have nodes at knots, but not where their states cost something.
TEST(JobHooks, CostsOfStatesCountAtEveryLayerOfArmsAlongArcs) {
  const JobCase pipe("kr6_weld_pipe_job.yaml");
  const Answer without = plan_job(pipe.robot, pipe.job);
  ASSERT_TRUE(without.has_rows());
  const auto bowl = std::make_shared<Bowl>(without.arm().parts.front().rows.front().q);
  PlanOptions options;
  options.hooks.cost = bowl;
  const Answer found = plan_job(pipe.robot, pipe.job, options);
  ASSERT_TRUE(found.has_rows());
  const AnswerCheck check = check_job(pipe.robot, pipe.job, found.arm().parts);
  ASSERT_TRUE(check.passed) << check.failures.front();
  double states = 0;
  for (const Part& part : found.arm().parts) {
    if (!part.run) continue;
    for (const TrajectoryRow& row : part.rows) states += bowl->cost(row.q);
  }
  EXPECT_GT(states, 0);
  EXPECT_NEAR(found.cost, check.cost + states, 1e-6);
}

TEST(JobHooks, RefinedJobsKeepThem) {
  Random random(seed("JobHooks.Refined"));
  const JobCase door("door_job.yaml");
  int refined = 0;
  const int count = trials(12);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what = "trial " + std::to_string(trial);
    const Problem job = small_job(door, random);
    const Answer without = plan_job(door.robot, job);
    if (!without.has_rows()) continue;
    const auto plane = random_plane(without, random);
    PlanOptions options;
    options.hooks.check = plane;
    const Answer found = plan_job_motion(door.robot, job, options, true, {});
    if (!found.has_rows()) continue;
    refined += found.refined;
    expect_kept(found, *plane, what);
    if (HasFatalFailure()) return;
    options.hooks = {nullptr, std::make_shared<Bowl>(without.arm().parts.front().rows.front().q)};
    const Answer costly = plan_job_motion(door.robot, job, options, true, {});
    ASSERT_FALSE(costly.refined) << what;
    EXPECT_EQ(costly.refinement->runs.at(0).reason, "the caller's own cost is not refined");
  }
  std::printf("%d of %d jobs refined\n", refined, count);
  EXPECT_GE(refined, at_least(4));
}

TEST(JobHooks, AreRefusedByLineWhereTheyCannotHold) {
  Problem job = load("door_job.yaml");
  PlanOptions options;
  options.hooks.cost = std::make_shared<Bowl>(Config::Zero());
  job.arm().lift = LiftOffs{};
  EXPECT_THROW(static_cast<void>(plan_job(job, options)), InvalidArgument);
  job.arm().lift.reset();
  job.arm().strokes[0].closed = true;
  EXPECT_THROW(static_cast<void>(plan_job(job, options)), InvalidArgument);
}

}  // namespace
}  // namespace swivel
