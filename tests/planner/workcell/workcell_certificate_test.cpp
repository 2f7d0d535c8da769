// SPDX-License-Identifier: BSD-3-Clause
// Certificates that two arms have no plan: they are verified, and forged ones are refused.
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plain_arm.hpp"
#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "two_arms.hpp"

namespace swivel::test {

namespace {

using Branch = WorkcellCertificate::Branch;

/// Adds to a region of nodes a node of arm 0 that is apart from one of arm 1's. Returns false if
/// there is none.
bool add_free_pair(const PreparedWorkcell& prepared, WorkcellCertificate::Region& region) {
  std::array<std::unique_ptr<Lattice>, 2> lattices;
  std::vector<ToolPath> paths;
  for (std::size_t k = 0; k < 2; ++k)
    paths.push_back(problem_path(prepared.problem(k), prepared.robot(k).arm().chain));
  for (std::size_t k = 0; k < 2; ++k)
    lattices[k] = make_lattice(prepared.robot(k).arm().chain, prepared.robot(k).arm_class(),
                               paths[k], prepared.problem(k));
  InterArmWorld::Query query(prepared.between(), DistanceProofs::kOff);
  std::vector<Lattice::Node> nodes;
  lattices[0]->layer_nodes(region.layer, nodes);
  for (const Lattice::Node& node : nodes)
    for (const auto& range : region.slots[1])
      for (int slot = range.first; slot <= range.last; ++slot) {
        if (query.find_violating_pair({node.q, *lattices[1]->node(region.layer, slot)},
                                      ClearanceRule::kNode))
          continue;
        auto& ranges = region.slots[0];
        const auto after = std::find_if(ranges.begin(), ranges.end(),
                                        [&](const auto& other) { return other.first > node.slot; });
        ranges.insert(after, {node.slot, node.slot});
        return true;
      }
  return false;
}

/// Returns the names of a pair of bodies that is clear where the first nodes of a region's sides
/// meet; nothing if none is known.
std::optional<std::array<std::string, 2>> clear_pair(const PreparedWorkcell& prepared,
                                                     const WorkcellCertificate::Region& region) {
  std::array<Config, 2> q;
  for (std::size_t k = 0; k < 2; ++k) {
    const Chain& chain = prepared.robot(k).arm().chain;
    if (prepared.given_arm() == k) {
      q[k] = prepared.given_rows()[static_cast<std::size_t>(region.layer)].q;
      continue;
    }
    const ToolPath path = problem_path(prepared.problem(k), chain);
    const auto lattice =
        make_lattice(chain, prepared.robot(k).arm_class(), path, prepared.problem(k));
    const auto row = lattice->exact_config(region.layer, region.slots[k].front().first);
    if (!row) return std::nullopt;
    q[k] = *row;
  }
  InterArmWorld::Query query(prepared.between(), DistanceProofs::kOff);
  for (const auto& nearest : query.body_clearances(q))
    if (nearest && nearest->margin() > 1e-5) return prepared.between().names(nearest->pair);
  return std::nullopt;
}

/// Returns a number of an inner set, of a set without a path if `leaf`; nothing where there is
/// none.
std::optional<std::size_t> some(const WorkcellCertificate& certificate, bool leaf, Random& random) {
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < certificate.tree.size(); ++k)
    if (certificate.tree[k].region.has_value() != leaf) all.push_back(k);
  if (all.empty()) return std::nullopt;
  return all[static_cast<std::size_t>(random.below(static_cast<int>(all.size())))];
}

/// Ways to forge a certificate. Each returns whether it could.
using Forgery = std::function<bool(const PreparedWorkcell&, WorkcellCertificate&, Random&)>;

std::vector<Forgery> forgeries_of_regions() {
  const auto of_region = [](const auto& change) {
    return [change](const PreparedWorkcell& prepared, WorkcellCertificate& forged, Random& random) {
      const auto k = some(forged, false, random);
      return k && change(prepared, *forged.tree[*k].region);
    };
  };
  return {
      of_region([](const PreparedWorkcell& prepared, WorkcellCertificate::Region& region) {
        return region.moves[0].empty() && add_free_pair(prepared, region);
      }),
      of_region([](const PreparedWorkcell&, WorkcellCertificate::Region& region) {
        region.slots[0].clear();
        region.moves[0].clear();
        return true;
      }),
      of_region([](const PreparedWorkcell&, WorkcellCertificate::Region& region) {
        if (region.slots[1].empty()) return false;
        region.slots[1].push_back(region.slots[1].front());
        return true;
      }),
      of_region([](const PreparedWorkcell&, WorkcellCertificate::Region& region) {
        region.bodies = {"nobody", "else"};
        return region.moves[0].empty();
      }),
      of_region([](const PreparedWorkcell& prepared, WorkcellCertificate::Region& region) {
        if (region.bodies[0].empty()) return false;
        const auto other = clear_pair(prepared, region);
        if (other) region.bodies = *other;
        return other.has_value();
      }),
      of_region([](const PreparedWorkcell& prepared, WorkcellCertificate::Region& region) {
        if (region.moves[0].empty()) return false;
        region.bodies = prepared.between().names(prepared.between().pairs().front().pair);
        return true;
      }),
      of_region([](const PreparedWorkcell&, WorkcellCertificate::Region& region) {
        region.layer = -1;
        return true;
      }),
  };
}

std::vector<Forgery> forgeries_of_leaves() {
  const auto of_leaf = [](const auto& change) {
    return [change](const PreparedWorkcell&, WorkcellCertificate& forged, Random& random) {
      const auto k = some(forged, true, random);
      return k && change(forged.tree[*k]);
    };
  };
  return {
      of_leaf([](Branch& leaf) {
        leaf.cut.band.clear();
        return true;
      }),
      of_leaf([](Branch& leaf) {
        leaf.cut.band.back().reached.push_back({0, 0});
        return true;
      }),
      of_leaf([](Branch& leaf) {
        for (auto& layer : leaf.cut.band)
          if (!layer.removed.empty()) {
            layer.removed.pop_back();
            return true;
          }
        return false;
      }),
      of_leaf([](Branch& leaf) {
        if (leaf.cut.witnesses.empty()) return false;
        leaf.cut.witnesses.push_back(leaf.cut.witnesses.front());  // removes nothing
        return true;
      }),
      of_leaf([](Branch& leaf) {
        if (leaf.cut.witnesses.empty()) return false;
        Cause& cause = leaf.cut.witnesses.front();
        if (cause.kind == Cause::Kind::kPair)
          cause.joint = "joint";
        else
          cause.bodies = {"one", "other"};
        return true;
      }),
      of_leaf([](Branch& leaf) {
        leaf.arm_without_path = -1;
        return true;
      }),
      of_leaf([](Branch& leaf) {
        if (leaf.parent < 0) return false;
        leaf.arm = 1 - leaf.arm;
        return true;
      }),
  };
}

std::vector<Forgery> forgeries_of_trees() {
  return {
      [](const PreparedWorkcell&, WorkcellCertificate& forged, Random&) {
        forged.tree.pop_back();  // a missing child, or no tree
        return true;
      },
      [](const PreparedWorkcell&, WorkcellCertificate& forged, Random&) {
        forged.tree.back().parent = static_cast<int>(forged.tree.size()) - 1;  // its own
        return true;
      },
      [](const PreparedWorkcell&, WorkcellCertificate& forged, Random& random) {
        const auto k = some(forged, false, random);
        if (!k) return false;
        forged.tree[*k].region.reset();  // a set that is neither divided nor empty
        return true;
      },
  };
}

/// Returns a workcell, some of them with motions that conflict where no nodes do, some with a given
/// motion of the left arm, its own answer; nothing where it has none.
std::optional<Problem> random_cell(const TestRobot& robot, Random& random) {
  Problem cell = random_workcell(robot, random);
  if (random.coin(0.2)) cell.arms[1].path().limits.edges = EdgeMode::kNodes;
  if (random.coin(0.3))  // motions conflict where no nodes do
    for (ArmTask& arm : cell.arms) {
      arm.path().limits.clearance = 0.002;
      arm.path().limits.edge_clearance = 0.01;
      arm.path().resolution.dphi = 0.5;
    }
  if (random.coin(0.3)) {  // the left arm's own answer is given
    const PlanResult left = Planner(PreparedWorkcell(cell).problem(0)).plan(lazily());
    if (left.status != PlanStatus::kSolved) return std::nullopt;
    for (const TrajectoryRow& row : left.trajectory) cell.arms[0].given.push_back(row.q);
    cell.arms[0].path().waypoints.clear();
  }
  return cell;
}

TEST(WorkcellCertificate, IsVerifiedAndForgedOnesAreRefused) {
  Random random(seed("WorkcellCertificate.IsVerifiedAndForgedOnesAreRefused"));
  const std::array<TestRobot, 2> robots{data_robot("sda10f"), data_robot("sda5f")};
  std::vector<Forgery> ways = forgeries_of_regions();
  for (const auto& more : {forgeries_of_leaves(), forgeries_of_trees()})
    ways.insert(ways.end(), more.begin(), more.end());
  int verified = 0, divided = 0, forged = 0, of_moves = 0, given = 0;
  std::vector<int> tried(ways.size());
  const int count = trials(100);
  while (verified < count) {
    SCOPED_TRACE(verified);
    const auto drawn = random_cell(robots[random.coin() ? 0 : 1], random);
    if (!drawn) continue;
    const Problem& cell = *drawn;
    const PreparedWorkcell prepared(cell);
    const Answer found = plan_workcell(prepared, lazily());
    if (found.status != PlanStatus::kInfeasible) continue;
    const bool alone =
        found.arms[0].run().least_cost == kNone || found.arms[1].run().least_cost == kNone;
    if (alone && random.coin(0.95)) continue;  // these are many, and of one set
    const WorkcellCertificate certificate = prove_infeasible(prepared);
    const WorkcellCertificateCheck check = verify_certificate(prepared, certificate);
    ASSERT_TRUE(check.passed) << check.failure;
    EXPECT_EQ(check.cuts, check.regions + 1);
    ++verified;
    divided += check.regions > 0;
    given += !cell.arms[0].given.empty();
    for (const Branch& branch : certificate.tree)
      of_moves += branch.region && !branch.region->moves[0].empty();
    for (std::size_t k = 0; k < ways.size(); ++k) {
      if (k == 0 && prepared.given_arm()) continue;
      WorkcellCertificate other = certificate;
      if (!ways[k](prepared, other, random)) continue;
      ++tried[k];
      ++forged;
      const WorkcellCertificateCheck refused = verify_certificate(prepared, other);
      EXPECT_FALSE(refused.passed) << "forgery " << k;
      EXPECT_FALSE(refused.failure.empty());
    }
  }
  std::printf(
      "%d certificates, %d of divided sets, %d beside a given motion, %d regions of moves; "
      "%d forged\n",
      verified, divided, given, of_moves, forged);
  EXPECT_GE(divided, at_least(count / 2));
  EXPECT_GE(given, at_least(count / 10));
  EXPECT_GE(of_moves, at_least_among(1));
  EXPECT_GE(forged, at_least(5 * count));
  for (std::size_t k = 0; k < ways.size(); ++k)  // number 6 is of moves, which are rare
    EXPECT_GE(tried[k], k == 5 ? at_least_among(1) : at_least(count / 10)) << "forgery " << k;
}

TEST(WorkcellCertificate, IsOfOneWorkcell) {
  Random random(seed("WorkcellCertificate.IsOfOneWorkcell"));
  const TestRobot robot = data_robot("sda10f");
  int solved = 0, other = 0;
  const int count = trials(30);
  for (int trial = 0; trial < count; ++trial) {
    Problem cell = random_workcell(robot, random);
    const PreparedWorkcell prepared(cell);
    if (plan_workcell(prepared, lazily()).status == PlanStatus::kSolved) {
      EXPECT_THROW(static_cast<void>(prove_infeasible(prepared)), InvalidArgument);
      ++solved;
      continue;
    }
    const WorkcellCertificate certificate = prove_infeasible(prepared);
    cell.arms[0].path().resolution.dphi *= 0.9;
    EXPECT_THROW(static_cast<void>(verify_certificate(PreparedWorkcell(cell), certificate)),
                 InputError);
    ++other;
  }
  EXPECT_GE(solved, at_least(count / 8));
  EXPECT_GE(other, at_least(count / 8));
}

}  // namespace

}  // namespace swivel::test
