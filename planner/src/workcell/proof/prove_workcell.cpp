// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "certificate/cut.hpp"
#include "plan/search.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/graph/search/pair_search.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "validity/collision_validity.hpp"
#include "workcell/arm_in_cell.hpp"
#include "workcell/between_arms.hpp"
#include "workcell/proof/region_pairs.hpp"

namespace swivel {

namespace {

/// An arm of a workcell that is proved to have no plan.
class ProvedArm : public ArmInCell {
 public:
  ProvedArm(const PreparedWorkcell& prepared, std::size_t arm, const Budget& budget)
      : ArmInCell(prepared, arm, budget), number_(static_cast<int>(arm)), budget_(budget) {}

  /// Makes a cost-to-go and verdicts in which nothing is removed yet.
  PairArm begin() {
    validity_.reset();
    cost_to_go_ = make_cost_to_go(*lattice, pruning_of(*lattice), budget_);
    if (!is_given)
      validity_.emplace(*lattice, world, rule, problem.limits.edges, DistanceProofs::kOn, alone_, 1,
                        budget_);
    return {cost_to_go_.get(), is_given ? static_cast<Validity*>(&sound_) : &*validity_};
  }
  /// Replaces the lattice by one that tells turns of joints apart where a path needs it. Returns
  /// whether it did.
  bool tell_turns_apart(const SlotPath& found) {
    const Lattice::Joints off = lattice->off_limits(found);
    if (off == Lattice::Joints{}) return false;
    validity_.reset();
    cost_to_go_.reset();
    lattice = lattice->with_windings(off);
    return true;
  }
  /// Returns the cut of this arm without its sides of regions. Throws InvalidArgument if it has a
  /// path, and Stopped.
  InfeasibilityCertificate cut(const std::vector<const ConflictRegion*>& regions) {
    const PairArm arm = begin();
    arm.cost_to_go->sweep(lattice->layers() - 1);
    for (const ConflictRegion* region : regions) remove(*region);
    if (!arm.cost_to_go->verdicts().pending.empty()) arm.cost_to_go->repair();
    SearchCounters counters;
    static_cast<void>(path_first(*arm.cost_to_go, *arm.validity, {}, counters));
    return find_cut(*lattice, world, rule, arm.cost_to_go->verdicts(),
                    RegionSides(regions, number_), nullptr, budget_);
  }

 private:
  void remove(const ConflictRegion& region) {
    const auto side = static_cast<std::size_t>(number_);
    cost_to_go_->verdicts().remove_nodes(region.layer, region.slots[side]);
    for (const SlotMove& move : region.moves[side]) {
      const auto from = lattice->node(region.layer, move.from),
                 to = lattice->node(region.layer + 1, move.to);
      if (from && to && lattice->in_window(region.layer, move.from, move.to) &&
          lattice->step_allowed(region.layer, lattice->delta(*from, *to)) &&
          cost_to_go_->verdicts().edge(region.layer, move.from, move.to) != Verdict::kRemoved)
        cost_to_go_->remove_edge(region.layer, move.from, move.to);
    }
  }

  int number_;
  Budget budget_;
  Executor alone_{1};
  GivenValidity sound_;
  std::unique_ptr<CostToGo> cost_to_go_;
  std::optional<CollisionValidity> validity_;
};

class WorkcellProof {
 public:
  WorkcellProof(const PreparedWorkcell& prepared, const Budget& budget)
      : prepared_(prepared),
        budget_(budget),
        query_(prepared.between()),
        arms_{std::make_unique<ProvedArm>(prepared, 0, budget),
              std::make_unique<ProvedArm>(prepared, 1, budget)} {}

  WorkcellCertificate prove() {
    if (arms_[0]->lattice->layers() != arms_[1]->lattice->layers())
      throw InvalidArgument("a path leads far beyond its arm's reach: allowed is one in metres");
    const TraceSpan span("certificate of a workcell");
    const std::vector<RegionBranch> tree = divide();
    WorkcellCertificate certificate;
    for (std::size_t k = 0; k < 2; ++k) {
      certificate.windings[k] = arms_[k]->lattice->joints_with_windings();
      certificate.resolution[k] = resolution_in_effect(
          arms_[k]->of_lattice.resolution, arms_[k]->of_lattice, arms_[k]->robot.arm_class());
      certificate.edges[k] = arms_[k]->problem.limits.edges;
    }
    certificate.layers = arms_[0]->lattice->layers();
    for (std::size_t k = 0; k < tree.size(); ++k) certificate.tree.push_back(branch(tree, k));
    return certificate;
  }

 private:
  /// Divides all pairs of paths by regions until every set is empty.
  std::vector<RegionBranch> divide() {
    for (;;) {
      const bool moves = std::any_of(arms_.begin(), arms_.end(), [](const auto& arm) {
        return arm->problem.limits.edges == EdgeMode::kContinuous;
      });
      const std::array<PairArm, 2> pair{arms_[0]->begin(), arms_[1]->begin()};
      BetweenArms between(prepared_.between(), {arms_[0]->lattice.get(), arms_[1]->lattice.get()},
                          {arms_[0]->robot.radii(), arms_[1]->robot.radii()}, moves,
                          DistanceProofs::kOn, budget_);
      PairSearchOptions options;
      options.paths.batch = 8;
      options.pops = 0;
      PairOutcome outcome = search_pair(pair, between, options);
      if (!outcome.decided()) throw Stopped();
      if (outcome.paths[0].empty()) return std::move(outcome.tree);
      bool told = false;
      for (std::size_t k = 0; k < 2; ++k)
        told = arms_[k]->tell_turns_apart(outcome.paths[k]) || told;
      if (!told) throw InvalidArgument("there is a plan: allowed are workcells that have none");
    }
  }

  WorkcellCertificate::Branch branch(const std::vector<RegionBranch>& tree, std::size_t k) {
    const RegionBranch& of = tree[k];
    WorkcellCertificate::Branch branch;
    branch.parent = of.parent;
    branch.arm = of.arm;
    if (of.region) {
      branch.region = region(*of.region);
      return branch;
    }
    branch.arm_without_path = *of.arm_without_path;
    std::vector<const ConflictRegion*> regions;
    for (const RegionBranch* at = &of; at->parent >= 0;) {
      const RegionBranch& parent = tree[static_cast<std::size_t>(at->parent)];
      if (at->arm == branch.arm_without_path) regions.push_back(&*parent.region);
      at = &parent;
    }
    std::reverse(regions.begin(), regions.end());
    branch.cut = arms_[static_cast<std::size_t>(branch.arm_without_path)]->cut(regions);
    return branch;
  }

  WorkcellCertificate::Region region(const ConflictRegion& of) {
    WorkcellCertificate::Region region;
    region.layer = of.layer;
    std::array<std::vector<Config>, 2> rows;
    for (std::size_t k = 0; k < 2; ++k) {
      for (const SlotMove& move : of.moves[k]) region.moves[k].push_back({move.from, move.to});
      for (const int slot : of.slots[k]) {
        rows[k].push_back(*arms_[k]->lattice->exact_config(of.layer, slot));
        auto& ranges = region.slots[k];
        if (!ranges.empty() && ranges.back().last + 1 == slot)
          ranges.back().last = slot;
        else
          ranges.push_back({slot, slot});
      }
    }
    if (of.of_moves) return region;
    if (const auto pair = find_pair_always_near(prepared_.between(), query_, rows, budget_))
      region.bodies = prepared_.between().names(*pair);
    return region;
  }

  const PreparedWorkcell& prepared_;
  Budget budget_;
  InterArmWorld::Query query_;
  std::array<std::unique_ptr<ProvedArm>, 2> arms_;
};

}  // namespace

WorkcellCertificate prove_infeasible(const PreparedWorkcell& prepared, const Budget& budget) {
  return WorkcellProof(prepared, budget).prove();
}

}  // namespace swivel
