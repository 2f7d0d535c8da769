// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// A pair of bodies as the searches know it, and back.
[[nodiscard]] FailureId failure_of(const BodyPair& pair);
[[nodiscard]] BodyPair pair_of(FailureId failure);

/// What earlier plans found about nodes and edges of one lattice. It holds as long as limits and robot do; where a scene object has
/// moved since, it holds of all other pairs of bodies. Plans are numbered from 1 on.
class ClearanceMemory {
 public:
  /// No pair: manipulability, or the tool's path.
  static constexpr BodyPair kNoPair{-1, -1};
  struct Finding {
    std::uint64_t plan = 0;  ///< that found it, or found it again
    bool valid = false;
    BodyPair pair = kNoPair;  ///< of a failure
    bool listed = false;      ///< among the failures, maybe valid by now
    /// Of a valid one: it stays so while none of the objects that had changed when it was found moves by as much, m.
    double spare = -1;
  };
  struct NodeFinding : Finding {
    Config q;
    NodeAnswer answer;
  };
  /// How much of a finding holds.
  enum class Holds {
    kNothing,
    kUnlessChanged,  ///< valid, but for pairs with the objects that have changed since the last plan
    kAll,
  };

  /// A plan begins, of `scene` in `world`. met[k]: the first plan that met scene object k as it is now. The world serves until the
  /// next plan begins.
  void begin(std::uint64_t plan, std::vector<std::uint64_t> met, const World& world, const std::vector<SceneObject>& scene);
  /// Objects that the last plan did not meet as they are now.
  [[nodiscard]] const std::vector<int>& changed() const { return changed_; }

  /// Objects after this one are numbered one less from now on.
  void object_removed(int object);

  [[nodiscard]] const NodeFinding* node(int layer, int slot) const;
  [[nodiscard]] const Finding* edge(int layer, int a, int b) const;
  [[nodiscard]] Holds holds(const Finding& finding);
  void note_node(const NodeQuestion& question, const NodeAnswer& answer, const BodyPair& pair, double spare);
  void note_edge(const EdgeQuestion& question, bool valid, const BodyPair& pair, double spare);

  /// All failures, in the order in which they were found.
  [[nodiscard]] AskedFirst failures() const;
  /// The nodes among them, with those of the last plan.
  [[nodiscard]] std::vector<Suspect> suspects();

 private:
  struct EdgeKey {
    std::uint64_t tail;
    int b;
    bool operator==(const EdgeKey&) const = default;
  };
  struct EdgeHash {
    std::size_t operator()(const EdgeKey& key) const {
      return static_cast<std::size_t>(
          (key.tail * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(key.b)) * 0xbf58476d1ce4e5b9ull >> 16);
    }
  };
  struct NodeHash {
    std::size_t operator()(std::uint64_t key) const { return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ull >> 16); }
  };
  struct EdgeFinding : Finding {
    Config qa, qb;
  };
  static std::uint64_t key(int layer, int slot) {
    return static_cast<std::uint64_t>(layer) << 32 | static_cast<std::uint32_t>(slot);
  }

  /// How far the changed objects have moved since a plan of the same run, m.
  [[nodiscard]] double moved_since(std::uint64_t plan);
  /// Enters what the last plan noted. A plan only notes, so that one that is never followed by another pays little.
  void learn();

  std::uint64_t plan_ = 0;
  std::uint64_t unchanged_since_ = 0;  // of all objects but the changed ones: the last plan that met one of them for the first time
  std::vector<std::uint64_t> met_;
  std::vector<int> changed_;
  // A run of plans between which the same objects changed: the first of them, and where these stood in each.
  std::uint64_t run_ = 0;
  std::vector<std::vector<Pose>> stood_;
  std::vector<double> moved_since_;  // moved_since() by plan of the run; less than 0 where it is not known yet
  const World* world_ = nullptr;
  int robot_bodies_ = 0;
  std::unordered_map<std::uint64_t, NodeFinding, NodeHash> nodes_;
  std::unordered_map<EdgeKey, EdgeFinding, EdgeHash> edges_;
  std::vector<std::pair<std::uint64_t, NodeFinding>> noted_nodes_;
  std::vector<std::pair<EdgeKey, EdgeFinding>> noted_edges_;
  std::vector<std::uint64_t> failed_nodes_;  // once each, also where they are valid by now
  std::vector<EdgeKey> failed_edges_;
};

}  // namespace swivel
