// SPDX-License-Identifier: BSD-3-Clause
// Jobs of several strokes, some with two runs of which the job takes one, against a plain program
// over all nodes of all runs and all transitions.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include "chance.hpp"
#include "cost_to_go/grid/grid_cost_to_go.hpp"
#include "robots.hpp"
#include "search/closing_slots.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/graph/search/job_search.hpp"

namespace swivel {
namespace {

using namespace test;

/// Transitions of which chance decides: most straight moves are free, some lead around something,
/// some have no way, and at some nodes none can begin or end. In passing, some ways around are
/// known.
class FakeTransitions : public Transitions {
 public:
  FakeTransitions(const Lattice& lattice, std::uint64_t seed, double barred, double without_way,
                  double nodes_barred)
      : lattice_(&lattice),
        seed_(seed),
        barred_(barred),
        without_way_(without_way),
        nodes_barred_(nodes_barred) {}
  [[nodiscard]] double distance(const Config& from, const Config& to) const override {
    return lattice_->edge_cost(lattice_->delta(from, to));
  }
  [[nodiscard]] double least_distance(const Config& from, const Config& lower,
                                      const Config& upper) const override {
    return lattice_->edge_cost(lattice_->least_delta(from, lower, upper));
  }
  /// Returns whether no transition can begin or end at a configuration.
  [[nodiscard]] bool node_barred(const Config& q) const {
    return draw(-1, q, q, 3) < nodes_barred_;
  }
  void find_barred(std::span<const Config> configurations,
                   std::span<std::uint8_t> barred) override {
    for (std::size_t k = 0; k < configurations.size(); ++k)
      barred[k] = node_barred(configurations[k]);
  }
  /// Returns what the transition costs: the definition.
  [[nodiscard]] double cost(int transition, const Config& from, const Config& to) const {
    if (node_barred(from) || node_barred(to)) return kUnreachable;
    const double x = draw(transition, from, to, 0);
    if (x < without_way_) return kUnreachable;
    if (x >= barred_) return distance(from, to);
    return distance(from, to) +
           lattice_->rounded_cost(lattice_->cost_unit() * 2 * draw(transition, from, to, 1));
  }
  void find(std::span<const TransitionQuestion> questions,
            std::span<TransitionAnswer> answers) override {
    for (std::size_t k = 0; k < questions.size(); ++k) {
      const TransitionQuestion& x = questions[k];
      const double cost = this->cost(x.transition, x.from, x.to);
      const bool straight = cost == distance(x.from, x.to);
      const bool known = straight || x.thorough ||
                         (cost != kUnreachable && draw(x.transition, x.from, x.to, 2) < 0.5);
      if (known)
        answers[k] = cost == kUnreachable ? TransitionAnswer{Verdict::kRemoved, 0}
                                          : TransitionAnswer{Verdict::kValid, cost};
      else
        answers[k] = {};
    }
  }

 private:
  [[nodiscard]] double draw(int transition, const Config& from, const Config& to,
                            std::uint64_t salt) const {
    std::uint64_t hash = salt;
    for (const Config* q : {&from, &to})
      for (int j = 0; j < kDof; ++j)
        hash = static_cast<std::uint64_t>(
            0x1p52 * chance(hash, static_cast<std::uint64_t>((*q)[j] * 1e9 + 1e12), 1));
    return chance(seed_, hash, static_cast<std::uint64_t>(transition));
  }
  const Lattice* lattice_;
  std::uint64_t seed_;
  double barred_, without_way_, nodes_barred_;
};

/// A random job: the lattices of its runs with what chance says of them.
struct RandomJob {
  std::vector<std::vector<std::size_t>> strokes;  // their runs: indices of lattices
  std::vector<std::unique_ptr<ToolPath>> paths;
  std::vector<std::unique_ptr<Lattice>> lattices;
  std::vector<std::unique_ptr<ChanceValidity>> validities;
  std::unique_ptr<FakeTransitions> transitions;
  std::optional<Config> home;
};

std::unique_ptr<Lattice> random_list(const Chain& chain, const ToolPath& path,
                                     const PathProblem& problem, const Config& q0, Random& random) {
  std::vector<std::vector<ExplicitLattice::Point>> points(static_cast<std::size_t>(path.size()));
  for (auto& layer : points)
    for (int k = 1 + random.below(9); k > 0; --k) {
      Config q = q0;
      for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.6, 0.6);
      layer.push_back({.q = q});
    }
  if (path.closed()) points.back() = points.front();
  return std::make_unique<ExplicitLattice>(chain, path, problem, std::move(points));
}

/// Draws a job. With `grids`, its runs are lattices of arm angles, else lists of nodes; with
/// `closed`, some end where they begin, and no node costs anything.
RandomJob random_job(const TestRobot& robot, const ArmModel& arm, const SrsArm& srs, bool grids,
                     bool closed, Random& random) {
  RandomJob job;
  const std::uint64_t base = static_cast<std::uint64_t>(random.uniform(0, 1e15));
  const int strokes = 1 + random.below(grids ? 3 : 5);
  job.strokes.resize(static_cast<std::size_t>(strokes));
  std::size_t runs = 0;
  for (auto& stroke : job.strokes)
    for (int k = random.coin(0.3) ? 2 : 1; k > 0; --k) stroke.push_back(runs++);
  const double nodes_fail = random.coin(0.3) ? 0 : random.uniform(0, 0.4),
               edges_fail = random.coin(0.3) ? 0 : random.uniform(0, 0.4),
               cost = !closed && random.coin(0.3) ? random.uniform(0, 0.5) : 0;
  const Config q0 = random_config(arm.chain, random);
  for (std::size_t k = 0; k < runs; ++k) {
    PathProblem problem = problem_for(robot);
    Config q = q0;
    for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.5, 0.5);
    q = q.cwiseMax(q0.array().matrix() - Config::Constant(0.5));
    Config end = q;
    for (int j = 0; j < kDof; ++j) end[j] += random.uniform(-0.3, 0.3);
    problem.waypoints = {waypoint_of(arm.chain.tool(q)), waypoint_of(arm.chain.tool(end))};
    const double length = (problem.waypoints[0].position - problem.waypoints[1].position).norm();
    problem.resolution = {
        .ds = length / (1 + random.below(4)), .dphi = random.uniform(0.35, 0.5), .dalpha = 10};
    problem.limits.arm_slope = 1e6;
    problem.limits.joint_step = random.uniform(0.6, 1.5);
    if (closed && random.coin(0.7)) {
      problem.closed = true;
      problem.waypoints.push_back(problem.waypoints.front());
    }
    job.paths.push_back(std::make_unique<ToolPath>(problem_path(problem, arm.chain)));
    const ToolPath& path = *job.paths.back();
    if (grids)
      job.lattices.push_back(std::make_unique<SrsLattice>(arm.chain, srs, path, problem));
    else
      job.lattices.push_back(random_list(arm.chain, path, problem, q0, random));
    job.validities.push_back(std::make_unique<ChanceValidity>(*job.lattices.back(), base + 10 * k,
                                                              nodes_fail, edges_fail, cost));
  }
  const double barred = random.coin(0.3) ? 0 : random.uniform(0, 0.9);
  const double without_way = random.coin(0.2) ? barred : barred * 0.2,
               nodes_barred = random.coin(0.3) ? random.uniform(0, 0.3) : 0;
  job.transitions = std::make_unique<FakeTransitions>(*job.lattices.front(), base + 7, barred,
                                                      without_way, nodes_barred);
  if (random.coin(0.7)) {
    job.home = q0;
    for (int j = 0; j < kDof; ++j) (*job.home)[j] += random.uniform(-0.5, 0.5);
  }
  return job;
}

/// Returns the least cost of a run from each node of layer 0 back to it by the definition: a plain
/// program for each. There are as many nodes in the last layer.
std::vector<double> plain_loops(const Lattice& lattice, const ChanceValidity& validity) {
  struct Edge {
    std::size_t from, to;
    double cost;
  };
  std::vector<std::vector<Edge>> edges(static_cast<std::size_t>(lattice.layers()));
  std::vector<Lattice::Node> nodes, next;
  lattice.layer_nodes(lattice.layers() - 1, next);
  const std::size_t count = next.size();
  for (int layer = lattice.layers() - 2; layer >= 0; --layer) {
    lattice.layer_nodes(layer, nodes);
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (std::size_t b = 0; b < next.size(); ++b) {
        const int from = nodes[a].slot, to = next[b].slot;
        const Config delta = lattice.delta(nodes[a].q, next[b].q);
        if (lattice.in_window(layer, from, to) && lattice.step_allowed(layer, delta) &&
            validity.node(layer, from) && validity.node(layer + 1, to) &&
            (!validity.asks_edges() || validity.edge(layer, from, to)))
          edges[static_cast<std::size_t>(layer)].push_back({a, b, lattice.edge_cost(delta)});
      }
    next.swap(nodes);
  }
  std::vector<double> loops;
  for (std::size_t start = 0; start < count; ++start) {
    std::vector<double> here(count, kUnreachable);
    here[start] = 0;
    for (int layer = 0; layer + 1 < lattice.layers(); ++layer) {
      std::vector<double> ahead(static_cast<std::size_t>(lattice.slots(layer + 1)), kUnreachable);
      for (const Edge& edge : edges[static_cast<std::size_t>(layer)])
        ahead[edge.to] = std::min(ahead[edge.to], here[edge.from] + edge.cost);
      here.swap(ahead);
    }
    loops.push_back(here[start]);
  }
  return loops;
}

/// Returns the least cost of a job by the definition, over every node of every run; transitions
/// cost what `transition(k, from, to)` says. Sets `alone` to the least costs of the runs alone.
template <class Cost>
double plain_cost(const RandomJob& job, const Cost& transition, std::vector<double>& alone) {
  const int strokes = static_cast<int>(job.strokes.size());
  alone.assign(job.lattices.size(), kUnreachable);
  std::vector<Lattice::Node> begins;  // of the run after
  std::vector<double> rest;
  if (job.home) begins = {{0, *job.home}}, rest = {0};
  std::vector<Lattice::Node> nodes, next;
  for (int k = strokes - 1; k >= 0; --k) {
    const auto onward = [&](const Config& q) {
      double least = k + 1 == strokes && !job.home ? 0 : kUnreachable;
      for (std::size_t f = 0; f < begins.size(); ++f)
        least = std::min(least, transition(k + 1, q, begins[f].q) + rest[f]);
      return least;
    };
    std::vector<Lattice::Node> begins_here;
    std::vector<double> rest_here;
    for (const std::size_t run : job.strokes[static_cast<std::size_t>(k)]) {
      const Lattice& lattice = *job.lattices[run];
      const ChanceValidity& validity = *job.validities[run];
      std::vector<double> values, own, after, after_own;
      for (int layer = lattice.layers() - 1; layer >= 0; --layer) {
        lattice.layer_nodes(layer, nodes);
        values.assign(nodes.size(), kUnreachable);
        own = values;
        for (std::size_t a = 0; a < nodes.size(); ++a) {
          if (!validity.node(layer, nodes[a].slot)) continue;
          const double cost = validity.cost(layer, nodes[a].slot);
          if (layer + 1 == lattice.layers()) {
            own[a] = cost, values[a] = cost + onward(nodes[a].q);
            continue;
          }
          for (std::size_t b = 0; b < next.size(); ++b) {
            const Config delta = lattice.delta(nodes[a].q, next[b].q);
            if (!lattice.in_window(layer, nodes[a].slot, next[b].slot) ||
                !lattice.step_allowed(layer, delta) ||
                (validity.asks_edges() && !validity.edge(layer, nodes[a].slot, next[b].slot)))
              continue;
            const double edge = lattice.edge_cost(delta);
            values[a] = std::min(values[a], cost + (edge + after[b]));
            own[a] = std::min(own[a], cost + (edge + after_own[b]));
          }
        }
        after.swap(values), after_own.swap(own), next.swap(nodes);
      }
      if (lattice.is_closed()) {
        after_own = plain_loops(lattice, validity);
        for (std::size_t f = 0; f < next.size(); ++f) after[f] = after_own[f] + onward(next[f].q);
      }
      for (const double value : after_own) alone[run] = std::min(alone[run], value);
      begins_here.insert(begins_here.end(), next.begin(), next.end());
      rest_here.insert(rest_here.end(), after.begin(), after.end());
    }
    begins = begins_here, rest = rest_here;
  }
  double best = kUnreachable;
  for (std::size_t f = 0; f < begins.size(); ++f)
    best = std::min(best, (job.home ? transition(0, *job.home, begins[f].q) : 0.0) + rest[f]);
  return best;
}

JobOutcome search(const RandomJob& job, const ParallelFor& work = {}) {
  std::vector<std::unique_ptr<CostToGo>> values;
  std::vector<SearchedStroke> strokes(job.strokes.size());
  for (std::size_t k = 0; k < job.strokes.size(); ++k)
    for (const std::size_t run : job.strokes[k]) {
      values.push_back(make_cost_to_go(*job.lattices[run]));
      strokes[k].runs.push_back({values.back().get(), job.validities[run].get()});
    }
  JobSearchOptions options;
  options.most_searches = options.most_failed_searches = 100'000;
  options.work = work;
  return search_job(strokes, *job.transitions, job.home, options);
}

ParallelFor threads(int count) {
  return {count, [count](int parts, const std::function<void(int, int)>& body) {
            std::atomic<int> next{0};
            std::vector<std::jthread> team;
            for (int worker = 0; worker < count; ++worker)
              team.emplace_back([&, worker] {
                for (int part = next++; part < parts; part = next++) body(part, worker);
              });
          }};
}

/// Counts what the jobs met.
struct Met {
  int jobs = 0, solved = 0, without_run = 0, without_way = 0, barred = 0, dearer = 0, rounds = 0;
  int closed = 0, elsewhere = 0, second = 0, one_without_path = 0;
};

/// Expects a job's paths to be valid, joined, and to cost what it says.
void expect_valid(const RandomJob& job, const JobOutcome& found, const std::string& what) {
  double cost = 0;
  std::optional<Config> before = job.home;
  for (std::size_t k = 0; k < job.strokes.size(); ++k) {
    const std::size_t taken = job.strokes[k][found.runs[k]];
    const Lattice& lattice = *job.lattices[taken];
    const ChanceValidity& validity = *job.validities[taken];
    const SlotPath& path = found.paths[k];
    ASSERT_EQ(static_cast<int>(path.size()), lattice.layers()) << what;
    if (lattice.is_closed()) {
      ASSERT_EQ(path.front(), path.back()) << what;
    }
    const Config first = *lattice.node(0, path[0]);
    if (before) cost += job.transitions->cost(static_cast<int>(k), *before, first);
    double run = 0;
    for (int layer = 0; layer < lattice.layers(); ++layer) {
      const int slot = path[static_cast<std::size_t>(layer)];
      ASSERT_TRUE(validity.node(layer, slot)) << what;
      run += validity.cost(layer, slot);
      if (layer == 0) continue;
      const int a = path[static_cast<std::size_t>(layer) - 1];
      const Config delta = lattice.delta(*lattice.node(layer - 1, a), *lattice.node(layer, slot));
      ASSERT_TRUE(lattice.step_allowed(layer - 1, delta)) << what;
      ASSERT_TRUE(!validity.asks_edges() || validity.edge(layer - 1, a, slot)) << what;
      run += lattice.edge_cost(delta);
    }
    ASSERT_EQ(run, found.run_costs[k]) << what;
    cost += run;
    before = *lattice.node(lattice.layers() - 1, path.back());
  }
  if (job.home)
    cost += job.transitions->cost(static_cast<int>(job.strokes.size()), *before, *job.home);
  ASSERT_EQ(cost, found.cost) << what;
}

void expect_plain_program(const RandomJob& job, const std::string& what, Met& met) {
  std::vector<double> alone;
  const double straight = plain_cost(
      job,
      [&](int, const Config& a, const Config& b) {
        const bool barred = job.transitions->node_barred(a) || job.transitions->node_barred(b);
        return barred ? kUnreachable : job.transitions->distance(a, b);
      },
      alone);
  const double best = plain_cost(
      job, [&](int k, const Config& a, const Config& b) { return job.transitions->cost(k, a, b); },
      alone);
  const JobOutcome found = search(job);
  ++met.jobs;
  ASSERT_TRUE(found.decided) << what;
  std::vector<double> least_costs;
  std::optional<std::size_t> lacking;
  for (std::size_t k = 0; k < found.least_costs.size(); ++k) {
    const std::vector<double>& costs = found.least_costs[k];
    least_costs.insert(least_costs.end(), costs.begin(), costs.end());
    const auto without = std::count(costs.begin(), costs.end(), kUnreachable);
    if (without == static_cast<std::ptrdiff_t>(costs.size()) && !lacking) lacking = k;
    met.one_without_path += costs.size() == 2 && without == 1;
  }
  ASSERT_EQ(least_costs, alone) << what;
  ASSERT_EQ(found.cost, best) << what;
  met.rounds += static_cast<int>(found.rounds);
  ASSERT_EQ(found.stroke_without_path, lacking) << what;
  if (lacking) {
    ++met.without_run;
    return;
  }
  ASSERT_EQ(found.transition_without_way.has_value(), best == kUnreachable) << what;
  met.without_way += best == kUnreachable;
  for (const auto& q : {found.barred_end, found.barred_begin}) {
    if (!q) continue;
    ASSERT_EQ(best, kUnreachable) << what;
    ASSERT_TRUE(job.transitions->node_barred(*q)) << what;
    ++met.barred;
  }
  if (best == kUnreachable) return;
  ++met.solved;
  met.dearer += best > straight;
  for (std::size_t k = 0; k < job.strokes.size(); ++k) {
    met.second += found.runs[k] == 1;
    const std::size_t taken = job.strokes[k][found.runs[k]];
    if (!job.lattices[taken]->is_closed()) continue;
    ++met.closed;
    met.elsewhere += found.run_costs[k] > alone[taken];
  }
  ASSERT_EQ(found.bound, best) << what;
  ASSERT_LE(found.bound_any, straight) << what;
  expect_valid(job, found, what);
  if (::testing::Test::HasFatalFailure()) return;
  const JobOutcome again = search(job, threads(3));
  ASSERT_EQ(again.runs, found.runs) << what;
  ASSERT_EQ(again.paths, found.paths) << what;
  ASSERT_EQ(again.pairs, found.pairs) << what;
  ASSERT_EQ(again.rounds, found.rounds) << what;
}

void expect_plain_programs(bool grids, bool closed, int usual) {
  const std::uint64_t base = seed(grids ? "JobSearch grids" : "JobSearch lists");
  Random random(base);
  Met met;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    for (int trial = 0; trial < trials(usual); ++trial) {
      const RandomJob job = random_job(robot, arm, srs, grids, closed, random);
      expect_plain_program(job,
                           "SWIVEL_TEST_SEED " + std::to_string(base) + " " + robot.name +
                               " trial " + std::to_string(trial),
                           met);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
  std::printf(
      "%d jobs, %d solved (%d dearer than straight transitions), %d with a stroke without "
      "path, %d without a way (%d since all ends or begins of a stroke are barred), %d rounds; %d "
      "closed runs in solved jobs, %d of them dearer than the best by itself; %d second runs "
      "taken, "
      "%d strokes of two runs of which one has no path\n",
      met.jobs, met.solved, met.dearer, met.without_run, met.without_way, met.barred, met.rounds,
      met.closed, met.elsewhere, met.second, met.one_without_path);
  EXPECT_EQ(met.closed > 0, closed);
  EXPECT_GE(met.second, at_least(10));
  EXPECT_GE(met.one_without_path, closed ? 0 : at_least(3));
  if (closed) {
    EXPECT_GE(met.solved, at_least(grids ? 40 : 80));
    EXPECT_GE(met.closed, at_least(grids ? 40 : 80));
    EXPECT_GE(met.elsewhere, at_least(20));
    return;
  }
  EXPECT_GE(met.solved, at_least(100));
  EXPECT_GE(met.dearer, at_least(60));
  EXPECT_GE(met.without_run, at_least(5));
  if (!grids) EXPECT_GE(met.barred, at_least(5));
}

TEST(JobSearch, CostsAreThoseOfAPlainProgramOverListsOfNodes) {
  expect_plain_programs(false, false, 150);
}
TEST(JobSearch, CostsAreThoseOfAPlainProgramOverArmAngles) {
  expect_plain_programs(true, false, 40);
}
TEST(JobSearch, ClosedRunsCostWhatPlainProgramsFromEveryStartSay) {
  expect_plain_programs(false, true, 60);
}
TEST(JobSearch, ClosedRunsOfArmAnglesCostWhatPlainProgramsFromEveryStartSay) {
  expect_plain_programs(true, true, 12);
}

/// Removes what a validity says is invalid from a cost-to-go.
void remove_invalid(const ChanceValidity& validity, CostToGo& cost_to_go) {
  const Lattice& lattice = cost_to_go.lattice();
  std::vector<Lattice::Node> nodes, next;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    lattice.layer_nodes(layer, nodes);
    for (const Lattice::Node& a : nodes)
      if (!validity.node(layer, a.slot)) cost_to_go.verdicts().remove_node(layer, a.slot);
    if (!validity.asks_edges() || layer + 1 == lattice.layers()) continue;
    lattice.layer_nodes(layer + 1, next);
    for (const Lattice::Node& a : nodes)
      for (const Lattice::Node& b : next)
        if (lattice.in_window(layer, a.slot, b.slot) &&
            lattice.step_allowed(layer, lattice.delta(a.q, b.q)) &&
            !validity.edge(layer, a.slot, b.slot))
          cost_to_go.remove_edge(layer, a.slot, b.slot);
  }
}

TEST(JobSearch, OpenSlotsAreThoseFromWhichNoPlainProgramComesBack) {
  Random random(seed("JobSearch open slots"));
  const TestRobot robot = all_robots().front();
  const ArmModel arm = arm_of(robot);
  const SrsArm srs = fit_srs(arm.chain, robot.name);
  int lattices = 0, open = 0, closed = 0;
  for (int trial = 0; trial < trials(80); ++trial) {
    const RandomJob job = random_job(robot, arm, srs, trial % 8 == 0, true, random);
    for (std::size_t k = 0; k < job.lattices.size(); ++k) {
      const Lattice& lattice = *job.lattices[k];
      if (!lattice.is_closed()) continue;
      const auto cost_to_go = make_cost_to_go(lattice);
      remove_invalid(*job.validities[k], *cost_to_go);
      cost_to_go->sweep(lattice.layers() - 1);
      std::vector<std::uint8_t> may_close(static_cast<std::size_t>(lattice.slots(0)), 1);
      leave_out_open_slots(*cost_to_go, may_close);
      const std::vector<double> loops = plain_loops(lattice, *job.validities[k]);
      std::vector<Lattice::Node> nodes;
      lattice.layer_nodes(0, nodes);
      ++lattices;
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        const bool may = may_close[static_cast<std::size_t>(nodes[n].slot)] != 0;
        if (lattice.slots(0) <= 1024) {
          ASSERT_EQ(may, loops[n] < kUnreachable) << "trial " << trial;
        } else if (!may) {
          ASSERT_EQ(loops[n], kUnreachable) << "trial " << trial;
        }
        ++(may ? closed : open);
      }
    }
  }
  std::printf("%d lattices, %d slots close, %d do not\n", lattices, closed, open);
  EXPECT_GE(lattices, at_least(100));
  EXPECT_GE(closed, at_least(100));
  EXPECT_GE(open, at_least(100));
}

}  // namespace
}  // namespace swivel
