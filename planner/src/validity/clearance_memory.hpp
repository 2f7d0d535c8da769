// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// Returns the number by which searches identify the failure of a pair of bodies.
[[nodiscard]] FailureId failure_of(const BodyPair& pair);
/// Returns the pair of bodies that failure_of() has numbered.
[[nodiscard]] BodyPair pair_of(FailureId failure);

/// Remembers what earlier plans found about nodes and edges of one lattice. Findings hold as long
/// as limits and robot stay; if a scene object has moved since, they hold for all other pairs of
/// bodies. Plans are numbered from 1 on; those that do not ask about this lattice are left out.
class ClearanceMemory {
 public:
  /// Stands for a failure without a pair of bodies: manipulability, or the tool's path.
  static constexpr BodyPair kNoPair{-1, -1};
  /// A verdict on a node or an edge.
  struct Finding {
    std::uint64_t plan = 0;  ///< that found it, or confirmed it
    bool valid = false;
    BodyPair pair = kNoPair;  ///< that fails; kNoPair if valid
    bool listed = false;      ///< in the list of failures, although it may be valid by now
    /// If valid: it stays valid as long as none of the objects that had changed when it was found
    /// moves by this much, m.
    double slack = -1;
  };
  struct NodeFinding : Finding {
    Config q;
    NodeAnswer answer;
  };
  /// Joint configurations along an edge.
  using Rows = std::shared_ptr<const std::vector<Config>>;
  struct EdgeFinding : Finding {
    Config qa, qb;
    /// The configurations at the layers between and at the end of the edge, where the lattice has
    /// layers between (Lattice::interpolate_edge()); null if one of them breaks a limit.
    Rows rows;
  };
  /// How much of a finding holds for the present plan.
  enum class Holds {
    kNothing,
    kUnlessChanged,  ///< valid, except for pairs with objects changed since the last plan
    kAll,
  };

  /// Begins a plan of `scene` in `world`. met[k] is the first plan that met scene object k where it
  /// is now. The world must live until the next plan begins.
  void begin(std::uint64_t plan, std::vector<std::uint64_t> met, const World& world,
             const std::vector<SceneObject>& scene);
  /// Returns the scene objects that the last plan before this one did not meet where they are now;
  /// none if there was no plan.
  [[nodiscard]] const std::vector<int>& changed() const { return changed_; }

  /// Removes a scene object: those after it are numbered one less from now on.
  void object_removed(int object);

  /// Returns what is known about a node; null if nothing is.
  [[nodiscard]] const NodeFinding* node(int layer, int slot) const;
  /// Returns what is known about the edge from slot a of `layer` to slot b of the next layer; null
  /// if nothing is.
  [[nodiscard]] const EdgeFinding* edge(int layer, int a, int b) const;
  /// Returns how much of a finding holds for the present plan.
  [[nodiscard]] Holds holds(const Finding& finding);
  /// Stores the answer about a node. `pair` is the pair that fails, or kNoPair; `slack` is
  /// Finding::slack.
  void note_node(const NodeQuestion& question, const NodeAnswer& answer, const BodyPair& pair,
                 double slack);
  /// Stores the answer about an edge. `pair` is the pair that fails, or kNoPair; `slack` is
  /// Finding::slack, `rows` is EdgeFinding::rows.
  void note_edge(const EdgeQuestion& question, bool valid, const BodyPair& pair, double slack,
                 Rows rows);

  /// Returns all nodes and edges that fail, in the order in which they were found.
  [[nodiscard]] PriorFailures failures() const;
  /// Returns the nodes that fail by a pair of bodies, those of the last plan included.
  [[nodiscard]] std::vector<FailureHint> failure_hints();

 private:
  struct EdgeKey {
    std::uint64_t tail;
    int b;
    bool operator==(const EdgeKey&) const = default;
  };
  struct EdgeHash {
    std::size_t operator()(const EdgeKey& key) const {
      return static_cast<std::size_t>(
          (key.tail * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(key.b)) *
              0xbf58476d1ce4e5b9ull >>
          16);
    }
  };
  struct NodeHash {
    std::size_t operator()(std::uint64_t key) const {
      return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ull >> 16);
    }
  };
  static std::uint64_t key(int layer, int slot) {
    return static_cast<std::uint64_t>(layer) << 32 | static_cast<std::uint32_t>(slot);
  }

  /// Returns how far the changed objects have moved since a plan of the same run, m: the most of
  /// any of them.
  [[nodiscard]] double moved_since(std::uint64_t plan);
  /// Enters what the last plan noted. A plan only notes its findings, so that a plan that is never
  /// followed by another pays little.
  void learn();

  std::uint64_t plan_ = 0;
  // the last plan that met one of the unchanged objects for the first time
  std::uint64_t unchanged_since_ = 0;
  std::vector<std::uint64_t> met_;
  std::vector<int> changed_;
  // A run is a sequence of plans between which only the same objects changed: the plans of the run,
  // and where these objects stood in each.
  std::vector<std::uint64_t> run_;
  std::vector<std::vector<Pose>> stood_;
  // moved_since() by plan of the run, in the order of run_; negative until it is computed
  std::vector<double> moved_since_;
  const World* world_ = nullptr;
  int robot_bodies_ = 0;
  std::unordered_map<std::uint64_t, NodeFinding, NodeHash> nodes_;
  std::unordered_map<EdgeKey, EdgeFinding, EdgeHash> edges_;
  std::vector<std::pair<std::uint64_t, NodeFinding>> noted_nodes_;
  std::vector<std::pair<EdgeKey, EdgeFinding>> noted_edges_;
  std::size_t rows_ = 0;                     // in edges_
  std::vector<std::uint64_t> failed_nodes_;  // each once, even if valid by now
  std::vector<EdgeKey> failed_edges_;
};

}  // namespace swivel
