// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "certificate/cut.hpp"
#include "certificate/witnesses.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/past_singularity.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

/// The reason why a certificate is refused, thrown within this file.
struct Refused {
  std::string why;
};

std::string number(int k) {
  return std::to_string(k);
}

class Verifier {
 public:
  Verifier(const Lattice& lattice, const World& world, const EdgeRule& rule,
           const InfeasibilityCertificate& certificate, const RegionSides& regions,
           CertificateCheck& result, const std::shared_ptr<StateCheck>& check, const Budget& budget)
      : lattice_(lattice),
        certificate_(certificate),
        regions_(regions),
        result_(result),
        budget_(budget),
        witnesses_(lattice, world, rule, DistanceProofs::kOff, check, budget) {}

  void run() {
    for (std::size_t k = 0; k < certificate_.witnesses.size(); ++k)
      if (!witnesses_.add(certificate_.witnesses[k]))
        throw Refused{"witness " + std::to_string(k) + ": " + words(certificate_.witnesses[k]) +
                      ": is nothing that this problem has"};
    removes_.assign(certificate_.witnesses.size(), 0);
    const int count = static_cast<int>(certificate_.band.size());
    if (count == 0 || certificate_.first_layer < 0 ||
        certificate_.first_layer > lattice_.layers() - count)
      throw Refused{"it has layers " + number(certificate_.first_layer) + " to " +
                    number(certificate_.first_layer + count - 1) + ": the problem has 0 to " +
                    number(lattice_.layers() - 1)};
    for (int k = 0; k < count; ++k) {
      // With nodes between, other paths may lead through: the removed edge is no proof of none.
      if (k > 0 && !certificate_.band[index(k)].edges.empty() &&
          lattice_.can_halve(certificate_.first_layer + k - 1))
        throw Refused{"layer " + number(certificate_.first_layer + k) +
                      ": edges are removed on a step that may be halved"};
      here_ = read(certificate_.first_layer + k, certificate_.band[index(k)]);
      if (k == 0)
        every_node_is_told(here_);
      else
        nothing_leads_on(before_, here_, certificate_.band[index(k)].edges);
      std::swap(before_, here_);
    }
    for (std::size_t k = 0; k < removes_.size(); ++k)
      if (!removes_[k])
        throw Refused{"witness " + std::to_string(k) + ": " + words(certificate_.witnesses[k]) +
                      ": removes nothing"};
    if (!certificate_.band.back().reached.empty())
      throw Refused{"layer " + number(before_.layer) + ", the last: slot " +
                    number(certificate_.band.back().reached[0].first) + " is reached"};
  }

 private:
  enum class State : char { kUntold, kReached, kRemoved };
  struct Layer {
    int layer = 0;
    std::vector<Lattice::Node> nodes;
    std::vector<const Lattice::Node*> at;  // by slot; null: no node
    std::vector<State> state;              // by slot
  };

  [[noreturn]] static void refuse(int layer, int slot, const std::string& why) {
    throw Refused{"layer " + number(layer) + ", slot " + number(slot) + ": " + why};
  }

  /// Builds the nodes of a layer with the state that the certificate gives them. Refuses a node
  /// whose witness does not remove it.
  Layer read(int number_of, const InfeasibilityCertificate::Layer& said) {
    budget_.poll();
    Layer layer;
    layer.layer = number_of;
    lattice_.layer_nodes(number_of, layer.nodes);
    const int slots = lattice_.slots(number_of);
    if (said.slots != slots)
      throw Refused{"layer " + number(number_of) + ": it has " + number(said.slots) +
                    " slots: the problem has " + number(slots)};
    layer.at.assign(index(slots), nullptr);
    for (const Lattice::Node& node : layer.nodes) layer.at[index(node.slot)] = &node;
    layer.state.assign(index(slots), State::kUntold);
    const auto tell = [&](const InfeasibilityCertificate::Range& range, State state) {
      if (range.first < 0 || range.last < range.first || range.last >= slots)
        refuse(
            number_of, range.first,
            "a range to " + number(range.last) + ": allowed are slots up to " + number(slots - 1));
      for (int slot = range.first; slot <= range.last; ++slot) {
        if (layer.state[index(slot)] != State::kUntold) refuse(number_of, slot, "is listed twice");
        layer.state[index(slot)] = state;
      }
    };
    for (const InfeasibilityCertificate::Range& range : said.reached) {
      tell(range, State::kReached);
      for (int slot = range.first; slot <= range.last; ++slot)
        if (layer.at[index(slot)] == nullptr)
          refuse(number_of, slot, "is said to be reached, and has no node");
    }
    for (const InfeasibilityCertificate::Nodes& removed : said.removed) {
      tell(removed.slots, State::kRemoved);
      require_witness(removed.witness, number_of);
      for (int slot = removed.slots.first; slot <= removed.slots.last; ++slot, ++result_.nodes)
        if (!removes_node(removed.witness, number_of, slot))
          refuse(number_of, slot, "is not removed by its witness, " + words_of(removed.witness));
    }
    return layer;
  }

  void require_witness(int k, int layer) {
    if (k < 0 || k - regions_.count() >= static_cast<int>(certificate_.witnesses.size()))
      throw Refused{"layer " + number(layer) + ": witness " + number(k) + " is not listed"};
    if (k >= regions_.count()) removes_[index(k - regions_.count())] = 1;
  }
  [[nodiscard]] std::string words_of(int witness) const {
    return witness < regions_.count()
               ? "region " + number(witness) + " of its arm"
               : words(certificate_.witnesses[index(witness - regions_.count())]);
  }
  [[nodiscard]] bool removes_node(int witness, int layer, int slot) {
    return witness < regions_.count()
               ? regions_.removes_node(witness, layer, slot)
               : witnesses_.removes_node(witness - regions_.count(), layer, slot);
  }
  [[nodiscard]] bool removes_edge(int witness, int layer, int a, int b) {
    return witness < regions_.count()
               ? regions_.removes_edge(witness, layer, a, b)
               : witnesses_.removes_edge(witness - regions_.count(), layer, a, b);
  }

  void every_node_is_told(const Layer& layer) const {
    for (std::size_t slot = 0; slot < layer.state.size(); ++slot)
      if (layer.state[slot] == State::kUntold &&
          !(lattice_.is_given(layer.layer) && layer.at[slot] == nullptr))
        refuse(layer.layer, static_cast<int>(slot),
               "of the first layer is neither reached nor removed");
  }

  /// Refuses unless every edge from a reached node of `from` leads to a reached node of `to` or is
  /// removed, or its head is removed.
  void nothing_leads_on(const Layer& from, const Layer& to,
                        const std::vector<InfeasibilityCertificate::Edges>& removed) {
    for (const InfeasibilityCertificate::Edges& edges : removed) {
      require_witness(edges.witness, to.layer);
      for (const int slot : {edges.tails.first, edges.tails.last})
        if (slot < 0 || slot >= static_cast<int>(from.state.size()) ||
            from.state[index(slot)] != State::kReached)
          refuse(from.layer, slot, "ends a range of tails of removed edges, and is not reached");
      for (const int slot : {edges.heads.first, edges.heads.last})
        if (slot < 0 || slot >= static_cast<int>(to.state.size()) ||
            to.state[index(slot)] != State::kUntold)
          refuse(to.layer, slot,
                 "ends a range of heads of removed edges, and is reached, removed, or no slot");
      if (edges.tails.first > edges.tails.last || edges.heads.first > edges.heads.last)
        refuse(to.layer, edges.heads.first, "a range of removed edges ends before it begins");
    }
    std::vector<std::int64_t> asked(removed.size(), 0);
    std::vector<Lattice::SlotRun> runs;
    for (const Lattice::Node& a : from.nodes) {
      if (from.state[index(a.slot)] != State::kReached) continue;
      budget_.poll();
      lattice_.successors(from.layer, a.slot, runs);
      for (const Lattice::SlotRun& run : runs)
        for (int b = run.first; b < run.last; ++b) {
          if (to.state[index(b)] != State::kUntold) continue;
          if (to.at[index(b)] == nullptr) {
            if (lattice_.is_given(to.layer)) continue;  // another posture than the given one
            refuse(to.layer, b, "has no node, and no witness why");
          }
          if (lattice_.step_allowed(from.layer, lattice_.delta(a.q, to.at[index(b)]->q)))
            edge_is_removed(from.layer, a.slot, b, removed, asked);
        }
    }
    for (std::size_t k = 0; k < removed.size(); ++k)
      if (asked[k] != removed[k].count)
        refuse(to.layer, removed[k].heads.first,
               "a range of removed edges holds " + std::to_string(asked[k]) +
                   ", and is said to hold " + std::to_string(removed[k].count));
  }

  void edge_is_removed(int layer, int a, int b,
                       const std::vector<InfeasibilityCertificate::Edges>& removed,
                       std::vector<std::int64_t>& asked) {
    bool told = false;
    for (std::size_t k = 0; k < removed.size(); ++k) {
      const InfeasibilityCertificate::Edges& edges = removed[k];
      if (b < edges.heads.first || b > edges.heads.last || a < edges.tails.first ||
          a > edges.tails.last)
        continue;
      told = true;
      ++asked[k];
      ++result_.edges;
      if (!removes_edge(edges.witness, layer, a, b))
        refuse(layer, a,
               "its edge to slot " + number(b) + " is not removed by its witness, " +
                   words_of(edges.witness));
    }
    if (!told)
      refuse(layer, a,
             "its edge to slot " + number(b) + " is neither removed nor leads to a reached node");
  }

  const Lattice& lattice_;
  const InfeasibilityCertificate& certificate_;
  const RegionSides& regions_;
  CertificateCheck& result_;
  const Budget& budget_;
  Witnesses witnesses_;
  std::vector<char> removes_;  // by witness: whether something is said to be removed by it
  Layer before_, here_;
};

}  // namespace

void require_same_layout(const PathProblem& problem, const ArmClass& arm,
                         const StatedLayout& stated, int layers) {
  const auto require = [&](bool holds, const char* what) {
    if (!holds)
      throw InputError(
          problem.source,
          std::string(what) +
              " is another than the certificate's: allowed is what it was planned with");
  };
  const Resolution own = resolution_in_effect(problem.resolution, problem, arm),
                   other = resolution_in_effect(*stated.resolution, problem, arm);
  require(own.ds == other.ds, "resolution.ds (--ds)");
  require(own.dphi == other.dphi, "resolution.dphi (--dphi)");
  require(own.dalpha == other.dalpha, "resolution.dalpha");
  require(own.arc == other.arc, "resolution.arc");
  require(own.knot.value_or(0) == other.knot.value_or(0), "resolution.knot");
  require(own.arcs == other.arcs, "resolution.arcs (--arcs, --no-arcs)");
  require(problem.limits.edges == stated.edges, "limits.edges (--edges)");
  require(layers == stated.layers, "the number of layers");
}

std::shared_ptr<Lattice> told_apart(std::shared_ptr<Lattice> lattice,
                                    const std::vector<Lattice::Joints>& windings) {
  constexpr double kSlack = 1e-3;  // rad, that a range of two turns may be narrower by rounding
  Lattice::Joints before{};
  for (const Lattice::Joints& joints : windings) {
    if (joints == Lattice::Joints{}) return nullptr;
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = lattice->chain().limit[j];
      const bool turns = !limit.continuous && limit.upper - limit.lower >= kTwoPi - kSlack;
      if (joints[j] && (!turns || before[j])) return nullptr;
      before[j] = before[j] || joints[j];
    }
    lattice = lattice->with_windings(joints);
    if (!lattice) return nullptr;
  }
  return lattice;
}

std::string fault_of_cut(const Lattice& lattice, const World& world, const EdgeRule& rule,
                         const InfeasibilityCertificate& cut, const RegionSides& regions,
                         const std::shared_ptr<StateCheck>& check, const Budget& budget,
                         CertificateCheck& result) {
  try {
    Verifier(lattice, world, rule, cut, regions, result, check, budget).run();
  } catch (const Refused& refused) {
    return refused.why;
  }
  return "";
}

CertificateCheck verify_certificate(const PreparedRobot& robot, const PathProblem& problem,
                                    const InfeasibilityCertificate& certificate,
                                    const Budget& budget,
                                    const std::shared_ptr<StateCheck>& check) {
  const TraceSpan span("check of a cut");
  validate(problem);
  robot.require_prepared_for(problem);
  const Chain& chain = robot.arm().chain;
  const ToolPath path = path_within_scale(problem, chain, budget);
  // That of the last search: a caller's check keeps it on the first lattice (TaskLattice::second).
  std::shared_ptr<Lattice> lattice;
  if (!check && leads_past_singularity(chain, robot.arm_class(), path, problem, budget))
    lattice = make_srs_arcs(chain, robot.arm_class(), path, problem, budget);
  else
    lattice = make_lattice(chain, robot.arm_class(), path, problem, budget);
  for (const std::set<int>& steps : certificate.halvings) {
    std::unique_ptr<Lattice> finer;
    if (steps.empty() || *steps.begin() < 0 || *steps.rbegin() + 1 >= lattice->layers() ||
        !(finer = lattice->with_knots(steps, budget)))
      throw InputError(problem.source,
                       "certificate: halved: steps that have no layers between: it is of another "
                       "lattice: allowed are those of plan --certificate");
    lattice = std::move(finer);
  }
  require_same_layout(problem, robot.arm_class(),
                      {&certificate.resolution, certificate.edges, certificate.layers},
                      lattice->layers());
  CertificateCheck result;
  result.complete = robot.arm_class().complete();
  try {
    lattice = told_apart(std::move(lattice), certificate.windings);
    if (!lattice) throw Refused{"windings: of joints whose turns are told apart anyway"};
    const World world(robot.world(), problem, budget);
    const std::string fault = fault_of_cut(*lattice, world, world.edge_rule(robot.radii()),
                                           certificate, {}, check, budget, result);
    if (!fault.empty()) throw Refused{fault};
    result.s = {lattice->path().layer(certificate.first_layer).s,
                lattice->path()
                    .layer(certificate.first_layer + static_cast<int>(certificate.band.size()) - 1)
                    .s};
    result.passed = true;
  } catch (const Refused& refused) {
    result.failure = refused.why;
  }
  return result;
}

}  // namespace swivel
