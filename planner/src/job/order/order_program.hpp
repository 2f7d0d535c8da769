// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "swivel/core/base/budget.hpp"

namespace swivel {

/// What it costs at least to run the strokes of a job in any order, by groups of the nodes at which
/// runs begin and end. Run 2 k is stroke k as it is listed, run 2 k + 1 is stroke k backwards. All
/// costs are >= 0, infinite where there is no way.
struct OrderGraph {
  struct Run {
    std::size_t begins = 0, ends = 0;  ///< number of groups; 0 of a run that is not allowed
    std::vector<double> through;       ///< [begin * ends + end]: of the run
    std::vector<double> first;         ///< [begin]: of beginning the job there
    std::vector<double> last;          ///< [end]: of ending the job there
  };
  std::size_t strokes = 0;
  std::vector<Run> runs;
  /// [run][next run][end * begins of the next + begin]: of going on with the next run; empty where
  /// one of the two is not allowed, and between the two runs of a stroke.
  std::vector<std::vector<std::vector<double>>> follow;
};

/// An order of strokes and the least cost of a job in it.
struct BoundedOrder {
  std::vector<std::size_t> strokes;
  double cost = 0;
  bool operator==(const BoundedOrder&) const = default;
};

/// The dynamic program over sets of strokes of Held and Karp (1962), with a value for each group of
/// begin nodes in place of one for each stroke: where a stroke ends decides what the next one
/// costs. Memory and time grow as 2^strokes.
class OrderProgram {
 public:
  /// `graph` must outlive it. Throws Stopped.
  OrderProgram(const OrderGraph& graph, const Budget& budget);

  /// Returns the least cost of any order, with the cheapest direction of each stroke; infinite
  /// where there is none.
  [[nodiscard]] double least() const { return least_; }
  /// Returns the orders that cost less than `most`, with the cheapest directions of their strokes:
  /// the cheapest `count` of them, the cheapest first, of equal ones the first in the order of
  /// stroke numbers. Throws Stopped.
  [[nodiscard]] std::vector<BoundedOrder> cheaper_than(double most, std::size_t count) const;
  /// The least cost of any order that uses a group, by run and group.
  struct Uses {
    std::vector<std::vector<double>> begins, ends;
  };
  /// Throws Stopped.
  [[nodiscard]] Uses uses() const;

 private:
  using Set = std::size_t;  // bit k: stroke k
  [[nodiscard]] Set all() const { return (Set{1} << graph_->strokes) - 1; }
  [[nodiscard]] double* rest(Set set, std::size_t run) {
    return rest_.data() + set * begins_ + first_begin_[run];
  }
  [[nodiscard]] const double* rest(Set set, std::size_t run) const {
    return rest_.data() + set * begins_ + first_begin_[run];
  }
  [[nodiscard]] double* leave(Set set, std::size_t run) {
    return leave_.data() + set * ends_ + first_end_[run];
  }
  [[nodiscard]] const double* leave(Set set, std::size_t run) const {
    return leave_.data() + set * ends_ + first_end_[run];
  }
  /// The first strokes of orders, and the least cost of an order that begins with them.
  struct Begun {
    double cost = 0;
    std::vector<std::size_t> strokes;
    Set left = 0;  // the strokes that are left to run, the last of `strokes` among them
    std::array<std::vector<double>, 2> reach;  // [direction of the last][begin]: cost before it
    /// For std::priority_queue, whose greatest item comes first.
    bool operator<(const Begun& other) const {
      return cost != other.cost ? cost > other.cost : strokes > other.strokes;
    }
  };
  using Done = std::array<std::vector<double>, 2>;  // [direction][end]: cost with the last stroke
  void compute(Set set);
  void bound(Begun& begun) const;
  /// Returns the orders that go on with the stroke `next`.
  [[nodiscard]] Begun with_stroke(const Begun& begun, const Done& done, std::size_t next) const;

  const OrderGraph* graph_;
  Budget budget_;
  std::vector<std::size_t> first_begin_, first_end_;  // by run
  std::size_t begins_ = 0, ends_ = 0;                 // of all runs
  /// [set][begin]: of running the strokes of the set, the run of that begin first.
  std::vector<double> rest_;
  /// [set][end]: of going on from there with the strokes of the set, which that of the end is not
  /// in.
  std::vector<double> leave_;
  double least_ = 0;
};

}  // namespace swivel
