// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/validity.hpp"
#include "swivel/graph/verdicts/verdicts.hpp"

namespace swivel {

/// Where a path may be cut into runs, by layer of its lattice.
struct CutPlace {
  bool allowed = false;  ///< a run may end at this layer
  int resumed = 0;       ///< layer at which the next run begins then: this one, or one before
};

/// A line along which the tool comes to a layer of a path, or leaves it: the layers of a lattice in
/// the order in which the tool goes.
struct CutLine {
  std::shared_ptr<const Lattice> lattice;
  std::shared_ptr<Validity> validity;  ///< of its nodes and edges
  /// A node of the path's layer and the nearest node of the line are taken for one node if no joint
  /// differs by more than this, rad.
  double same = 1e-6;
};

/// A path in several runs: the layers at which all runs but the last end, and the cost of all runs
/// with the lines at their ends and the joint moves between them.
struct CutPath {
  std::vector<int> ends;
  double cost = 0;
};

/// Cuts the path of a lattice into runs, by a layered dynamic program over copies of the lattice,
/// one for each number of cuts that are left. Nodes and edges count as valid, and lines as free,
/// until the cheapest path has them: then they are asked about, and the program is repaired. So its
/// values never exceed the costs of valid paths, and the first path found valid is the cheapest.
/// Between runs, and from and to home, joints move straight and freely; the roll of a six-joint arm
/// costs nothing there.
class CutProgram {
 public:
  /// An approach ends at a layer's nodes, a retract begins there.
  enum class LineKind : std::uint8_t { kApproach, kRetract };
  using MakeLine = std::function<CutLine(int layer, LineKind kind)>;
  /// What there is besides the lattice.
  struct Setting {
    std::vector<CutPlace> places;  ///< by layer; none in layer 0 and in the last one
    /// Where the joints come from before the first run, and go after the last one, rad.
    std::optional<Config> home_before, home_after;
    bool approach = false, retract = false;  ///< whether runs begin and end with lines
    MakeLine make_line;
  };
  /// All references must outlive this. Throws Stopped.
  CutProgram(const Lattice& lattice, Validity& validity, Setting setting, const Budget& budget);
  ~CutProgram();
  CutProgram(const CutProgram&) = delete;
  CutProgram& operator=(const CutProgram&) = delete;

  /// Returns the cheapest way to cut the path with a number of cuts, of several that cost the same
  /// the one with the latest cuts; none if there is no way. Throws Stopped.
  [[nodiscard]] std::optional<CutPath> best(int cuts);
  /// Returns the least number of cuts for which there is a best(); none where no number suffices.
  /// Throws Stopped.
  [[nodiscard]] std::optional<int> least_cuts();
  /// Allows no cut at a layer after which `left` others are left.
  void bar(int left, int layer);
  /// Returns the furthest layer that a run from a layer reaches, whatever it costs to begin and to
  /// end there; -1 where the layer has no valid node. Throws Stopped.
  [[nodiscard]] int reach(int layer);

 private:
  class FreeMoves;
  class Line;
  class Gate;
  struct Layer;
  struct Level;
  struct Way;
  void find_edges();
  /// Computes the values of a level from the layers that have changed.
  void compute(int left);
  void compute_layer(int left, int layer);
  /// Returns the gate at which a run may end, with as many cuts left as `left`, that one included;
  /// null where none may.
  [[nodiscard]] Gate* gate(int left, int layer);
  [[nodiscard]] std::optional<Way> trace(int cuts);
  /// Returns whether a number of cuts leads to the end from nodes from which no smaller number
  /// does. Where it does not, no larger number leads there from others.
  [[nodiscard]] bool adds_nodes(int cuts) const;
  bool ask_nodes(std::vector<NodeQuestion> questions);
  /// Asks what is not known of the runs of a way. Returns true if they are valid; else something is
  /// removed.
  bool ask_runs(const Way& way);
  /// Asks about the lines at the ends of runs likewise.
  bool ask_gates(const Way& way);

  const Lattice* lattice_;
  Validity* validity_;
  Setting setting_;
  Budget budget_;
  Verdicts verdicts_;
  std::vector<Layer> layers_;
  std::vector<std::unique_ptr<Level>> levels_;  // by the number of cuts left
};

}  // namespace swivel
