// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <stdexcept>
#include <tuple>

#include "certificate/cut.hpp"
#include "certificate/witnesses.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "validity/collision_validity.hpp"
#include "validity/hooked_validity.hpp"

namespace swivel {

namespace {

/// Adds a slot, which follows those added before, to ranges of slots.
void add(std::vector<InfeasibilityCertificate::Range>& ranges, int slot) {
  if (!ranges.empty() && ranges.back().last + 1 == slot)
    ranges.back().last = slot;
  else
    ranges.push_back({slot, slot});
}

/// Finds the certificate of a search that found no path, from its verdicts.
class Finder {
 public:
  Finder(const Lattice& lattice, const World& world, const EdgeRule& rule, const Verdicts& verdicts,
         const RegionSides& regions, const std::shared_ptr<StateCheck>& check, const Budget& budget)
      : lattice_(lattice),
        verdicts_(verdicts),
        regions_(regions),
        budget_(budget),
        witnesses_(lattice, world, rule, DistanceProofs::kOn, check, budget) {}

  /// Returns the certificate without the settings of the problem. Throws InvalidArgument if there
  /// is a path, and Stopped.
  InfeasibilityCertificate find() {
    InfeasibilityCertificate certificate;
    certificate.layers = lattice_.layers();
    certificate.first_layer = last_without_way_on();
    Nodes nodes = nodes_of(certificate.first_layer);
    std::vector<char> all(nodes.at.size(), 1);
    leave_out_missing(certificate.first_layer, nodes, all);
    std::vector<char> reached(nodes.at.size(), 0);
    for (int slot = 0; slot < static_cast<int>(reached.size()); ++slot)
      reached[index(slot)] = has_row(certificate.first_layer, slot, nodes);
    certificate.band.push_back(layer_of(certificate.first_layer, nodes, reached, all));
    for (int layer = certificate.first_layer; !certificate.band.back().reached.empty(); ++layer)
      certificate.band.push_back(next(layer, nodes, reached));
    certificate.witnesses = witnesses_.all();
    return certificate;
  }

 private:
  /// The nodes of a layer, with what the search found out about them.
  struct Nodes {
    std::vector<Lattice::Node> list;
    std::vector<const Lattice::Node*> at;  // by slot
    std::vector<char> removed, asked;      // by slot; asked: whether row() was called
    [[nodiscard]] bool open(std::size_t slot) const {
      return at[slot] != nullptr && !removed[slot];
    }
  };
  [[nodiscard]] Nodes nodes_of(int layer) const {
    budget_.poll();
    Nodes nodes;
    lattice_.layer_nodes(layer, nodes.list);
    nodes.at.assign(index(lattice_.slots(layer)), nullptr);
    nodes.removed.assign(nodes.at.size(), 0);
    nodes.asked.assign(nodes.at.size(), 0);
    for (const Lattice::Node& node : nodes.list) {
      nodes.at[index(node.slot)] = &node;
      nodes.removed[index(node.slot)] = verdicts_.node(layer, node.slot) == Verdict::kRemoved;
    }
    return nodes;
  }

  /// Clears the flags, by slot, of the slots without a node in a layer of a given start or end: no
  /// witness is needed for postures that are not the given one.
  void leave_out_missing(int layer, const Nodes& nodes, std::vector<char>& flags) const {
    for (std::size_t slot = 0; lattice_.is_given(layer) && slot < flags.size(); ++slot)
      if (nodes.at[slot] == nullptr) flags[slot] = 0;
  }

  /// Returns true if a slot has a node that was not removed and has an exact configuration, which
  /// the search need not have computed.
  [[nodiscard]] bool has_row(int layer, int slot, Nodes& nodes) const {
    if (!nodes.open(index(slot))) return false;
    if (lattice_.is_approximate() && !nodes.asked[index(slot)]) {
      nodes.asked[index(slot)] = 1;
      nodes.removed[index(slot)] = !lattice_.exact_config(layer, slot, nodes.at[index(slot)]->q);
    }
    return nodes.open(index(slot));
  }

  /// Returns the heads of the removed edges from slot a of a layer; null if there are none.
  [[nodiscard]] const std::vector<Verdicts::HalfEdge>* removed_from(int layer, int a) const {
    const auto* edges = verdicts_.removed_edges(layer);
    if (edges == nullptr) return nullptr;
    const auto found = edges->tails.find(a);
    return found == edges->tails.end() ? nullptr : &found->second;
  }
  static bool lists(const std::vector<Verdicts::HalfEdge>* edges, int slot) {
    return edges != nullptr &&
           std::any_of(edges->begin(), edges->end(),
                       [&](const Verdicts::HalfEdge& edge) { return edge.other == slot; });
  }

  /// Returns the last layer from which no node leads to the end of the path. Throws InvalidArgument
  /// if there is a path.
  [[nodiscard]] int last_without_way_on() const {
    int layer = lattice_.layers() - 1;
    Nodes ahead = nodes_of(layer);
    std::vector<char> leads_on(ahead.at.size(), 0);
    for (std::size_t slot = 0; slot < leads_on.size(); ++slot) leads_on[slot] = ahead.open(slot);
    std::vector<Lattice::SlotRun> runs;
    while (std::find(leads_on.begin(), leads_on.end(), 1) != leads_on.end()) {
      if (layer == 0) throw InvalidArgument("there is a path: allowed are plans that found none");
      Nodes here = nodes_of(--layer);
      std::vector<char> leads(here.at.size(), 0);
      for (const Lattice::Node& a : here.list) {
        if (here.removed[index(a.slot)]) continue;
        const auto* removed = removed_from(layer, a.slot);
        const auto leads_to = [&](int b) {
          return leads_on[index(b)] &&
                 lattice_.step_allowed(layer, lattice_.delta(a.q, ahead.at[index(b)]->q)) &&
                 !lists(removed, b);
        };
        if (const int b = lattice_.neighbour_along_path(layer, a.slot, 1);
            b >= 0 && lattice_.in_window(layer, a.slot, b) && leads_to(b)) {
          leads[index(a.slot)] = 1;
          continue;
        }
        lattice_.successors(layer, a.slot, runs);
        for (const Lattice::SlotRun& run : runs)
          for (int b = run.first; b < run.last && !leads[index(a.slot)]; ++b)
            leads[index(a.slot)] = leads_to(b);
      }
      ahead = std::move(here);
      leads_on.swap(leads);
    }
    return layer;
  }

  /// Returns a witness that removes a node, or -1. `suspected`: the witness before, or -1.
  [[nodiscard]] int witness_of_node(int layer, int slot, int suspected) {
    if (const int region = regions_.of_node(layer, slot); region >= 0) return region;
    return counted(witnesses_.of_node(layer, slot, std::max(-1, suspected - regions_.count())));
  }
  /// Returns a witness that removes an edge, or -1, as witness_of_node() does.
  [[nodiscard]] int witness_of_edge(int layer, int a, int b, int suspected) {
    if (const int region = regions_.of_edge(layer, a, b); region >= 0) return region;
    return counted(witnesses_.of_edge(layer, a, b, std::max(-1, suspected - regions_.count())));
  }
  /// Returns the number of a cause after those of the regions; -1 of none.
  [[nodiscard]] int counted(int cause) const { return cause < 0 ? -1 : cause + regions_.count(); }

  /// Returns a layer of the certificate: its reached slots, and a witness for each slot that is
  /// asked for and not reached.
  [[nodiscard]] InfeasibilityCertificate::Layer layer_of(int layer, const Nodes& nodes,
                                                         const std::vector<char>& reached,
                                                         const std::vector<char>& asked) {
    InfeasibilityCertificate::Layer found;
    found.slots = static_cast<int>(nodes.at.size());
    int witness = -1;
    for (int slot = 0; slot < found.slots; ++slot) {
      if (reached[index(slot)]) {
        add(found.reached, slot);
      } else if (asked[index(slot)]) {
        witness = witness_of_node(layer, slot, witness);
        require(witness >= 0, layer, "a node");
        if (!found.removed.empty() && found.removed.back().witness == witness &&
            found.removed.back().slots.last + 1 == slot)
          found.removed.back().slots.last = slot;
        else
          found.removed.push_back({{slot, slot}, witness});
      }
    }
    return found;
  }

  /// What the edges from the reached nodes of a layer do to the nodes of the next layer.
  struct Step {
    std::vector<char> reached;                ///< by slot: an edge reaches the node
    std::vector<char> met;                    ///< by slot: an edge is allowed, but there is no node
    std::map<int, std::vector<int>> removed;  ///< removed edges: tails by head
  };

  /// Follows the edges from the nodes `reached` of a layer to the next layer, whose nodes are
  /// `ahead`.
  [[nodiscard]] Step step_from(int layer, const Nodes& nodes, const std::vector<char>& reached,
                               Nodes& ahead) const {
    Step step;
    step.reached.assign(ahead.at.size(), 0);
    step.met.assign(ahead.at.size(), 0);
    std::vector<Lattice::SlotRun> runs;
    for (const Lattice::Node& a : nodes.list) {
      if (!reached[index(a.slot)]) continue;
      budget_.poll();
      const auto* removed_here = removed_from(layer, a.slot);
      lattice_.successors(layer, a.slot, runs);
      for (const Lattice::SlotRun& run : runs)
        for (int b = run.first; b < run.last; ++b) {
          const Lattice::Node* const head = ahead.at[index(b)];
          if (step.met[index(b)] || step.reached[index(b)]) continue;
          if (head != nullptr && !lattice_.step_allowed(layer, lattice_.delta(a.q, head->q)))
            continue;
          if (!has_row(layer + 1, b, ahead))
            step.met[index(b)] = 1;
          else if (lists(removed_here, b))
            step.removed[b].push_back(a.slot);
          else
            step.reached[index(b)] = 1;
        }
    }
    return step;
  }

  /// Returns the removed edges from `tails` of a layer to head b, those that follow each other with
  /// the same witness together. `witness` is the one of the edge before, on return that of the last
  /// edge.
  [[nodiscard]] std::vector<InfeasibilityCertificate::Edges> edges_to(int layer, int b,
                                                                      const std::vector<int>& tails,
                                                                      int& witness) {
    std::vector<InfeasibilityCertificate::Edges> edges;
    for (const int a : tails) {
      witness = witness_of_edge(layer, a, b, witness);
      require(witness >= 0, layer, "an edge");
      if (edges.empty() || edges.back().witness != witness)
        edges.push_back({{a, a}, {b, b}, witness, 0});
      edges.back().tails.last = a;
      ++edges.back().count;
    }
    return edges;
  }

  /// Adds to a layer of the certificate the removed edges into its nodes that are not reached.
  /// Edges to a head continue those to the head before if they have the same tails and witness.
  void add_removed_edges(int layer, const Step& step, InfeasibilityCertificate::Layer& found) {
    std::vector<InfeasibilityCertificate::Edges> last;  // of the head before
    int witness = -1;
    for (const auto& [b, tails] : step.removed) {
      if (step.reached[index(b)]) continue;
      std::vector<InfeasibilityCertificate::Edges> here = edges_to(layer, b, tails, witness);
      for (InfeasibilityCertificate::Edges& edges : here) {
        const auto same = std::find_if(
            last.begin(), last.end(), [&](const InfeasibilityCertificate::Edges& other) {
              return other.tails == edges.tails && other.witness == edges.witness;
            });
        if (same == last.end()) continue;
        edges.heads.first = same->heads.first;
        edges.count += same->count;
        std::erase(found.edges, InfeasibilityCertificate::Edges(*same));
      }
      found.edges.insert(found.edges.end(), here.begin(), here.end());
      last.swap(here);
    }
    std::sort(
        found.edges.begin(), found.edges.end(),
        [](const InfeasibilityCertificate::Edges& x, const InfeasibilityCertificate::Edges& y) {
          return std::tuple(x.heads.first, x.tails.first) <
                 std::tuple(y.heads.first, y.tails.first);
        });
  }

  /// Returns the certificate's layer after `layer`. On entry `nodes` and `reached` are those of
  /// `layer`, on return those of the next layer.
  [[nodiscard]] InfeasibilityCertificate::Layer next(int layer, Nodes& nodes,
                                                     std::vector<char>& reached) {
    Nodes ahead = nodes_of(layer + 1);
    Step step = step_from(layer, nodes, reached, ahead);
    leave_out_missing(layer + 1, ahead, step.met);
    InfeasibilityCertificate::Layer found = layer_of(layer + 1, ahead, step.reached, step.met);
    add_removed_edges(layer, step, found);
    nodes = std::move(ahead);
    reached.swap(step.reached);
    return found;
  }

  /// Throws std::logic_error unless a witness was found for what the search removed.
  static void require(bool holds, int layer, const char* what) {
    if (!holds)
      throw std::logic_error("layer " + std::to_string(layer) + ": nothing removes " + what +
                             " that the search removed");
  }

  const Lattice& lattice_;
  const Verdicts& verdicts_;
  const RegionSides& regions_;
  const Budget& budget_;
  Witnesses witnesses_;
};

}  // namespace

InfeasibilityCertificate find_cut(const Lattice& lattice, const World& world, const EdgeRule& rule,
                                  const Verdicts& verdicts, const RegionSides& regions,
                                  const std::shared_ptr<StateCheck>& check, const Budget& budget) {
  return Finder(lattice, world, rule, verdicts, regions, check, budget).find();
}

InfeasibilityCertificate prove_infeasible(const PlanView& view, const Budget& budget,
                                          const std::shared_ptr<StateCheck>& check) {
  const TraceSpan span("cut");
  if (view.problem.closed && static_cast<int>(view.path.size()) == view.lattice.layers())
    throw InputError(view.problem.source,
                     "path.closed: paths lead to the end, and a certificate that none closes is "
                     "not supported yet: allowed is a closed path to whose end none leads");
  std::unique_ptr<CostToGo> own;  // for the eager planners, which keep no verdicts
  if (view.verdicts == nullptr) {
    own = make_cost_to_go(view.lattice, Pruning::kNone, budget);
    own->sweep(view.lattice.layers() - 1);
    Executor executor(1);
    CollisionValidity validity(view.lattice, view.world, view.world.edge_rule(view.robot.radii()),
                               view.problem.limits.edges, DistanceProofs::kOn, executor, 1, budget);
    HookedValidity hooked(view.lattice, validity, {check, nullptr}, budget);
    SearchCounters counters;
    KnotSearch knots;  // so that no edge is asked about that might be halved
    PathFirstOptions options;
    options.knots = &knots;
    static_cast<void>(path_first(*own, hooked, options, counters));
  }
  InfeasibilityCertificate certificate =
      find_cut(view.lattice, view.world, view.world.edge_rule(view.robot.radii()),
               own ? own->verdicts() : *view.verdicts, {}, check, budget);
  certificate.resolution =
      resolution_in_effect(view.resolution, view.problem, view.robot.arm_class());
  certificate.edges = view.problem.limits.edges;
  certificate.windings = view.lattice.joints_with_windings();
  certificate.halvings = view.lattice.halvings();
  return certificate;
}

}  // namespace swivel
