// SPDX-License-Identifier: BSD-3-Clause
// A planner that remembers answers as one that has just been made.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "diagnosis_of.hpp"
#include "random_problem.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {
namespace {

using namespace test;

void expect_same(const PlanResult& remembered, const PlanResult& fresh, const std::string& what) {
  ASSERT_EQ(remembered.status, fresh.status) << what;
  ASSERT_EQ(remembered.cost, fresh.cost) << what;
  ASSERT_EQ(remembered.trajectory.size(), fresh.trajectory.size()) << what;
  for (std::size_t i = 0; i < fresh.trajectory.size(); ++i) {
    ASSERT_EQ(remembered.trajectory[i].q, fresh.trajectory[i].q) << what << " row " << i;
    ASSERT_EQ(remembered.trajectory[i].phi, fresh.trajectory[i].phi) << what << " row " << i;
    ASSERT_EQ(remembered.trajectory[i].branch, fresh.trajectory[i].branch) << what << " row " << i;
  }
  ASSERT_EQ(remembered.partial.size(), fresh.partial.size()) << what;
  ASSERT_EQ(diagnosis_of(remembered).reached_layer, diagnosis_of(fresh).reached_layer) << what;
  ASSERT_EQ(diagnosis_of(remembered).removed, diagnosis_of(fresh).removed) << what;
  ASSERT_EQ(remembered.warnings, fresh.warnings) << what;
  ASSERT_EQ(remembered.lattice.nodes, fresh.lattice.nodes) << what;
}

SceneObject random_object(Random& random, const PathProblem& problem, const std::string& name) {
  SceneObject object;
  object.name = name;
  object.pose = random_pose(random, problem.waypoints[0].position, 0.35);
  const double size = random.uniform(0.02, 0.12);
  object.shape =
      random.coin() ? Shape(Sphere{size}) : Shape(box_mesh(Vector3d(size, 2 * size, size)));
  return object;
}

Pose nudged(Random& random, Pose pose) {
  const double far = random.coin(0.7) ? 0.01 : 0.2;
  for (int k = 0; k < 3; ++k) pose.translation()[k] += random.uniform(-far, far);
  return pose;
}

/// Makes one random change to a planner's problem and names its kind.
class RandomChange {
 public:
  /// Changes the problem and returns the kind: "nothing" where the drawn one has nothing to act on.
  std::string make(Planner& planner, Random& random) {
    const PathProblem& problem = planner.problem();
    const int objects = static_cast<int>(problem.scene.size());
    const int kind = random.below(12);
    const std::string object =
        objects > 0 ? problem.scene[static_cast<std::size_t>(random.below(objects))].name : "";
    if (kind < 6 && objects > 0) return move(planner, object, random);
    if (kind == 6) {
      planner.add(random_object(random, problem, "added" + std::to_string(named_++)));
      return "add";
    }
    if (kind == 7 && objects > 0) {
      planner.remove(object);
      return "remove";
    }
    if (kind == 8) return change_clearance(planner, random);
    if (kind == 9) return change_path(planner, random);
    if (kind == 10) {
      if (problem.attached.empty())
        planner.attach(
            {"grip", Box{Vector3d(0.05, 0.08, 0.03)}, Pose::Identity(), problem.tip_link});
      else
        planner.detach("grip");
      return "attach";
    }
    if (kind == 11 && objects > 0) {
      std::vector<SceneObject> scene = problem.scene;
      if (random.coin()) std::rotate(scene.begin(), scene.begin() + 1, scene.end());
      scene.back().pose = nudged(random, scene.back().pose);
      planner.set_scene(scene);
      return "scene";
    }
    return "nothing";
  }

 private:
  static std::string move(Planner& planner, const std::string& object, Random& random) {
    const PathProblem& problem = planner.problem();
    const auto& o = *std::find_if(problem.scene.begin(), problem.scene.end(),
                                  [&](const auto& x) { return x.name == object; });
    planner.move(object, nudged(random, o.pose));
    if (random.coin(0.3)) {  // two at once
      const int objects = static_cast<int>(problem.scene.size());
      const SceneObject& other = problem.scene[static_cast<std::size_t>(random.below(objects))];
      planner.move(other.name, nudged(random, other.pose));
    }
    return "move";
  }
  static std::string change_clearance(Planner& planner, Random& random) {
    Task task = planner.problem();
    task.limits.clearance = random.uniform(0, 0.03);
    task.limits.edges = random.coin() ? EdgeMode::kNodes : EdgeMode::kContinuous;
    planner.set_task(task);
    return "clearance";
  }
  static std::string change_path(Planner& planner, Random& random) {
    Task task = planner.problem();
    for (Waypoint& waypoint : task.waypoints)
      waypoint.position.z() += random.uniform(-0.005, 0.005);
    task.start.reset();
    planner.set_task(task);
    return "path";
  }

  int named_ = 0;  // objects added so far
};

/// Counts plans after each kind of change, and the questions that planners asked.
struct Counts {
  std::map<std::string, int> changes;
  int plans = 0, solved = 0, changed_answers = 0;
  std::int64_t remembered_questions = 0, fresh_questions = 0;
};

/// Changes a planner's problem eleven times, and checks after each change that the planner answers
/// as a fresh one.
void replan_after_changes(Planner& planner, Random& random, const std::string& trial,
                          const std::string& robot, Counts& counts) {
  constexpr PlannerKind kPlanners[] = {PlannerKind::kLazy, PlannerKind::kParallel,
                                       PlannerKind::kEagerDp};
  std::optional<PlanResult> last;
  RandomChange random_change;
  for (int step = 0; step < 12; ++step) {
    const std::string change = step > 0 ? random_change.make(planner, random) : "nothing";
    ++counts.changes[change];
    const std::string what =
        trial + " step " + std::to_string(step) + " robot " + robot + " after: " + change;
    PlanOptions options;
    options.planner = kPlanners[random.coin(0.1) ? 2 : random.below(2)];
    options.threads = 2;
    options.evidence.layers = true;
    const PlanResult remembered = planner.plan(options), fresh = plan(planner.problem(), options);
    expect_same(remembered, fresh, what);
    if (::testing::Test::HasFatalFailure()) return;
    if (options.planner != PlannerKind::kEagerDp && step > 0) {
      counts.remembered_questions +=
          remembered.counters.nodes_checked + remembered.counters.edges_checked;
      counts.fresh_questions += fresh.counters.nodes_checked + fresh.counters.edges_checked;
    }
    ++counts.plans;
    counts.solved += fresh.status == PlanStatus::kSolved;
    counts.changed_answers += last && (last->status != fresh.status || last->cost != fresh.cost);
    last = fresh;
  }
}

TEST(Planner, RemembersWithoutChangingAnAnswer) {
  const std::uint64_t base = seed("Replanning");
  const auto robots = all_robots();
  Counts counts;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& robot = trial % 6 == 5
                                 ? without_srdf(robots[0])
                                 : robots[static_cast<std::size_t>(trial) % robots.size()];
    PathProblem start = random_problem(robot, random);
    Planner planner(start);
    replan_after_changes(
        planner, random,
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial), robot.name,
        counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d plans, %d solved, %d answers unlike the one before; %lld questions where fresh planners "
      "ask %lld;",
      counts.plans, counts.solved, counts.changed_answers,
      static_cast<long long>(counts.remembered_questions),
      static_cast<long long>(counts.fresh_questions));
  for (const auto& [change, times] : counts.changes) std::printf(" %s %d", change.c_str(), times);
  std::printf("\n");
  if (count < 60) return;
  EXPECT_GT(counts.solved, counts.plans / 5);
  EXPECT_GT(counts.changed_answers, counts.plans / 20);
  EXPECT_GE(counts.changes.size(), 8u);
  for (const auto& [change, times] : counts.changes) EXPECT_GE(times, at_least(6)) << change;
  EXPECT_LT(counts.remembered_questions, counts.fresh_questions * 2 / 3);
}

/// What failed where the path was a moment ago is asked about first: fewer rounds of search, for
/// the same answers.
TEST(Planner, BeginsWithoutWhatFailedWhereThePathWas) {
  const std::uint64_t base = seed("Suspects");
  const auto robots = all_robots();
  int plans = 0, solved = 0;
  std::int64_t remembered_rounds = 0, fresh_rounds = 0;
  for (int trial = 0; trial < trials(60); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    problem.start.reset();
    Planner planner(problem);
    for (int step = 0; step < 5; ++step) {
      PlanOptions options;
      options.planner = random.coin() ? PlannerKind::kLazy : PlannerKind::kParallel;
      options.threads = 2;
      options.evidence.layers = true;
      const PlanResult remembered = planner.plan(options), fresh = plan(planner.problem(), options);
      expect_same(remembered, fresh,
                  "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial));
      if (HasFatalFailure()) return;
      if (step > 0) {
        ++plans;
        solved += fresh.status == PlanStatus::kSolved;
        remembered_rounds += remembered.counters.iterations;
        fresh_rounds += fresh.counters.iterations;
      }
      Task task = planner.problem();
      for (Waypoint& waypoint : task.waypoints)
        waypoint.position.z() += random.uniform(-0.001, 0.001);
      planner.set_task(task);
    }
  }
  std::printf("%d plans, %d solved; %lld rounds where fresh planners have %lld\n", plans, solved,
              static_cast<long long>(remembered_rounds), static_cast<long long>(fresh_rounds));
  if (plans < 200) return;
  EXPECT_GT(solved, plans / 5);
  EXPECT_LT(remembered_rounds, fresh_rounds * 3 / 4);
}

TEST(Planner, StopsAndGoesOn) {
  PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_c.yaml");
  problem.resolution = {.ds = 0.005, .dphi = 0.1, .knot = 0};
  problem = episode_problem(problem, 1, 17);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  const PlanResult fresh = plan(problem, options);
  Planner planner(problem);
  // The planner is stopped at every stage of the search, one after the other. It must still answer
  // as a fresh one, and what it reports as valid must be a beginning of rows.
  int stopped = 0, partial = 0;
  for (int call = 0; call < 400; ++call) {
    std::stop_source source;
    PlanOptions hurried = options;
    hurried.stop = source.get_token();
    int heard = 0;
    hurried.progress = [&](const Progress&) {
      if (heard++ == call) source.request_stop();
    };
    const PlanResult result = planner.plan(hurried);
    if (result.status == PlanStatus::kCancelled) {
      ++stopped;
      EXPECT_TRUE(result.trajectory.empty());
      partial += !result.partial.empty();
    } else {
      expect_same(result, fresh, "after " + std::to_string(call) + " calls");
    }
    const Pose pose = planner.problem().scene[1].pose;
    planner.move(planner.problem().scene[1].name,
                 nudged(*std::make_unique<Random>(static_cast<std::uint64_t>(call)), pose));
    planner.move(planner.problem().scene[1].name, pose);
    if (call % 10 == 0) {
      expect_same(planner.plan(options), fresh, "after " + std::to_string(call) + " stops");
      planner.set_task([&] {
        Task task = problem;
        task.limits.clearance += 1e-9;
        return task;
      }());
      planner.set_task(problem);
    }
    if (HasFatalFailure()) return;
  }
  std::printf("%d plans stopped, %d with partial rows\n", stopped, partial);
  EXPECT_GE(stopped, 20);
}

TEST(Planner, RefusesWhatNoProblemMayHaveAndStaysAsItWas) {
  Planner planner(io::load_path_problem(data_dir() / "problems/experiment_c.yaml"));
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  EXPECT_THROW((void)planner.view(), InvalidArgument);
  const PlanResult before = planner.plan(options);
  EXPECT_EQ(planner.view().path.size(), before.trajectory.size());
  Pose bad = Pose::Identity();
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(planner.move("door", bad), InvalidArgument);
  EXPECT_THROW(planner.move("dor", Pose::Identity()), InvalidArgument);
  EXPECT_THROW(planner.remove("dor"), InvalidArgument);
  EXPECT_THROW(planner.remove("door"), InvalidArgument);  // the path's frame
  EXPECT_THROW(planner.add({"door", Sphere{0.1}, Pose::Identity(), {}}), InvalidArgument);
  EXPECT_THROW(planner.attach({"polisher", Sphere{0.1}, Pose::Identity(), "no such link"}),
               InvalidArgument);
  EXPECT_THROW(planner.detach("nothing"), InvalidArgument);
  Task task = planner.problem();
  task.limits.clearance = -1;
  EXPECT_THROW(planner.set_task(task), InvalidArgument);
  EXPECT_EQ(planner.plan(options).cost, before.cost);
  EXPECT_EQ(planner.plan(options).counters.nodes_checked, 0)
      << "nothing changed, so nothing is asked again";
}

TEST(Planner, ClonesShareNothingThatIsWritten) {
  const PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_c.yaml");
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  Planner planner(problem);
  const double cost = planner.plan(options).cost;
  Planner other = planner.clone();
  other.remove("rail");
  EXPECT_EQ(planner.problem().scene.size(), 3u);
  EXPECT_EQ(other.plan(options).status, PlanStatus::kSolved);
  EXPECT_EQ(planner.plan(options).cost, cost);
}

}  // namespace
}  // namespace swivel
