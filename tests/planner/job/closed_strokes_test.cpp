// SPDX-License-Identifier: BSD-3-Clause
// Jobs whose strokes end in the joints in which they begin: costs against a plain program over all
// starts of all strokes and all straight moves between them, on every kind of lattice that closes.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "job/transitions/job_transitions.hpp"
#include "plain_edge_rule.hpp"
#include "rings.hpp"
#include "seed.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Draws a job of two or three rings, some from a home and back, some with a line before and after
/// each ring.
Problem ring_job(const RingArm& arm, Random& random) {
  const PathProblem first = coarse_ring(arm, random, random.coin(0.08));
  Problem job;
  static_cast<Robot&>(job.arm()) = first;
  job.source = "rings";
  job.arm().transition_limits = first.limits;
  if (random.coin()) job.scene = first.scene;
  const int count = 2 + random.below(2);
  for (int k = 0; k < count; ++k) {
    PathProblem ring = k == 0 ? first : coarse_ring(arm, random, random.coin(0.08));
    Stroke& stroke = job.arm().strokes.emplace_back();
    static_cast<Task&>(stroke) = ring;
    stroke.cost = first.cost;
    stroke.name = "ring " + std::to_string(k);
    stroke.resolution = first.resolution;
    stroke.resolution.ds = ring.resolution.ds;
    stroke.limits = first.limits;
    if (random.coin(0.3)) stroke.approach = stroke.retract = Vector3d(0, 0, -0.01);
  }
  if (random.coin(0.6)) {
    job.arm().home =
        random_config(PreparedRobot(problem_of_run(job, {0, false})).arm().chain, random);
    if (job.arm().roll) (*job.arm().home)[kDof - 1] = 0;
    keep_ring_inside(PreparedRobot(problem_of_run(job, {0, false})).arm().chain, *job.arm().home);
  }
  return job;
}

/// A configuration at which a stroke begins and ends, with what the stroke costs then.
struct Seam {
  Config q = Config::Zero();
  double cost = 0;
};

/// A stroke by brute force: its seams, and whether paths lead to its end.
struct PlainRing {
  RingTruth truth;
  std::vector<Seam> seams;
};

PlainRing plain_ring(const PreparedRobot& robot, const Problem& job, std::size_t k,
                     RingNodes nodes) {
  const PathProblem problem = problem_of_run(job, {k, false});
  const World world(robot.world(), problem);
  const ToolPath path = problem_path(problem, robot.arm().chain);
  PlainRing ring{ring_truth(robot, world, path, problem, nodes), {}};
  const std::vector<double>& costs = ring.truth.open.closed_costs;
  for (std::size_t slot = 0; slot < costs.size(); ++slot)
    if (costs[slot] < kNone)
      ring.seams.push_back(
          {*ring.truth.lattice->exact_config(0, static_cast<int>(slot)), costs[slot]});
  return ring;
}

/// The straight moves between strokes of a job.
class PlainMoves {
 public:
  PlainMoves(const PreparedRobot& robot, const Problem& job, const Lattice& metric)
      : metric_(&metric), world_(robot.world(), between(job)), query_(world_) {
    rule_ = world_.edge_rule(robot.radii());
  }
  [[nodiscard]] double cost(const Config& from, const Config& to) const {
    return transition_distance(*metric_, from, to);
  }
  bool barred(const Config& from, const Config& to) {
    Config end = from + metric_->delta(from, to);
    if (metric_->chain().roll) end[kDof - 1] = from[kDof - 1];
    for (const Config* q : {&from, &to})
      if (query_.find_violating_pair(*q, ClearanceRule::kNode)) return true;
    return edge_blocked_plain(query_, rule_, from, end).has_value();
  }
  bool all_free(const std::vector<Config>& corners) {
    for (std::size_t k = 1; k < corners.size(); ++k)
      if (barred(corners[k - 1], corners[k])) return false;
    return true;
  }

 private:
  static PathProblem between(const Problem& job) {
    PathProblem problem = problem_of_run(job, {0, false});
    problem.limits = limits_of_transitions(job);
    return problem;
  }
  const Lattice* metric_;
  World world_;
  World::Query query_;
  EdgeRule rule_;
};

/// The cheapest job of strokes in an order, whatever bars its moves.
struct PlainJob {
  double cost = kNone;
  std::vector<Config> seams;  // of the strokes in their order, home before and behind them
};

/// Finds the cheapest job in an order by a plain program over all seams and all straight moves
/// between them.
PlainJob plain_job(const Problem& job, const std::vector<PlainRing>& rings,
                   const std::vector<std::size_t>& order, const PlainMoves& moves) {
  const std::vector<Seam> home(job.arm().home ? 1 : 0,
                               Seam{job.arm().home.value_or(Config::Zero()), 0});
  std::vector<std::vector<Seam>> stages;
  if (job.arm().home) stages.push_back(home);
  for (const std::size_t k : order) stages.push_back(rings[k].seams);
  if (job.arm().home) stages.push_back(home);
  std::vector<std::vector<std::size_t>> next(stages.size());
  for (std::size_t k = stages.size() - 1; k-- > 0;)
    for (Seam& seam : stages[k]) {
      double onward = kNone;
      std::size_t best = 0;
      for (std::size_t n = 0; n < stages[k + 1].size(); ++n) {
        const Seam& other = stages[k + 1][n];
        const double cost = moves.cost(seam.q, other.q) + other.cost;
        if (cost < onward) onward = cost, best = n;
      }
      seam.cost += onward;
      next[k].push_back(best);
    }
  const auto best = std::min_element(stages[0].begin(), stages[0].end(),
                                     [](const Seam& a, const Seam& b) { return a.cost < b.cost; });
  PlainJob found{best->cost, {}};
  std::size_t at = static_cast<std::size_t>(best - stages[0].begin());
  for (std::size_t k = 0; k < stages.size(); ++k) {
    found.seams.push_back(stages[k][at].q);
    if (k + 1 < stages.size()) at = next[k][at];
  }
  return found;
}

struct JobCounts {
  int solved = 0, exact = 0, not_closed = 0, without_path = 0, barred = 0, dearer = 0, lines = 0;
  std::array<int, 3> by_nodes{};
};

/// Expects that ten laps of each closed stroke are one and the same.
void expect_laps(const Chain& chain, const Answer& found, const std::string& what) {
  for (const Part& part : found.arm().parts) {
    if (!part.run) continue;
    Config at = part.rows.front().q;
    for (int lap = 0; lap < 10; ++lap)
      for (std::size_t i = 1; i < part.rows.size(); ++i) at += part.rows[i].q - part.rows[i - 1].q;
    for (int j = 0; j < kDof; ++j) {
      const double off = at[j] - part.rows.front().q[j];
      const bool free = chain.limit[static_cast<std::size_t>(j)].continuous;
      ASSERT_LE(std::abs(free ? std::remainder(off, kTwoPi) : off), 1e-9) << what << " joint " << j;
    }
  }
}

void expect_spoilt_end_refused(const PreparedRobot& robot, const Problem& job, const Answer& found,
                               const std::string& what) {
  std::vector<Part> parts = found.arm().parts;
  const auto part = std::find_if(parts.begin(), parts.end(), [](const Part& p) { return p.run; });
  part->rows.back().q[3] += 2e-9;
  const AnswerCheck refused = check_job(robot, job, parts);
  ASSERT_FALSE(refused.passed) << what;
  ASSERT_NE(refused.failures.front().find("the path is closed"), std::string::npos)
      << what << ": " << refused.failures.front();
}

/// Expects a job with a ring that has no path to be infeasible, and such a ring to be named. Where
/// one is named, joints of more than a turn may still be circles in another, which then has a path.
void expect_verdict(const Answer& found, const std::vector<PlainRing>& rings,
                    const std::string& what, JobCounts& counts) {
  ASSERT_EQ(found.status, PlanStatus::kInfeasible) << what;
  int named = 0;
  for (std::size_t k = 0; k < rings.size(); ++k) {
    if (found.arm().runs[k].status != PlanStatus::kInfeasible) continue;
    ++named;
    ASSERT_TRUE(rings[k].seams.empty()) << what << " ring " << k;
    ASSERT_TRUE(found.arm().runs[k].diagnosis) << what << " ring " << k;
    const bool open = rings[k].truth.open.solved;
    ASSERT_EQ(found.arm().runs[k].diagnosis->cause.kind == Cause::Kind::kNotClosed, open)
        << what << " ring " << k;
    ++(open ? counts.not_closed : counts.without_path);
  }
  ASSERT_GE(named, 1) << what;
}

void expect_plain_job(const RingArm& arm, const Problem& job, bool any_order,
                      const std::string& what, JobCounts& counts) {
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  std::vector<PlainRing> rings;
  for (std::size_t k = 0; k < job.arm().strokes.size(); ++k)
    rings.push_back(plain_ring(robot, job, k, arm.nodes));
  const Answer found = plan_job(robot, job);
  if (found.arm().no_transition) {  // home is barred, or no way was found
    ++counts.barred;
    return;
  }
  for (const PlainRing& ring : rings)
    if (ring.seams.empty()) return expect_verdict(found, rings, what, counts);
  PlainMoves moves(robot, job, *rings.front().truth.lattice);
  std::vector<std::size_t> order(rings.size());
  std::iota(order.begin(), order.end(), 0);
  const PlainJob plain = plain_job(job, rings, order, moves);
  ASSERT_EQ(found.status, PlanStatus::kSolved) << what;
  ++counts.solved, ++counts.by_nodes[static_cast<std::size_t>(arm.nodes)];
  const double rounding = 1e-9 * (1 + found.lattice_cost);
  ASSERT_GE(found.lattice_cost, plain.cost - rounding) << what;
  if (moves.all_free(plain.seams)) {
    ASSERT_NEAR(found.lattice_cost, plain.cost, rounding) << what;
    ++counts.exact;
  }
  for (std::size_t k = 0; k < rings.size(); ++k) {
    ASSERT_NEAR(found.arm().runs[k].least_cost, rings[k].truth.cost, rounding) << what;
    const auto part = std::find_if(found.arm().parts.begin(), found.arm().parts.end(),
                                   [&](const Part& p) { return p.run && p.run->stroke == k; });
    counts.dearer += part->cost > rings[k].truth.cost + rounding;
    counts.lines += job.arm().strokes[k].approach != Vector3d::Zero();
  }
  const AnswerCheck check = check_job(robot, job, found.arm().parts);
  ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
  expect_laps(robot.arm().chain, found, what);
  if (::testing::Test::HasFatalFailure()) return;
  expect_spoilt_end_refused(robot, job, found, what);
  if (::testing::Test::HasFatalFailure() || !any_order) return;
  double best = plain.cost;
  while (std::next_permutation(order.begin(), order.end()))
    best = std::min(best, plain_job(job, rings, order, moves).cost);
  Problem ordered = job;
  ordered.arm().order = StrokeOrder::kBest;
  const Answer in_best = plan_job(robot, ordered);
  ASSERT_LE(in_best.lattice_cost, found.lattice_cost + rounding) << what;
  ASSERT_GE(in_best.lattice_cost, best - rounding) << what;
}

TEST(ClosedStrokes, CostWhatAPlainProgramOverAllStartsSays) {
  const std::uint64_t base = seed("ClosedStrokes");
  Random any(base);
  const std::vector<RingArm> arms = ring_arms(any);
  JobCounts counts;
  const int count = trials(180);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const RingArm& arm = arms[static_cast<std::size_t>(trial) % arms.size()];
    expect_plain_job(arm, ring_job(arm, random), trial % 4 == 0,
                     "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                         std::to_string(trial) + " robot " + arm.robot.name,
                     counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "seed %llu: %d jobs: %d solved (arm angles %d, arcs %d, six joints %d), %d of them where "
      "nothing bars the moves of the plain program; %d strokes dearer than their best, %d "
      "with lines; %d strokes do not close, %d have no path, %d jobs have a barred move\n",
      static_cast<unsigned long long>(base), count, counts.solved, counts.by_nodes[0],
      counts.by_nodes[1], counts.by_nodes[2], counts.exact, counts.dearer, counts.lines,
      counts.not_closed, counts.without_path, counts.barred);
  EXPECT_GE(counts.exact, at_least(80));
  EXPECT_GE(counts.dearer, at_least(20));
  EXPECT_GE(counts.lines, at_least(10));
  EXPECT_GE(counts.not_closed, at_least(2));
}

TEST(ClosedStrokes, AreDoneInOneRunWithOneLine) {
  Random random(seed("ClosedStrokes.Refused"));
  Problem job = ring_job(ring_arms(random).front(), random);
  const auto refused = [](const Problem& bad) {
    try {
      validate(bad);
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(refused(job), "nothing");
  Problem bad = job;
  bad.arm().strokes[1].approach = Vector3d(0, 0, -0.02);
  EXPECT_NE(refused(bad).find("'ring 1': closed"), std::string::npos) << refused(bad);
  bad = job;
  bad.arm().lift.emplace();
  EXPECT_NE(refused(bad).find("lift: stroke 'ring 0' is closed"), std::string::npos)
      << refused(bad);
  bad = job;
  bad.arm().strokes[0].end = Config::Zero();
  EXPECT_NE(refused(bad).find("closed"), std::string::npos) << refused(bad);
}

}  // namespace
}  // namespace swivel
