// SPDX-License-Identifier: BSD-3-Clause
#include "measure/first_clearance_violation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace swivel {

namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();

/// The rows, and moves between them, that distance proofs leave open, pair by pair. A pair that is
/// clear at a row by more than it must keep stays clear along the rows until its bodies can have
/// used up the difference: one proof serves many rows, and a far pair needs few.
class OpenParts {
 public:
  std::vector<bool> rows, moves;  ///< a row; the move from it to the next

  OpenParts(const World& world, World::Query& query, const EdgeRule& rule, const Limits& limits,
            const std::vector<Config>& joints, const Budget& budget)
      : rows(joints.size(), false),
        moves(joints.size() - 1, false),
        joints_(&joints),
        query_(&query),
        budget_(&budget),
        asks_moves_(limits.edges == EdgeMode::kContinuous) {
    add_travel(world, rule);
    add_pairs(world, rule);
    const std::size_t last = joints.size() - 1;
    std::vector<OpenRun> runs;
    for (std::size_t pair = 0; pair < pairs_.size(); ++pair)
      runs.push_back({pair, 0, last, at_end(pair, 0, last), kNever});
    for (OpenRun& run : runs) {
      run.first = forward(run.pair, 0, last, run.clear_first);
      run.clear_first -= travel(run.pair, 0, run.first);
    }
    std::erase_if(runs, [&](const OpenRun& run) { return run.first == last; });
    for (OpenRun& run : runs) {
      run.clear_last = at_end(run.pair, last, last - run.first);
      run.last = backward(run.pair, run.first, last, run.clear_last);
      run.clear_last -= travel(run.pair, run.last, last);
    }
    std::erase_if(runs, [](const OpenRun& run) { return run.first == run.last; });
    settle(0, last, runs);
  }

 private:
  struct Pair {
    int a = 0, b = 0;               // bodies
    double row = 0, move = kNever;  // required clearances, m
    int moving = 0;                 // how many of the two bodies move
    int first_joint = 0, last = 0;  // joints that move them against each other
    [[nodiscard]] double both() const { return std::max(row, move); }
    [[nodiscard]] double least() const { return move < 0 ? row : std::min(row, move); }
  };
  /// A run of rows of one pair, from row `first` to row `last`, of which all moves are open and the
  /// rows between the two, but not these two. The pair's clearances at both are at least
  /// clear_first and clear_last, m.
  struct OpenRun {
    std::size_t pair, first, last;
    double clear_first, clear_last;
  };

  /// Sums up how far bodies come from row to row: on the chord, and off the chord by no more than
  /// an eighth of the acceleration, which is at most 2 sum |dq_j| sum |dq_j| R_j over all joints
  /// that move a body, followers of the chain included.
  void add_travel(const World& world, const EdgeRule& rule) {
    bodies_ = world.bodies().size();
    for (std::size_t k = 0; k < joints_->size(); ++k) {
      if (k % 64 == 0) budget_->poll();
      const std::span<const double> moved = query_->accumulated_displacement((*joints_)[k]);
      moved_.insert(moved_.end(), moved.begin(),
                    moved.begin() + static_cast<std::ptrdiff_t>(bodies_));
      if (k == 0) {
        turned_.push_back({});
        off_chords_.push_back(0);
        continue;
      }
      const Config move = ((*joints_)[k] - (*joints_)[k - 1]).cwiseAbs();
      std::array<double, kDof> turned = turned_.back();
      double bound = 0;
      for (int j = 0; j < kDof; ++j) {
        const double way = move[j] * rule.radii[static_cast<std::size_t>(j)];
        turned[static_cast<std::size_t>(j)] += way;
        bound += way;
      }
      turned_.push_back(turned);
      double followers = 0;
      for (int j = 0; j < kDof; ++j)
        followers += move[j] * rule.followers.turns[static_cast<std::size_t>(j)];
      off_chords_.push_back(off_chords_.back() + (joint_sum(move) + followers) * bound / 4);
    }
  }

  void add_pairs(const World& world, const EdgeRule& rule) {
    const auto group = [&](int body) {
      return static_cast<std::size_t>(body) < bodies_
                 ? world.bodies()[static_cast<std::size_t>(body)].group
                 : 0;
    };
    for (std::size_t k = 0; k < world.pairs().size(); ++k) {
      const BodyPair& bodies = world.pairs()[k];
      const int of_a = group(bodies.a), of_b = group(bodies.b);
      const Chain::Joints joints = world.joints_between(bodies);
      Pair pair{bodies.a,
                bodies.b,
                world.required(k, ClearanceRule::kNode),
                kNever,
                (of_a > 0) + (of_b > 0),
                joints.first,
                joints.last};
      if (asks_moves_) pair.move = world.required(k, ClearanceRule::kMidpoint);
      for (const EdgeRule::Near& near : rule.near)
        if (asks_moves_ && near.pair == bodies) pair.move = near.d_edge + near.h;
      pairs_.push_back(pair);
    }
  }

  [[nodiscard]] double moved(int body, std::size_t from, std::size_t to) const {
    const auto i = static_cast<std::size_t>(body);
    return i < bodies_ ? moved_[to * bodies_ + i] - moved_[from * bodies_ + i] : 0;
  }
  [[nodiscard]] double turned(const Pair& pair, std::size_t from, std::size_t to) const {
    double way = 0;
    for (auto j = static_cast<std::size_t>(pair.first_joint);
         j < static_cast<std::size_t>(pair.last); ++j)
      way += turned_[to][j] - turned_[from][j];
    return way;
  }
  /// Returns an upper bound, m, of how much nearer the pair's bodies come anywhere between two
  /// rows.
  [[nodiscard]] double travel(std::size_t pair, std::size_t from, std::size_t to) const {
    const Pair& p = pairs_[pair];
    const double chords = moved(p.a, from, to) + moved(p.b, from, to) +
                          p.moving * (off_chords_[to] - off_chords_[from]);
    return std::min(chords, turned(p, from, to));
  }
  /// Returns the last row up to which the pair stays clear if its clearance at `first` is `clear`,
  /// m.
  [[nodiscard]] std::size_t forward(std::size_t pair, std::size_t first, std::size_t last,
                                    double clear) const {
    std::size_t far = first, open = last + 1;
    while (open - far > 1) {
      const std::size_t middle = (far + open) / 2;
      (clear - travel(pair, first, middle) >= pairs_[pair].both() ? far : open) = middle;
    }
    return far;
  }
  [[nodiscard]] std::size_t backward(std::size_t pair, std::size_t first, std::size_t last,
                                     double clear) const {
    std::size_t far = last, open = first;  // row `first` is known
    if (clear - travel(pair, first, last) >= pairs_[pair].both()) return first;
    while (far - open > 1) {
      const std::size_t middle = (far + open) / 2;
      (clear - travel(pair, middle, last) >= pairs_[pair].both() ? far : open) = middle;
    }
    return far;
  }

  /// Returns a lower bound of the pair's clearance at q, m, which is sought no further than a
  /// travel of `need`, m, requires.
  double clear_at(std::size_t pair, const Config& q, double need) {
    constexpr double kFurthest = 0.1;  // m; between meshes a large clearance takes long to prove
    const Pair& p = pairs_[pair];
    return query_->clearance_lower_bound(q, pair, p.least(), p.both() + std::min(need, kFurthest));
  }
  double at_row(std::size_t pair, std::size_t row, double need) {
    const double clear = clear_at(pair, (*joints_)[row], need);
    if (!(clear >= pairs_[pair].row)) rows[row] = true;
    return clear;
  }
  double at_end(std::size_t pair, std::size_t row, std::size_t other) {
    return at_row(pair, row, travel(pair, std::min(row, other), std::max(row, other)));
  }

  /// Closes runs, or parts of runs, that lie between these two rows; marks what stays open.
  void settle(std::size_t first, std::size_t last, const std::vector<OpenRun>& runs) {
    if (runs.empty()) return;
    budget_->poll();
    if (last == first + 1) {
      for (const OpenRun& run : runs)
        if (asks_moves_ && !moves[first] && !closes(run)) moves[first] = true;
      return;
    }
    const std::size_t middle = (first + last) / 2;
    std::vector<OpenRun> before, after;
    for (const OpenRun& s : runs) {
      if (s.last <= middle) {
        before.push_back(s);
      } else if (s.first >= middle) {
        after.push_back(s);
      } else {
        const double clear =
            at_row(s.pair, middle,
                   std::max(travel(s.pair, s.first, middle), travel(s.pair, middle, s.last)));
        const std::size_t from = backward(s.pair, s.first, middle, clear),
                          to = forward(s.pair, middle, s.last, clear);
        if (from > s.first)
          before.push_back(
              {s.pair, s.first, from, s.clear_first, clear - travel(s.pair, from, middle)});
        if (to < s.last)
          after.push_back({s.pair, to, s.last, clear - travel(s.pair, middle, to), s.clear_last});
      }
    }
    settle(first, middle, before);
    settle(middle, last, after);
  }

  /// Returns true if distance proofs close a run of one move.
  bool closes(const OpenRun& s) {
    const std::size_t k = s.first;
    if (reaches(s.pair, k, 1, s.clear_first, s.clear_last)) return true;
    const double need = travel(s.pair, k, k + 1);
    const double at_first = std::max(s.clear_first, clear_at(s.pair, (*joints_)[k], need));
    if (reaches(s.pair, k, 1, at_first, s.clear_last)) return true;
    const double at_last = std::max(s.clear_last, clear_at(s.pair, (*joints_)[k + 1], need));
    return closes(s.pair, k, 0, 1, at_first, at_last);
  }
  bool closes(std::size_t pair, std::size_t k, double from, double to, double clear_from,
              double clear_to) {
    constexpr double kLeastPart = 1. / 8;  // of the move; FCL decides what is left
    if (reaches(pair, k, to - from, clear_from, clear_to)) return true;
    if (to - from <= kLeastPart) return false;
    const double middle = (from + to) / 2;
    const Config q = (*joints_)[k] + middle * ((*joints_)[k + 1] - (*joints_)[k]);
    const double clear = clear_at(pair, q, travel(pair, k, k + 1));
    return clear >= pairs_[pair].move && closes(pair, k, from, middle, clear_from, clear) &&
           closes(pair, k, middle, to, clear, clear_to);
  }
  /// Returns true if the clearances at both ends of a share of a move prove that the pair keeps
  /// what it must on all of it.
  [[nodiscard]] bool reaches(std::size_t pair, std::size_t k, double share, double clear_from,
                             double clear_to) const {
    const Pair& p = pairs_[pair];
    const double slack = clear_from + clear_to - 2 * p.move;
    // both ends may lie off the chord
    const double off_chord = 2 * p.moving * (off_chords_[k + 1] - off_chords_[k]);
    return slack >= share * turned(p, k, k + 1) ||
           slack >= share * (moved(p.a, k, k + 1) + moved(p.b, k, k + 1)) + 2 * off_chord;
  }

  const std::vector<Config>* joints_;
  World::Query* query_;
  const Budget* budget_;
  bool asks_moves_;
  std::size_t bodies_ = 0;  // of the robot
  std::vector<Pair> pairs_;
  // Sums up to each row: moved_ by body, turned_ by joint for any point.
  std::vector<double> moved_, off_chords_;
  std::vector<std::array<double, kDof>> turned_;
};

}  // namespace

std::optional<ClearanceViolation> first_clearance_violation(const World& world,
                                                            const EdgeRule& rule,
                                                            const Limits& limits,
                                                            const std::vector<Config>& rows,
                                                            const Budget& budget) {
  if (rows.empty()) return std::nullopt;
  World::Query query(world, DistanceProofs::kOn);
  const OpenParts open(world, query, rule, limits, rows, budget);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    budget.poll();
    if (open.rows[k])
      if (const auto pair = query.find_violating_pair_incremental(rows[k], ClearanceRule::kNode))
        return ClearanceViolation{k, *pair};
    if (k > 0 && open.moves[k - 1])
      if (const auto pair = edge_blocked(query, rule, rows[k - 1], rows[k], budget))
        return ClearanceViolation{k, *pair, true};
  }
  return std::nullopt;
}

}  // namespace swivel
