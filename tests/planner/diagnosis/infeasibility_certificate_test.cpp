// SPDX-License-Identifier: BSD-3-Clause
// Certificates that a problem has no path: verified by verify_certificate() and by plain loops;
// forged ones are refused.
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "inexact_robots.hpp"
#include "plain_edge_rule.hpp"
#include "random_problem.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using namespace test;

/// Nodes and edges by their definition, one by one.
class Plain {
 public:
  Plain(const PathProblem& problem, const PreparedRobot& robot,
        const InfeasibilityCertificate& certificate)
      : path_(problem_path(problem, robot.arm().chain)),
        lattice_(make_lattice(robot.arm().chain, robot.arm_class(), path_, problem)),
        world_(robot.world(), problem),
        rule_(world_.edge_rule(robot.radii())),
        query_(world_) {
    for (const auto& steps : certificate.halvings) lattice_ = lattice_->with_knots(steps, {});
    for (const auto& joints : certificate.windings) lattice_ = lattice_->with_windings(joints);
  }
  [[nodiscard]] const Lattice& lattice() const { return *lattice_; }

  [[nodiscard]] bool valid(int layer, int slot) {
    const auto [at, is_new] = valid_.try_emplace({layer, slot}, false);
    if (is_new) {
      const auto q = lattice_->exact_config(layer, slot);
      at->second = q && lattice_->chain().manipulability(*q) >= lattice_->limits().manipulability &&
                   !query_.find_violating_pair(*q, ClearanceRule::kNode);
    }
    return at->second;
  }
  /// Between valid nodes.
  [[nodiscard]] bool joined(int layer, int a, int b) {
    if (!lattice_->in_window(layer, a, b)) return false;
    const Limits& limits = lattice_->limits();
    const Config na = *lattice_->node(layer, a), nb = *lattice_->node(layer + 1, b);
    const Config qa = *lattice_->exact_config(layer, a, na),
                 qb = *lattice_->exact_config(layer + 1, b, nb);
    Config nodes = nb - na, rows = qb - qa;
    for (int j = 0; j < kDof; ++j) {
      for (Config* move : {&nodes, &rows})
        if (lattice_->continuous()[static_cast<std::size_t>(j)])
          (*move)[j] = std::remainder((*move)[j], kTwoPi);
      const double most = lattice_->row_step_bound(layer)[j];  // joint_step and speeds
      if (std::abs(nodes[j]) > most + 2 * lattice_->fit_error()[j] || std::abs(rows[j]) > most)
        return false;
    }
    if (lattice_->can_halve(layer)) return true;  // for whatever nodes there might be between
    if (!lattice_->follows_path(layer, a, qa, b, qb)) return false;
    return limits.edges == EdgeMode::kNodes || !edge_blocked_plain(query_, rule_, qa, qa + rows);
  }

  /// What is wrong with a certificate, "" where nothing is. Every valid node of its first layer is
  /// reached, every valid edge from a reached node leads to a reached one, none of its last layer
  /// is; no node that it takes out is valid.
  [[nodiscard]] std::string fault(const InfeasibilityCertificate& certificate) {
    std::vector<char> before;
    for (std::size_t k = 0; k < certificate.band.size(); ++k) {
      const int layer = certificate.first_layer + static_cast<int>(k),
                slots = lattice_->slots(layer);
      const std::string where = "layer " + std::to_string(layer) + " slot ";
      std::vector<char> reached(static_cast<std::size_t>(slots), 0);
      for (const InfeasibilityCertificate::Range& range : certificate.band[k].reached)
        for (int slot = range.first; slot <= range.last; ++slot)
          reached[static_cast<std::size_t>(slot)] = 1;
      for (const InfeasibilityCertificate::Nodes& removed : certificate.band[k].removed)
        for (int slot = removed.slots.first; slot <= removed.slots.last; ++slot)
          if (valid(layer, slot)) return where + std::to_string(slot) + " is removed and valid";
      for (int b = 0; b < slots; ++b) {
        if (reached[static_cast<std::size_t>(b)]) {
          if (k + 1 == certificate.band.size())
            return where + std::to_string(b) + " is reached in the last layer";
          continue;
        }
        if (!valid(layer, b)) continue;
        if (k == 0) return where + std::to_string(b) + " is valid and not told";
        for (int a = 0; a < static_cast<int>(before.size()); ++a)
          if (before[static_cast<std::size_t>(a)] && valid(layer - 1, a) && joined(layer - 1, a, b))
            return where + std::to_string(b) + " is reached from " + std::to_string(a);
      }
      before.swap(reached);
    }
    return certificate.band.empty() ? "empty" : "";
  }

 private:
  ToolPath path_;
  std::unique_ptr<Lattice> lattice_;
  World world_;
  EdgeRule rule_;
  World::Query query_;
  std::map<std::pair<int, int>, bool> valid_;
};

/// One change that leaves no proof; none where there is nothing to change in this way.
using Forgery = std::function<bool(InfeasibilityCertificate&, Random&)>;

template <class Items>
auto some(Items& items, Random& random) {
  return items.begin() + random.below(static_cast<int>(items.size()));
}

/// A layer of those that have what is asked for; null where none has.
template <class Has>
InfeasibilityCertificate::Layer* some_layer(InfeasibilityCertificate& certificate, Random& random,
                                            const Has& has) {
  std::vector<InfeasibilityCertificate::Layer*> found;
  for (InfeasibilityCertificate::Layer& layer : certificate.band)
    if (has(layer)) found.push_back(&layer);
  return found.empty() ? nullptr : *some(found, random);
}

using Forgeries = std::vector<std::pair<std::string, Forgery>>;

bool has_removed(const InfeasibilityCertificate::Layer& layer) {
  return !layer.removed.empty();
}

bool has_edges(const InfeasibilityCertificate::Layer& layer) {
  return !layer.edges.empty();
}

bool has_reached(const InfeasibilityCertificate::Layer& layer) {
  return !layer.reached.empty();
}

/// Returns forgeries that change which nodes of a layer are removed.
Forgeries forgeries_of_removed_nodes() {
  return {
      {"witness of nodes taken out",
       [](InfeasibilityCertificate& certificate, Random& random) {
         InfeasibilityCertificate::Layer* const layer =
             some_layer(certificate, random, has_removed);
         if (layer) layer->removed.erase(some(layer->removed, random));
         return layer != nullptr;
       }},
      {"range of nodes shorter",
       [](InfeasibilityCertificate& certificate, Random& random) {
         InfeasibilityCertificate::Layer* const layer =
             some_layer(certificate, random, [](const InfeasibilityCertificate::Layer& l) {
               return std::any_of(l.removed.begin(), l.removed.end(),
                                  [](const InfeasibilityCertificate::Nodes& n) {
                                    return n.slots.first < n.slots.last;
                                  });
             });
         if (!layer) return false;
         auto range = some(layer->removed, random);
         while (range->slots.first == range->slots.last) range = some(layer->removed, random);
         random.coin() ? ++range->slots.first : --range->slots.last;
         return true;
       }},
      {"range of nodes wider, into one reached",
       [](InfeasibilityCertificate& certificate, Random& random) {
         InfeasibilityCertificate::Layer* const layer =
             some_layer(certificate, random, [](const InfeasibilityCertificate::Layer& l) {
               return has_removed(l) && has_reached(l);
             });
         if (layer)
           layer->removed.back().slots.last =
               std::max(layer->reached.back().last, layer->removed.back().slots.last + 1);
         return layer != nullptr;
       }},
  };
}

/// Returns forgeries that change which nodes of a layer are reached.
Forgeries forgeries_of_reached_nodes() {
  return {
      {"reached nodes become removed ones",
       [](InfeasibilityCertificate& certificate, Random& random) {
         InfeasibilityCertificate::Layer* const layer =
             some_layer(certificate, random, has_reached);
         if (!layer || certificate.witnesses.empty()) return false;
         const auto range = some(layer->reached, random);
         layer->removed.push_back(
             {*range, random.below(static_cast<int>(certificate.witnesses.size()))});
         layer->reached.erase(range);
         return true;
       }},
      {"reached node taken out",
       [](InfeasibilityCertificate& certificate, Random& random) {
         InfeasibilityCertificate::Layer* const layer =
             some_layer(certificate, random, has_reached);
         if (!layer) return false;
         const auto range = some(layer->reached, random);
         if (range->first == range->last)
           layer->reached.erase(range);
         else
           random.coin() ? ++range->first : --range->last;
         return true;
       }},
  };
}

/// Returns forgeries that change the edges of a layer.
Forgeries forgeries_of_edges() {
  return {
      {"witness of edges taken out",
       [](InfeasibilityCertificate& certificate, Random& random) {
         InfeasibilityCertificate::Layer* const layer = some_layer(certificate, random, has_edges);
         if (layer) layer->edges.erase(some(layer->edges, random));
         return layer != nullptr;
       }},
      {"count of edges",
       [](InfeasibilityCertificate& certificate, Random& random) {
         InfeasibilityCertificate::Layer* const layer = some_layer(certificate, random, has_edges);
         if (layer) some(layer->edges, random)->count += random.coin() ? 1 : -1;
         return layer != nullptr;
       }},
  };
}

/// Returns forgeries that change which layers a certificate has.
Forgeries forgeries_of_layers() {
  return {
      {"last layer taken out",
       [](InfeasibilityCertificate& certificate, Random&) {
         certificate.band.pop_back();
         return true;
       }},
      {"shifted along the path",
       [](InfeasibilityCertificate& certificate, Random&) {
         certificate.first_layer =
             certificate.layers - static_cast<int>(certificate.band.size()) + 1;
         return true;
       }},
  };
}

/// Returns forgeries that name witnesses which do not exist.
Forgeries forgeries_of_witnesses() {
  return {
      {"witness that the problem does not have",
       [](InfeasibilityCertificate& certificate, Random& random) {
         if (certificate.witnesses.empty()) return false;
         Cause& cause = *some(certificate.witnesses, random);
         cause.kind = Cause::Kind::kPair;
         cause.bodies = {"nothing", "nowhere"};
         return true;
       }},
      {"witness that is not listed",
       [](InfeasibilityCertificate& certificate, Random& random) {
         InfeasibilityCertificate::Layer* const layer =
             some_layer(certificate, random, has_removed);
         if (layer)
           layer->removed[0].witness =
               random.coin() ? -1 : static_cast<int>(certificate.witnesses.size());
         return layer != nullptr;
       }},
  };
}

/// Returns all forgeries, in the order in which they draw from the random generator.
const Forgeries& forgeries() {
  static const Forgeries all = [] {
    Forgeries joined;
    for (const Forgeries& some_of :
         {forgeries_of_removed_nodes(), forgeries_of_reached_nodes(), forgeries_of_edges(),
          forgeries_of_layers(), forgeries_of_witnesses()})
      joined.insert(joined.end(), some_of.begin(), some_of.end());
    return joined;
  }();
  return all;
}

TestRobot arm_of_data(const std::string& name) {
  TestRobot robot = data_robot(name);
  robot.tip_link = "flange";
  return robot;
}

/// Random problems; on arms planned on arcs as small ones as brute force can do. In every second
/// one it is moves that end paths.
PathProblem random_task(const TestRobot& robot, bool arcs, Random& random) {
  PathProblem problem = random_problem(robot, random);
  Limits& limits = problem.limits;
  if (random.coin()) {
    problem.scene.resize(std::min<std::size_t>(problem.scene.size(), 2));
    if (random.coin()) limits.tool_path_error = std::pow(10, random.uniform(-6, -3));
    if (random.coin(0.3)) limits.tool_angle_error = std::pow(10, random.uniform(-5, -2));
    if (random.coin())
      limits.edges = EdgeMode::kContinuous,
      limits.edge_clearance = limits.clearance + random.uniform(0, 0.05);
    if (random.coin(0.3)) limits.tool_speed = random.uniform(0.1, 1);
  }
  if (!arcs) return problem;
  limits.step_error.reset();
  limits.arm_slope = Limits().arm_slope;
  problem.resolution.arc = random.uniform(0.3, 0.6);
  problem.waypoints.resize(2);
  problem.resolution.ds = (problem.waypoints[1].position - problem.waypoints[0].position).norm() /
                          (2 + random.below(3));
  problem.resolution.dalpha = 0.5;
  return problem;
}

/// An arm whose last joint alone has a range of more than a turn: it is taken as a circle.
TestRobot wound_robot() {
  TestRobot robot = with_limits(arm_of_data("xarm7_like"), [](int number, Joint& joint) {
    if (number % 2 == 0)
      joint.lower = number == 6 ? -3.4 : -3.1, joint.upper = number == 6 ? 3.3 : 3.1;
  });
  robot.name = "xarm7_like, one joint of more than a turn";
  return robot;
}

/// From a start at the upper limit of that joint the tool turns on, so that a path over the circle
/// leaves the limits.
PathProblem beyond_a_turn(const TestRobot& robot, Random& random) {
  PathProblem problem = problem_for(robot);
  const Chain chain = arm_of(robot).chain;
  Config q = random_config(chain, random);
  q[6] = 3.25;
  problem.start = q;
  problem.waypoints = {waypoint_of(chain.tool(q))};
  q[6] += random.uniform(0.1, 0.6);
  problem.waypoints.push_back(waypoint_of(chain.tool(q)));
  problem.resolution.dalpha = 0.2;
  problem.resolution.arc = 0.5;
  problem.limits.edges = EdgeMode::kNodes;
  problem.limits.tool_path_error.reset();
  return problem;
}

/// Counts the certificates that are verified and the forged ones that are refused.
struct CertificateTally {
  int infeasible = 0, started = 0, continuous = 0, by_nodes = 0, by_edges = 0, arcs = 0,
      windings = 0, knots = 0, bytes = 0, still_proofs = 0;
  std::map<std::string, int> forged, kinds;
};

/// The robots of the random problems. Those from `grids` on are planned on arcs; the last one is
/// wound_robot().
struct CertificateRobots {
  std::vector<TestRobot> all;
  std::size_t grids = 0;
};

/// Lists S-R-S arms with exact and inexact dimensions (`base` seeds these), then arms on arcs.
CertificateRobots certificate_robots(std::uint64_t base) {
  CertificateRobots robots{.all = all_robots()};
  Random of_robots(base);
  for (const TestRobot& robot : inexact_robots(of_robots)) robots.all.push_back(robot);
  robots.grids = robots.all.size();
  for (const TestRobot& robot :
       {arm_of_data("panda_like"), arm_of_data("gen3_like"), wound_robot()})
    robots.all.push_back(robot);
  return robots;
}

/// Verifies the certificate by plain loops and by the check, and reads it back from `file`.
void expect_verified(const PathProblem& problem, const PreparedRobot& robot,
                     const InfeasibilityCertificate& certificate, Plain& plain,
                     const std::filesystem::path& file, const std::string& what,
                     CertificateTally& tally) {
  ASSERT_EQ(plain.fault(certificate), "") << what;
  const CertificateCheck check = verify_certificate(robot, problem, certificate);
  ASSERT_TRUE(check.passed) << what << ": " << check.failure;
  const std::string text = io::to_json(certificate);
  io::write_file(file, text);
  ASSERT_EQ(io::load_certificate(file), certificate) << what;
  tally.bytes = std::max(tally.bytes, static_cast<int>(text.size()));
}

/// Adds what a verified certificate of the problem shows to the tally.
void tally_certificate(const PathProblem& problem, const InfeasibilityCertificate& certificate,
                       CertificateTally& tally) {
  const CertificateCounts counts = count(certificate);
  bool nodes = false, edges = false;
  for (std::size_t k = 0; k < certificate.witnesses.size(); ++k) {
    nodes |= counts.by_witness[k].nodes > 0;
    edges |= counts.by_witness[k].edges > 0;
    ++tally.kinds[to_string(certificate.witnesses[k].kind)];
  }
  tally.started += problem.start.has_value();
  tally.continuous += problem.limits.edges == EdgeMode::kContinuous;
  tally.by_nodes += nodes;
  tally.by_edges += edges;
  tally.windings += !certificate.windings.empty();
  tally.knots += !certificate.halvings.empty();
}

/// Forges the certificate in every way that it allows and expects each forgery to be refused, or to
/// be a proof as well.
void expect_forgeries_refused(const PathProblem& problem, const PreparedRobot& robot,
                              const InfeasibilityCertificate& certificate, Plain& plain,
                              Random& random, const std::string& what, CertificateTally& tally) {
  for (const auto& [name, forge] : forgeries()) {
    InfeasibilityCertificate bad = certificate;
    if (!forge(bad, random)) continue;
    if (verify_certificate(robot, problem, bad).passed) {  // by chance it may be a proof as well
      ASSERT_EQ(plain.fault(bad), "") << what << ": " << name;
      ++tally.still_proofs;
    } else {
      ++tally.forged[name];
    }
  }
}

/// Plans one problem and, where it is infeasible, checks its certificate and forged ones.
void check_certificate(const PathProblem& problem, int trial, Random& random,
                       const std::filesystem::path& file, const std::string& what,
                       CertificateTally& tally) {
  const auto robot = std::make_shared<const PreparedRobot>(problem);
  Planner planner(robot, problem);
  PlanOptions options;
  options.planner = trial % 7 == 0 ? PlannerKind::kEagerDp : PlannerKind::kLazy;
  const PlanResult result = planner.plan(options);
  if (result.status == PlanStatus::kSolved) {
    if (trial % 10 == 0) {
      EXPECT_THROW(static_cast<void>(prove_infeasible(planner.view())), InvalidArgument) << what;
    }
    return;
  }
  ++tally.infeasible;
  const InfeasibilityCertificate certificate = prove_infeasible(planner.view());
  Plain plain(problem, *robot, certificate);
  expect_verified(problem, *robot, certificate, plain, file, what, tally);
  if (::testing::Test::HasFatalFailure()) return;
  tally_certificate(problem, certificate, tally);
  expect_forgeries_refused(problem, *robot, certificate, plain, random, what, tally);
}

/// Prints the tally and expects enough certificates and forgeries of every kind.
void expect_tally(const CertificateTally& tally, int wanted) {
  std::printf(
      "%d certificates of %d verified twice: %d with a start, %d with motions, %d on arcs (%d with "
      "windings, %d with steps halved); by nodes %d, by "
      "edges %d; at most %d bytes\n",
      tally.infeasible, wanted, tally.started, tally.continuous, tally.arcs, tally.windings,
      tally.knots, tally.by_nodes, tally.by_edges, tally.bytes);
  for (const auto& [kind, times] : tally.kinds) std::printf("  %s in %d\n", kind.c_str(), times);
  int refused = 0;
  for (const auto& [name, times] : tally.forged)
    std::printf("  forged: %s: %d refused\n", name.c_str(), times), refused += times;
  std::printf("  %d forged ones prove the same\n", tally.still_proofs);
  EXPECT_LE(tally.still_proofs, refused / 50 + 1);
  EXPECT_GE(tally.started, at_least(30));
  EXPECT_GE(tally.arcs, at_least(12));
  EXPECT_GE(tally.by_edges, at_least(20));
  EXPECT_GE(tally.windings, at_least(1));
  EXPECT_GE(tally.kinds.size(), static_cast<std::size_t>(at_least(7)));
  EXPECT_GE(tally.forged.size(), static_cast<std::size_t>(at_least(10)));
  EXPECT_GE(refused, at_least(500));
}

TEST(InfeasibilityCertificate, IsVerifiedByTheCheckAndByBruteForceAndForgedOnesAreRefused) {
  const std::uint64_t base = seed("Cut");
  const auto [robots, grids] = certificate_robots(base);
  const auto file = std::filesystem::temp_directory_path() /
                    ("swivel_cut_test_" + std::to_string(getpid()) + ".json");
  const int wanted = trials(120);
  CertificateTally tally;
  for (int trial = 0; tally.infeasible < wanted; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const std::size_t number = static_cast<std::size_t>(trial) % robots.size();
    const PathProblem problem = number + 1 == robots.size() && random.coin()
                                    ? beyond_a_turn(robots.back(), random)
                                    : random_task(robots[number], number >= grids, random);
    const int before = tally.infeasible;
    check_certificate(problem, trial, random, file,
                      "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                          std::to_string(trial) + " " + problem.source,
                      tally);
    if (HasFatalFailure()) return;
    tally.arcs += number >= grids && tally.infeasible > before;
  }
  std::filesystem::remove(file);
  expect_tally(tally, wanted);
}

/// Steps that were halved are stated in ascending order, each once.
TEST(InfeasibilityCertificate, StatesHalvedStepsInOrder) {
  InfeasibilityCertificate certificate;
  certificate.layers = 9;
  certificate.halvings = {{0, 2}, {1, 3}};
  std::string text = io::to_json(certificate);
  const auto file = std::filesystem::temp_directory_path() /
                    ("swivel_halved_test_" + std::to_string(getpid()) + ".json");
  io::write_file(file, text);
  EXPECT_EQ(io::load_certificate(file).halvings, certificate.halvings);
  const std::size_t at = text.find("[1,3]");
  ASSERT_NE(at, std::string::npos);
  for (const char* const other : {"[3,1]", "[1,1]"}) {
    text.replace(at, 5, other);
    io::write_file(file, text);
    EXPECT_THROW((void)io::load_certificate(file), InputError) << other;
  }
  std::filesystem::remove(file);
}

/// Where nodes lie at knots, a proof removes no edge of a step that has layers between, so that it
/// holds whatever knots there are besides.
TEST(InfeasibilityCertificate, OfArcsWithKnotsIsVerifiedAndForgedOnesAreRefused) {
  const std::uint64_t base = seed("Cut.Knots");
  const std::vector<TestRobot> robots{arm_of_data("panda_like"), arm_of_data("gen3_like"),
                                      arm_of_data("fetch_like")};
  const auto file = std::filesystem::temp_directory_path() /
                    ("swivel_cut_knots_test_" + std::to_string(getpid()) + ".json");
  const int wanted = trials(100);
  CertificateTally tally;
  for (int trial = 0; tally.infeasible < wanted; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        random_task(robots[static_cast<std::size_t>(trial) % robots.size()], true, random);
    problem.resolution.knot = problem.resolution.ds;
    problem.resolution.ds /= 2 + random.below(5);
    problem.limits.joint_step = random.uniform(0.05, 0.3);
    check_certificate(problem, trial, random, file,
                      "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                          std::to_string(trial) + " " + problem.source,
                      tally);
    if (HasFatalFailure()) return;
  }
  std::filesystem::remove(file);
  int refused = 0;
  for (const auto& [name, times] : tally.forged) refused += times;
  std::printf(
      "%d certificates verified twice, %d with steps halved, by edges %d; %d forged ones refused, "
      "%d prove the same\n",
      tally.infeasible, tally.knots, tally.by_edges, refused, tally.still_proofs);
  EXPECT_GE(tally.knots, at_least_among(wanted / 8));
  EXPECT_GE(refused, at_least_among(4 * wanted));
  EXPECT_LE(tally.still_proofs, refused / 50 + 1);
}

/// A check of the caller's is a witness that only those can verify who have it.
class RefusesHalf final : public StateCheck {
 public:
  [[nodiscard]] std::string name() const override { return "half"; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    for (std::size_t k = 0; k < states.size(); ++k) allowed[k] = tool_x(states[k]) < most;
  }
  std::function<double(const Config&)> tool_x;
  double most = 0;
};

TEST(InfeasibilityCertificate, ACallersCheckIsAWitness) {
  const PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_a.yaml");
  PathProblem coarse = problem;
  coarse.resolution = {.ds = 0.02, .dphi = 0.2};
  const auto robot = std::make_shared<const PreparedRobot>(coarse);
  const auto waypoints = waypoints_in_base(coarse);
  const auto half = std::make_shared<RefusesHalf>();
  half->tool_x = [&](const Config& q) {
    return (robot->arm().chain.tool(q).translation() - waypoints[0].position).norm();
  };
  half->most = (waypoints[1].position - waypoints[0].position).norm() / 2;
  Planner planner(robot, coarse);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.hooks.check = half;
  ASSERT_EQ(planner.plan(options).status, PlanStatus::kInfeasible);
  const InfeasibilityCertificate certificate = prove_infeasible(planner.view(), {}, half);
  EXPECT_TRUE(std::any_of(
      certificate.witnesses.begin(), certificate.witnesses.end(),
      [](const Cause& c) { return c.kind == Cause::Kind::kCheck && c.check == "half"; }));
  EXPECT_TRUE(verify_certificate(*robot, coarse, certificate, {}, half).passed);
  const CertificateCheck without = verify_certificate(*robot, coarse, certificate);
  EXPECT_FALSE(without.passed);
  EXPECT_NE(without.failure.find("half"), std::string::npos) << without.failure;
  half->most = 1e3;
  EXPECT_FALSE(verify_certificate(*robot, coarse, certificate, {}, half).passed);
}

/// A certificate says nothing about a lattice that is laid out otherwise.
TEST(InfeasibilityCertificate, OfAnotherLayoutIsBadInput) {
  const PathProblem problem =
      io::load_path_problem(data_dir() / "problems/experiment_a_start.yaml");
  const auto robot = std::make_shared<const PreparedRobot>(problem);
  Planner planner(robot, problem);
  ASSERT_EQ(planner.plan().status, PlanStatus::kInfeasible);
  const InfeasibilityCertificate certificate = prove_infeasible(planner.view());
  EXPECT_TRUE(verify_certificate(*robot, problem, certificate).passed);
  PathProblem other = problem;
  other.resolution.ds *= 2;
  EXPECT_THROW(static_cast<void>(verify_certificate(*robot, other, certificate)), InputError);
  other = problem;
  other.limits.edges = EdgeMode::kNodes;
  EXPECT_THROW(static_cast<void>(verify_certificate(*robot, other, certificate)), InputError);
  // The certificate proves nothing of a problem of the same layout that has a path.
  other = problem;
  other.start.reset();
  EXPECT_FALSE(verify_certificate(*robot, other, certificate).passed);
}

}  // namespace
}  // namespace swivel
