// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "certificate/cut.hpp"
#include "certificate/witnesses.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "workcell/arm_in_cell.hpp"
#include "workcell/proof/region_pairs.hpp"

namespace swivel {

namespace {

/// The reason why a certificate of a workcell is refused, thrown within this file.
struct CellRefused {
  std::string why;
};

class WorkcellVerifier {
 public:
  WorkcellVerifier(const PreparedWorkcell& prepared, const WorkcellCertificate& certificate,
                   const Budget& budget)
      : prepared_(prepared),
        certificate_(certificate),
        budget_(budget),
        query_(prepared.between(), DistanceProofs::kOff),
        arms_{std::make_unique<ArmInCell>(prepared, 0, budget),
              std::make_unique<ArmInCell>(prepared, 1, budget)} {}

  WorkcellCertificateCheck run() {
    for (std::size_t k = 0; k < 2; ++k)
      require_same_layout(arms_[k]->of_lattice, arms_[k]->robot.arm_class(),
                          {&certificate_.resolution[k], certificate_.edges[k], certificate_.layers},
                          arms_[k]->lattice->layers());
    try {
      for (std::size_t k = 0; k < 2; ++k) {
        result_.complete = result_.complete && arms_[k]->robot.arm_class().complete();
        arms_[k]->lattice = told_apart(std::move(arms_[k]->lattice), certificate_.windings[k]);
        if (!arms_[k]->lattice)
          throw CellRefused{"windings: of joints whose turns are told apart anyway"};
      }
      require_whole_tree();
      for (std::size_t k = 0; k < certificate_.tree.size(); ++k)
        if (certificate_.tree[k].region) regions_[k] = examined(k, *certificate_.tree[k].region);
      for (std::size_t k = 0; k < certificate_.tree.size(); ++k)
        if (!certificate_.tree[k].region) examine_cut(k);
      result_.passed = true;
    } catch (const CellRefused& refused) {
      result_.failure = refused.why;
    }
    return std::move(result_);
  }

 private:
  [[noreturn]] static void refuse(std::size_t branch, const std::string& why) {
    throw CellRefused{"set " + std::to_string(branch) + ": " + why};
  }

  /// Refuses unless every set but the root is a child of a set before it that is divided, every
  /// divided set has one child for each arm, and every other set an arm without a path.
  void require_whole_tree() {
    const auto& tree = certificate_.tree;
    if (tree.empty()) throw CellRefused{"it has no sets"};
    std::vector<std::array<int, 2>> children(tree.size());
    for (std::size_t k = 0; k < tree.size(); ++k) {
      const WorkcellCertificate::Branch& branch = tree[k];
      const bool is_root = k == 0;
      if (is_root != (branch.parent < 0) || branch.parent >= static_cast<int>(k))
        refuse(k, "its parent is set " + std::to_string(branch.parent) +
                      ": allowed is a set before it, and none of the first");
      if (!is_root) {
        if (branch.arm < 0 || branch.arm > 1) refuse(k, "it is of no arm");
        if (!tree[index(branch.parent)].region) refuse(k, "its parent is not divided by a region");
        ++children[index(branch.parent)][index(branch.arm)];
      }
      if (branch.region.has_value() ==
          (branch.arm_without_path >= 0 && branch.arm_without_path <= 1))
        refuse(k, "allowed is either a region or an arm without a path");
      if (is_root && branch.arm >= 0) refuse(k, "it is the first, and of an arm");
    }
    for (std::size_t k = 0; k < tree.size(); ++k)
      if (tree[k].region && children[k] != std::array{1, 1})
        refuse(k, "it is divided, and has " + std::to_string(children[k][0]) + " and " +
                      std::to_string(children[k][1]) +
                      " sets in which an arm keeps away: allowed "
                      "is one of each");
    regions_.resize(tree.size());
  }

  /// Returns a region with its slots listed. Refuses it unless no pair of it is apart.
  ConflictRegion examined(std::size_t branch, const WorkcellCertificate::Region& said) {
    ++result_.regions;
    ConflictRegion region{.layer = said.layer};
    region.of_moves = !said.moves[0].empty() || !said.moves[1].empty();
    const int layers = certificate_.layers;
    if (said.layer < 0 || said.layer + (region.of_moves ? 1 : 0) >= layers)
      refuse(branch, "its region is of layer " + std::to_string(said.layer) +
                         ": the problem has 0 to " + std::to_string(layers - 1));
    if (region.of_moves)
      examine_moves(branch, said, region);
    else
      examine_nodes(branch, said, region);
    return region;
  }

  void examine_nodes(std::size_t branch, const WorkcellCertificate::Region& said,
                     ConflictRegion& region) {
    std::array<std::vector<Config>, 2> rows;
    for (std::size_t k = 0; k < 2; ++k) {
      const int slots = arms_[k]->lattice->slots(said.layer);
      int next = 0;
      for (const WorkcellCertificate::Range& range : said.slots[k]) {
        if (range.first < next || range.last < range.first || range.last >= slots)
          refuse(branch, "slots " + std::to_string(range.first) + " to " +
                             std::to_string(range.last) +
                             " of its region: allowed are ascending "
                             "slots up to " +
                             std::to_string(slots - 1));
        next = range.last + 1;
        for (int slot = range.first; slot <= range.last; ++slot) {
          region.slots[k].push_back(slot);
          rows[k].push_back(row(branch, k, said.layer, slot));
        }
      }
      if (rows[k].empty()) refuse(branch, "its region has no nodes of an arm");
    }
    result_.pairs += static_cast<std::int64_t>(rows[0].size() * rows[1].size());
    std::optional<std::array<std::size_t, 2>> apart;
    for (const std::optional<BodyPair>& pair : pairs_of(branch, said))
      if (apart = find_pair_apart(query_, rows, pair, budget_); !apart) return;
    const std::string bodies =
        said.bodies[0].empty() ? "" : ": '" + said.bodies[0] + "' and '" + said.bodies[1] + "'";
    refuse(branch, "layer " + std::to_string(said.layer) + ": slot " +
                       std::to_string(region.slots[0][(*apart)[0]]) + " and slot " +
                       std::to_string(region.slots[1][(*apart)[1]]) + " of its region are apart" +
                       bodies);
  }

  /// Returns the pairs of bodies of a region's names, or nothing, which stands for all pairs.
  [[nodiscard]] std::vector<std::optional<BodyPair>> pairs_of(
      std::size_t branch, const WorkcellCertificate::Region& said) const {
    if (said.bodies[0].empty() && said.bodies[1].empty()) return {std::nullopt};
    std::vector<std::optional<BodyPair>> pairs;
    for (const RobotPair& pair : prepared_.between().pairs())
      if (!pair.dropped && prepared_.between().names(pair.pair) == said.bodies)
        pairs.emplace_back(pair.pair);
    if (pairs.empty())
      refuse(branch, "its bodies '" + said.bodies[0] + "' and '" + said.bodies[1] +
                         "' are no pair of this workcell");
    return pairs;
  }

  Config row(std::size_t branch, std::size_t arm, int layer, int slot) const {
    const auto row = arms_[arm]->lattice->exact_config(layer, slot);
    if (!row)
      refuse(branch, "layer " + std::to_string(layer) + ": slot " + std::to_string(slot) + " of '" +
                         prepared_.name(arm) + "' has no node");
    return *row;
  }

  void examine_moves(std::size_t branch, const WorkcellCertificate::Region& said,
                     ConflictRegion& region) {
    if (arms_[0]->problem.limits.edges != EdgeMode::kContinuous &&
        arms_[1]->problem.limits.edges != EdgeMode::kContinuous)
      refuse(branch, "its region is of moves, of which `limits.edges` asks nothing");
    if (said.bodies != std::array<std::string, 2>{})
      refuse(branch, "its region is of moves, and names bodies: allowed are bodies at nodes");
    std::array<std::vector<std::array<Config, 2>>, 2> ends;
    for (std::size_t k = 0; k < 2; ++k) {
      const Lattice& lattice = *arms_[k]->lattice;
      if (said.moves[k].empty() || !said.slots[k].empty())
        refuse(branch, "its region is of moves, and has nodes, or no moves of an arm");
      for (const WorkcellCertificate::Move& move : said.moves[k]) {
        for (const auto& [layer, slot] :
             {std::pair(said.layer, move.from), std::pair(said.layer + 1, move.to)})
          if (slot < 0 || slot >= lattice.slots(layer))
            refuse(branch, "slot " + std::to_string(slot) + " of its region is none");
        const Config from = row(branch, k, said.layer, move.from);
        ends[k].push_back(
            {from, from + lattice.delta(from, row(branch, k, said.layer + 1, move.to))});
        region.moves[k].push_back({move.from, move.to});
      }
    }
    const std::array<std::array<double, kDof>, 2> radii{arms_[0]->robot.radii(),
                                                        arms_[1]->robot.radii()};
    for (std::size_t i = 0; i < ends[0].size(); ++i)
      for (std::size_t j = 0; j < ends[1].size(); ++j, ++result_.pairs)
        if (!query_.find_pair_blocking_motion(radii, {ends[0][i][0], ends[1][j][0]},
                                              {ends[0][i][1], ends[1][j][1]}, 0, budget_))
          refuse(branch,
                 "two moves of its region from layer " + std::to_string(said.layer) + " are apart");
  }

  void examine_cut(std::size_t branch) {
    ++result_.cuts;
    const WorkcellCertificate::Branch& leaf = certificate_.tree[branch];
    std::vector<const ConflictRegion*> regions;
    for (std::size_t at = branch; certificate_.tree[at].parent >= 0;) {
      const auto parent = index(certificate_.tree[at].parent);
      if (certificate_.tree[at].arm == leaf.arm_without_path) regions.push_back(&*regions_[parent]);
      at = parent;
    }
    std::reverse(regions.begin(), regions.end());
    const ArmInCell& arm = *arms_[index(leaf.arm_without_path)];
    CertificateCheck counts;
    const std::string fault = fault_of_cut(*arm.lattice, arm.world, arm.rule, leaf.cut,
                                           RegionSides(std::move(regions), leaf.arm_without_path),
                                           nullptr, budget_, counts);
    result_.nodes += counts.nodes;
    result_.edges += counts.edges;
    if (!fault.empty())
      refuse(branch, "the cut of '" + prepared_.name(index(leaf.arm_without_path)) + "': " + fault);
  }

  const PreparedWorkcell& prepared_;
  const WorkcellCertificate& certificate_;
  Budget budget_;
  InterArmWorld::Query query_;
  std::array<std::unique_ptr<ArmInCell>, 2> arms_;
  std::vector<std::optional<ConflictRegion>> regions_;  // of divided sets
  WorkcellCertificateCheck result_;
};

}  // namespace

WorkcellCertificateCheck verify_certificate(const PreparedWorkcell& prepared,
                                            const WorkcellCertificate& certificate,
                                            const Budget& budget) {
  const TraceSpan span("check of a workcell's certificate");
  return WorkcellVerifier(prepared, certificate, budget).run();
}

}  // namespace swivel
