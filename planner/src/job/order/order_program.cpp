// SPDX-License-Identifier: BSD-3-Clause
#include "job/order/order_program.hpp"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

namespace swivel {

namespace {

constexpr double kNoWay = std::numeric_limits<double>::infinity();

/// Lowers to[a] to the least of from[b] + matrix[a * size of from + b] over all b, for all a.
void lower_rows(const std::vector<double>& matrix, const double* from, std::size_t size,
                std::size_t rows, double* to) {
  const double* row = matrix.data();
  for (std::size_t a = 0; a < rows; ++a, row += size) {
    double least = to[a];
    for (std::size_t b = 0; b < size; ++b) least = std::min(least, row[b] + from[b]);
    to[a] = least;
  }
}

/// Lowers to[b] to the least of from[a] + matrix[a * size of to + b] over all a, for all b.
void lower_columns(const std::vector<double>& matrix, const double* from, std::size_t rows,
                   std::size_t size, double* to) {
  const double* row = matrix.data();
  for (std::size_t a = 0; a < rows; ++a, row += size) {
    if (from[a] == kNoWay) continue;
    for (std::size_t b = 0; b < size; ++b) to[b] = std::min(to[b], row[b] + from[a]);
  }
}

}  // namespace

OrderProgram::OrderProgram(const OrderGraph& graph, const Budget& budget)
    : graph_(&graph), budget_(budget), least_(kNoWay) {
  for (const OrderGraph::Run& run : graph.runs) {
    first_begin_.push_back(begins_);
    first_end_.push_back(ends_);
    begins_ += run.begins;
    ends_ += run.ends;
  }
  rest_.assign((all() + 1) * begins_, kNoWay);
  leave_.assign((all() + 1) * ends_, kNoWay);
  for (std::size_t run = 0; run < graph.runs.size(); ++run)
    std::copy(graph.runs[run].last.begin(), graph.runs[run].last.end(), leave(0, run));
  for (Set set = 1; set <= all(); ++set) {
    budget.poll();
    compute(set);
  }
  for (std::size_t run = 0; run < graph.runs.size(); ++run)
    for (std::size_t begin = 0; begin < graph.runs[run].begins; ++begin)
      least_ = std::min(least_, graph.runs[run].first[begin] + rest(all(), run)[begin]);
}

void OrderProgram::compute(Set set) {
  const std::vector<OrderGraph::Run>& runs = graph_->runs;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const Set bit = Set{1} << run / 2;
    if ((set & bit) != 0)
      lower_rows(runs[run].through, leave(set & ~bit, run), runs[run].ends, runs[run].begins,
                 rest(set, run));
  }
  for (std::size_t run = 0; run < runs.size(); ++run)
    if ((set >> run / 2 & 1) == 0)
      for (std::size_t next = 0; next < runs.size(); ++next)
        if ((set >> next / 2 & 1) != 0 && !graph_->follow[run][next].empty())
          lower_rows(graph_->follow[run][next], rest(set, next), runs[next].begins, runs[run].ends,
                     leave(set, run));
}

void OrderProgram::bound(Begun& begun) const {
  begun.cost = kNoWay;
  for (std::size_t turned = 0; turned < 2; ++turned) {
    const double* const onward = rest(begun.left, 2 * begun.strokes.back() + turned);
    for (std::size_t k = 0; k < begun.reach[turned].size(); ++k)
      begun.cost = std::min(begun.cost, begun.reach[turned][k] + onward[k]);
  }
}

OrderProgram::Begun OrderProgram::with_stroke(const Begun& begun, const Done& done,
                                              std::size_t next) const {
  const std::size_t last = begun.strokes.back();
  Begun more{kNoWay, begun.strokes, begun.left & ~(Set{1} << last), {}};
  more.strokes.push_back(next);
  for (std::size_t turned = 0; turned < 2; ++turned) {
    std::vector<double>& reach = more.reach[turned];
    reach.assign(graph_->runs[2 * next + turned].begins, kNoWay);
    for (std::size_t before = 0; before < 2; ++before) {
      const std::vector<double>& follow = graph_->follow[2 * last + before][2 * next + turned];
      if (!follow.empty())
        lower_columns(follow, done[before].data(), done[before].size(), reach.size(), reach.data());
    }
  }
  bound(more);
  return more;
}

std::vector<BoundedOrder> OrderProgram::cheaper_than(double most, std::size_t count) const {
  const std::vector<OrderGraph::Run>& runs = graph_->runs;
  std::priority_queue<Begun> open;
  const auto add = [&](Begun begun) {
    if (begun.cost < most) open.push(std::move(begun));
  };
  for (std::size_t stroke = 0; stroke < graph_->strokes; ++stroke) {
    Begun begun{kNoWay, {stroke}, all(), {runs[2 * stroke].first, runs[2 * stroke + 1].first}};
    bound(begun);
    add(std::move(begun));
  }
  std::vector<BoundedOrder> found;
  while (!open.empty() && found.size() < count) {
    budget_.poll();
    const Begun begun = open.top();
    open.pop();
    const std::size_t last = begun.strokes.back();
    const Set left = begun.left & ~(Set{1} << last);
    if (left == 0) {
      found.push_back({begun.strokes, begun.cost});
      continue;
    }
    Done done;
    for (std::size_t turned = 0; turned < 2; ++turned) {
      const OrderGraph::Run& run = runs[2 * last + turned];
      done[turned].assign(run.ends, kNoWay);
      lower_columns(run.through, begun.reach[turned].data(), run.begins, run.ends,
                    done[turned].data());
    }
    for (std::size_t next = 0; next < graph_->strokes; ++next)
      if ((left >> next & 1) != 0) add(with_stroke(begun, done, next));
  }
  return found;
}

OrderProgram::Uses OrderProgram::uses() const {
  const std::vector<OrderGraph::Run>& runs = graph_->runs;
  // reach[set][begin]: the least cost of what comes before a begin from which the strokes of the
  // set are left to run, its own among them
  std::vector<double> reach((all() + 1) * begins_, kNoWay), done(ends_);
  Uses uses;
  for (const OrderGraph::Run& run : runs) {
    uses.begins.emplace_back(run.begins, kNoWay);
    uses.ends.emplace_back(run.ends, kNoWay);
  }
  const auto at = [&](Set set, std::size_t run) {
    return reach.data() + set * begins_ + first_begin_[run];
  };
  for (std::size_t run = 0; run < runs.size(); ++run)
    std::copy(runs[run].first.begin(), runs[run].first.end(), at(all(), run));
  for (Set set = all(); set > 0; --set) {
    budget_.poll();
    for (std::size_t run = 0; run < runs.size(); ++run) {
      const Set bit = Set{1} << run / 2, left = set & ~bit;
      if ((set & bit) == 0 || runs[run].begins == 0) continue;
      const double* const before = at(set, run);
      for (std::size_t k = 0; k < runs[run].begins; ++k)
        uses.begins[run][k] = std::min(uses.begins[run][k], before[k] + rest(set, run)[k]);
      done.assign(runs[run].ends, kNoWay);
      lower_columns(runs[run].through, before, runs[run].begins, runs[run].ends, done.data());
      for (std::size_t k = 0; k < runs[run].ends; ++k)
        uses.ends[run][k] = std::min(uses.ends[run][k], done[k] + leave(left, run)[k]);
      for (std::size_t next = 0; next < runs.size(); ++next)
        if ((left >> next / 2 & 1) != 0 && !graph_->follow[run][next].empty())
          lower_columns(graph_->follow[run][next], done.data(), runs[run].ends, runs[next].begins,
                        at(left, next));
    }
  }
  return uses;
}

}  // namespace swivel
