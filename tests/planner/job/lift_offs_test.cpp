// SPDX-License-Identifier: BSD-3-Clause
// Strokes that no single run finishes: the least number of lift-offs and their places, against
// plain programs over all cuts of a lattice whose nodes and edges are all asked about one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "plan/layout/told_turns.hpp"
#include "robots.hpp"
#include "seed.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "validity/collision_validity.hpp"

namespace swivel {
namespace {

using namespace test;

Problem bench() {
  return io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/iiwa14_bench_job.yaml");
}

/// Returns a stroke of some turns about a round boss, in its frame: the tool is tilted and turns
/// with the ring, so that the wrist has to turn as often.
Stroke ring(const Stroke& like, double turns, double radius, double tilt, double height) {
  Stroke stroke = like;
  stroke.name = "ring";
  stroke.reversible = false;
  stroke.approach.setZero();
  stroke.retract.setZero();
  stroke.waypoints.clear();
  const int steps = static_cast<int>(std::ceil(turns * 15));
  for (int k = 0; k <= steps; ++k) {
    const double angle = kTwoPi * turns * k / steps;
    Waypoint waypoint;
    waypoint.position = {radius * std::cos(angle), radius * std::sin(angle), height};
    waypoint.orientation = Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ()) *
                                       Eigen::AngleAxisd(kPi, Vector3d::UnitX()) *
                                       Eigen::AngleAxisd(-tilt, Vector3d::UnitY()));
    stroke.waypoints.push_back(waypoint);
  }
  return stroke;
}

/// Returns a job of one ring, coarse, with the last joint's range and the ring drawn. The scene is
/// a bench, and a post beside the ring in some.
Problem random_ring(const Problem& like, Random& random, double most_turns) {
  Problem job = like;
  auto model = std::make_shared<RobotModel>(*like.arm().model);
  Joint& last = model->joints[static_cast<std::size_t>(model->find_joint("joint_a7"))];
  last.upper = random.coin() ? random.uniform(2.4, 3.05) : random.uniform(1.3, 2.4);
  last.lower = -last.upper;
  job.arm().model = model;
  job.scene.clear();
  for (const SceneObject& object : like.scene)
    if (object.name == "bench" || object.name == "casting") job.scene.push_back(object);
  if (random.coin(0.4))
    for (const SceneObject& object : like.scene)
      if (object.name == "lamp") {
        job.scene.push_back(object);
        job.scene.back().pose.translation() =
            Vector3d(random.uniform(0.3, 0.45), random.uniform(-0.35, 0.35), 0.45);
      }
  job.arm().strokes = {ring(like.arm().strokes.front(), random.uniform(0.6, most_turns),
                            random.uniform(0.05, 0.1), random.uniform(0.1, 0.5),
                            random.uniform(0.1, 0.2))};
  Stroke& stroke = job.arm().strokes.front();
  stroke.resolution.ds = 0.04;
  stroke.resolution.dphi = 0.2;
  stroke.resolution.dalpha = 0.5;
  stroke.limits.tool_path_error.reset();
  stroke.limits.clearance = 0.002;
  stroke.limits.edges = EdgeMode::kNodes;
  job.arm().home.reset();
  job.arm().order = StrokeOrder::kGiven;
  job.arm().lift = LiftOffs{random.coin() ? 1.5 : 0.0, random.coin() ? 0.03 : 0.0};
  return job;
}

PlanOptions with_check() {
  PlanOptions options;
  options.check = true;
  return options;
}

/// Every node and edge of the lattice of a job's only stroke, each asked about by itself.
class Plain {
 public:
  Plain(const PreparedRobot& robot, const Problem& job)
      : problem_(problem_of_run(job, {0, false})),
        world_(robot.world(), problem_),
        path_(problem_path(problem_, robot.arm().chain)),
        lattice_(with_all_windings(
            make_lattice(robot.arm().chain, robot.arm_class(), path_, problem_))) {
    Executor alone(1);
    CollisionValidity validity(*lattice_, world_, world_.edge_rule(robot.radii()),
                               problem_.limits.edges, DistanceProofs::kOff, alone, 1, {});
    nodes_.resize(static_cast<std::size_t>(path_.size()));
    for (int i = 0; i < path_.size(); ++i)
      for (int slot = 0; slot < lattice_->slots(i); ++slot) {
        const auto q = lattice_->node(i, slot);
        if (!q) continue;
        const NodeQuestion question{i, slot, *q};
        NodeAnswer answer;
        validity.nodes({&question, 1}, {&answer, 1});
        if (answer.valid) nodes_[static_cast<std::size_t>(i)].push_back({slot, *q});
      }
    edges_.resize(nodes_.size());
    for (std::size_t i = 0; i + 1 < nodes_.size(); ++i)
      for (std::size_t a = 0; a < nodes_[i].size(); ++a)
        for (std::size_t b = 0; b < nodes_[i + 1].size(); ++b) {
          const auto layer = static_cast<int>(i);
          const Lattice::Node &from = nodes_[i][a], &to = nodes_[i + 1][b];
          if (!lattice_->in_window(layer, from.slot, to.slot)) continue;
          if (!lattice_->step_allowed(layer, lattice_->delta(from.q, to.q))) continue;
          const EdgeQuestion question{layer, from.slot, to.slot, from.q, to.q};
          std::uint8_t valid = 1;
          if (validity.asks_edges()) validity.edges({&question, 1}, {&valid, 1});
          if (valid != 0) edges_[i].push_back({a, b});
        }
  }

  [[nodiscard]] int layers() const { return path_.size(); }
  [[nodiscard]] double s(int layer) const { return path_.layer(layer).s; }
  /// Returns the layer at which the run after one that ends at `layer` begins.
  [[nodiscard]] int resumed(int layer, double overlap) const {
    int begin = layer;
    while (begin > 0 && s(begin) > s(layer) - overlap + 1e-9) --begin;
    return begin;
  }
  /// Returns the furthest layer that a run from a layer reaches; -1 if it has no node.
  [[nodiscard]] int reach(int begin) const {
    std::vector<std::uint8_t> now(nodes_[static_cast<std::size_t>(begin)].size(), 1);
    if (now.empty()) return -1;
    for (int i = begin; i + 1 < layers(); ++i) {
      std::vector<std::uint8_t> next(nodes_[static_cast<std::size_t>(i) + 1].size(), 0);
      bool any = false;
      for (const auto& [a, b] : edges_[static_cast<std::size_t>(i)])
        if (now[a] != 0) next[b] = any = true;
      if (!any) return i;
      now = next;
    }
    return layers() - 1;
  }
  /// Returns the least number of runs over all cuts; none where no number suffices.
  [[nodiscard]] std::optional<int> least_runs(double overlap) const {
    std::vector<int> reach_of;
    for (int i = 0; i < layers(); ++i) reach_of.push_back(reach(i));
    std::vector<std::uint8_t> ends(static_cast<std::size_t>(layers()), 0);  // of the runs so far
    std::vector<std::uint8_t> begins(static_cast<std::size_t>(layers()), 0);
    begins[0] = 1;
    for (int runs = 1; runs <= layers(); ++runs) {
      for (int i = 0; i < layers(); ++i)
        for (int j = i + 1;
             begins[static_cast<std::size_t>(i)] != 0 && j <= reach_of[static_cast<std::size_t>(i)];
             ++j)
          ends[static_cast<std::size_t>(j)] = 1;
      if (ends.back() != 0) return runs;
      for (int j = 1; j + 1 < layers(); ++j)
        if (ends[static_cast<std::size_t>(j)] != 0)
          begins[static_cast<std::size_t>(resumed(j, overlap))] = 1;
    }
    return std::nullopt;
  }

 private:
  PathProblem problem_;
  World world_;
  ToolPath path_;
  std::shared_ptr<Lattice> lattice_;
  std::vector<std::vector<Lattice::Node>> nodes_;
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> edges_;
};

// The least number of runs is that of a plain program over all cuts; the answer passes its own
// check, its runs overlap as asked, and each begins where the one before ended or before it.
TEST(LiftOffs, LeastNumberAgainstAllCuts) {
  Random random(seed("LiftOffs.LeastNumberAgainstAllCuts"));
  const Problem like = bench();
  const int count = trials(100);
  int one = 0, two = 0, more = 0, none = 0;
  for (int trial = 0; one + two + more < count && trial < 4 * count; ++trial) {
    const Problem job = random_ring(like, random, trial % 2 == 0 ? 1.4 : 2.6);
    const PreparedRobot robot(problem_of_run(job, {0, false}));
    const Plain plain(robot, job);
    const auto least = plain.least_runs(job.arm().lift->overlap);
    const Answer found = plan_job(robot, job, with_check());
    SCOPED_TRACE("trial " + std::to_string(trial));
    if (!least) {
      ++none;
      EXPECT_EQ(found.status, PlanStatus::kInfeasible);
      continue;
    }
    ++(*least == 1 ? one : *least == 2 ? two : more);
    ASSERT_EQ(found.status, PlanStatus::kSolved);
    ASSERT_EQ(static_cast<int>(found.arm().lift_offs.size()) + 1, *least);
    EXPECT_TRUE(found.checked);
    const Problem executed = executed_problem(job, found);
    const AnswerCheck check = check_job(robot, executed, found.arm().parts);
    EXPECT_TRUE(check.passed);
    EXPECT_NEAR(check.cost, found.cost, 1e-6 * found.cost);
    for (const LiftOffAnswer& lift : found.arm().lift_offs) {
      EXPECT_LE(lift.resumed, std::max(0.0, lift.end - job.arm().lift->overlap) + 1e-9);
      EXPECT_GE(lift.reached, lift.end - 1e-9);
    }
  }
  std::printf("%d with one run, %d with two, %d with three and more; %d impossible in any number\n",
              one, two, more, none);
  EXPECT_GE(one + two + more, count);
  EXPECT_GE(more, at_least(30));
}

/// Returns the least cost of a job of one stroke over all places of a number of lift-offs.
double best_of_all_places(const PreparedRobot& robot, const Problem& job, const Plain& plain,
                          int lift_offs, int& tried) {
  double least = std::numeric_limits<double>::infinity();
  std::vector<int> ends;
  const std::function<void(int)> add = [&](int begin) {
    if (static_cast<int>(ends.size()) == lift_offs) {
      if (plain.reach(begin) + 1 < plain.layers()) return;
      std::vector<LiftOff> places;
      for (const int end : ends)
        places.push_back({0, plain.s(end), plain.s(plain.resumed(end, job.arm().lift->overlap))});
      const Answer found = plan_job(robot, with_lift_offs(job, places));
      ++tried;
      if (!found.arm().parts.empty()) least = std::min(least, found.cost);
      return;
    }
    for (int end = std::max(begin + 1, ends.empty() ? 1 : ends.back() + 1);
         end <= plain.reach(begin) && end + 1 < plain.layers(); ++end) {
      ends.push_back(end);
      add(plain.resumed(end, job.arm().lift->overlap));
      ends.pop_back();
    }
  };
  add(0);
  return least;
}

// Places cost as little as the best of all places with as many lift-offs, each planned as a job of
// its own, where moves are straight; at most five per cent more where they lead around something,
// and in rare cases of nodes at limits that a line has and a run has not.
TEST(LiftOffs, PlacesAgainstAllPlaces) {
  Random random(seed("LiftOffs.PlacesAgainstAllPlaces"));
  const Problem like = bench();
  const int count = trials(24);
  int two = 0, more = 0, tried = 0, homes = 0, lines = 0, straights = 0, exact = 0;
  double worst = 1;
  for (int trial = 0; two + more < count && trial < 10 * count; ++trial) {
    Problem job = random_ring(like, random, trial % 4 == 0 ? 2.2 : 1.4);
    const PreparedRobot robot(problem_of_run(job, {0, false}));
    const Plain plain(robot, job);
    const auto runs = plain.least_runs(job.arm().lift->overlap);
    if (!runs || *runs < 2 || *runs > 3) continue;
    if (random.coin()) job.arm().home = like.arm().home, ++homes;
    if (random.coin()) {
      Stroke& stroke = job.arm().strokes.front();
      stroke.approach = Vector3d(0, 0, random.coin() ? -random.uniform(0.02, 0.06) : 0.0);
      stroke.retract = Vector3d(0, 0, random.coin() ? -random.uniform(0.02, 0.06) : 0.0);
      ++lines;
    }
    ++(*runs == 2 ? two : more);
    const Answer found = plan_job(robot, job);
    SCOPED_TRACE("trial " + std::to_string(trial));
    if (found.status != PlanStatus::kSolved) {  // a line at the stroke's own end may be barred
      ASSERT_FALSE(job.arm().strokes.front().approach.isZero(0) &&
                   job.arm().strokes.front().retract.isZero(0));
      continue;
    }
    if (static_cast<int>(found.arm().lift_offs.size()) + 1 != *runs) continue;  // lines need more
    const double lifts = job.arm().lift->cost * (*runs - 1);
    const double best = best_of_all_places(robot, job, plain, *runs - 1, tried) + lifts;
    const bool straight =
        std::all_of(found.arm().parts.begin(), found.arm().parts.end(),
                    [](const Part& part) { return part.run || part.rows.size() <= 2; });
    straights += straight;
    exact += straight && found.cost <= (1 + 1e-9) * best;
    EXPECT_LE(found.cost, (straight ? 1.01 : 1.05) * best);
    worst = std::max(worst, found.cost / best);
  }
  std::printf(
      "%d with two runs, %d with three, %d with a home, %d with lines, %d with straight "
      "moves alone, %d of these as cheap as the best; %d jobs planned to compare; worst %.6f of "
      "best\n",
      two, more, homes, lines, straights, exact, tried, worst);
  EXPECT_GE(straights, at_least(12));
  EXPECT_GE(exact, straights - straights / 32);
  EXPECT_GE(two + more, count);
  EXPECT_GE(more, at_least(3));
}

// With lines of approach and retract, obstacles and continuous edges every answer passes its check
// and is the same on one thread and on two.
TEST(LiftOffs, LinesAndObstacles) {
  Random random(seed("LiftOffs.LinesAndObstacles"));
  const Problem like = bench();
  const int count = trials(12);
  int solved = 0, lift_offs = 0;
  for (int trial = 0; trial < 8 * count && solved < count; ++trial) {
    Problem job = random_ring(like, random, 1.5);
    Stroke& stroke = job.arm().strokes.front();
    stroke.approach = Vector3d(0, 0, -random.uniform(0.02, 0.06));
    stroke.retract = Vector3d(0, 0, -random.uniform(0.02, 0.06));
    stroke.limits.edges = EdgeMode::kContinuous;
    const PreparedRobot robot(problem_of_run(job, {0, false}));
    PlanOptions one = with_check(), two = with_check();
    one.threads = 1;
    two.threads = 2;
    const Answer found = plan_job(robot, job, one), again = plan_job(robot, job, two);
    SCOPED_TRACE("trial " + std::to_string(trial));
    ASSERT_EQ(found.status, again.status);
    if (found.arm().lift_offs.empty()) continue;
    ++solved;
    lift_offs += static_cast<int>(found.arm().lift_offs.size());
    ASSERT_EQ(found.cost, again.cost);
    ASSERT_EQ(found.arm().parts.size(), again.arm().parts.size());
    for (std::size_t k = 0; k < found.arm().parts.size(); ++k)
      for (std::size_t i = 0; i < found.arm().parts[k].rows.size(); ++i)
        ASSERT_EQ(found.arm().parts[k].rows[i].q, again.arm().parts[k].rows[i].q);
    EXPECT_TRUE(check_job(robot, executed_problem(job, found), found.arm().parts).passed);
  }
  std::printf("%d jobs with %d lift-offs\n", solved, lift_offs);
  EXPECT_GE(solved, at_least(12));
}

// The ring of the data folder, in time: its motion passes its check, rounded corners included.
TEST(LiftOffs, RingInTime) {
  Problem job = io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/iiwa14_ring_job.yaml");
  job.arm().strokes.front().resolution.ds = 0.01;
  job.arm().strokes.front().resolution.dphi = 0.1;
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  const Answer plan =
      plan_job_motion(robot, job, with_check(), false, TimingOptions{.speed = 0.05});
  ASSERT_EQ(plan.arm().lift_offs.size(), 1u);
  ASSERT_TRUE(plan.timed());
  const Problem executed = executed_problem(with_motion_defaults(job), plan);
  ASSERT_EQ(executed.arm().strokes.size(), 2u);
  EXPECT_EQ(executed.arm().strokes[1].name, "ring/2");
  EXPECT_EQ(s_of_piece(executed.arm().strokes[1]), plan.arm().lift_offs[0].resumed);
  EXPECT_TRUE(
      check_job_motion(robot, executed, {{0, false}, {1, false}}, plan.timed()->arms.front())
          .passed);
}

TEST(LiftOffs, WhatIsRefused) {
  Problem job = bench();
  job.arm().lift.emplace();
  EXPECT_NO_THROW(validate(job));
  const auto refused = [](const Problem& wrong) { EXPECT_THROW(validate(wrong), InvalidArgument); };
  Problem best = job, negative = job, slash = job;
  best.arm().order = StrokeOrder::kBest;
  negative.arm().lift->overlap = -0.01;
  slash.arm().strokes[2].name = "a/1";
  for (const Problem* wrong : {&best, &negative, &slash}) refused(*wrong);
  const double length = 0.21;
  EXPECT_EQ(with_lift_offs(job, {{1, 0.1, 0.08}}).arm().strokes.size(),
            job.arm().strokes.size() + 1);
  for (const LiftOff& wrong : {LiftOff{1, 0.1, 0.11}, LiftOff{1, -0.1, -0.1}, LiftOff{1, 0, 0},
                               LiftOff{1, length, length}, LiftOff{99, 0.1, 0.1}})
    EXPECT_THROW((void)with_lift_offs(job, {wrong}), InvalidArgument);
  EXPECT_THROW((void)with_lift_offs(job, {{2, 0.1, 0.1}, {1, 0.1, 0.1}}), InvalidArgument);
}

}  // namespace
}  // namespace swivel
