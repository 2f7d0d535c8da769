// SPDX-License-Identifier: BSD-3-Clause
#include "validity/hooked_validity.hpp"

#include <algorithm>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

void HookedValidity::nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) {
  first_->nodes(questions, answers);
  if (!check_) return;
  const TraceSpan span("check of states");
  states_.clear();
  const auto open = [&](std::size_t k) { return answers[k].valid && !questions[k].only_scene; };
  for (std::size_t k = 0; k < questions.size(); ++k)
    if (open(k)) states_.push_back(state(questions[k].layer, questions[k].slot, questions[k].q));
  auto allowed = check_.states(states_).begin();
  for (std::size_t k = 0; k < questions.size(); ++k)
    if (open(k)) answers[k].valid = *allowed++;
}

void HookedValidity::nodes_overlapped(std::span<const NodeQuestion> questions,
                                      std::span<NodeAnswer> answers,
                                      const std::function<void()>& work) {
  check_ ? Validity::nodes_overlapped(questions, answers, work)
         : first_->nodes_overlapped(questions, answers, work);
}

void HookedValidity::edges(std::span<const EdgeQuestion> questions,
                           std::span<std::uint8_t> answers) {
  if (first_->asks_edges())
    first_->edges(questions, answers);
  else
    std::fill(answers.begin(), answers.end(), std::uint8_t{1});
  if (check_ && lattice_->has_layers_between()) return check_layers_between(questions, answers);
  if (!check_.checks_motions()) return;
  const TraceSpan span("check of motions");
  motions_.clear();
  for (std::size_t k = 0; k < questions.size(); ++k)
    if (const EdgeQuestion& x = questions[k]; answers[k]) {
      const Config from = state(x.layer, x.a, x.qa);
      motions_.push_back({from, from + lattice_->delta(from, state(x.layer + 1, x.b, x.qb))});
    }
  auto allowed = check_.motions(motions_).begin();
  for (std::uint8_t& answer : answers)
    if (answer) answer = *allowed++ ? 1 : 0;
}

void HookedValidity::check_layers_between(std::span<const EdgeQuestion> questions,
                                          std::span<std::uint8_t> answers) {
  const TraceSpan span("check of layers between");
  for (std::size_t k = 0; k < questions.size(); ++k) {
    if (!answers[k]) continue;
    const EdgeQuestion& x = questions[k];
    const Config begin = state(x.layer, x.a, x.qa), end = state(x.layer + 1, x.b, x.qb);
    states_ = lattice_->interpolate_edge(x.layer, x.a, begin, x.b, end).rows;
    const auto allowed = check_.states(states_);
    bool passes = std::all_of(allowed.begin(), allowed.end(), [](auto one) { return one; });
    if (passes && check_.checks_motions()) {
      motions_.clear();
      Config from = begin;
      states_.push_back(end);
      for (const Config& row : states_) {
        const Config to = from + lattice_->delta(from, row);
        motions_.push_back({from, to});
        from = to;
      }
      const auto moves = check_.motions(motions_);
      passes = std::all_of(moves.begin(), moves.end(), [](auto one) { return one; });
    }
    answers[k] = passes ? 1 : 0;
  }
}

void HookedValidity::costs(std::span<const NodeQuestion> questions, std::span<double> costs) {
  const TraceSpan span("cost of states");
  if (cost_) {
    states_.clear();
    for (const NodeQuestion& question : questions)
      states_.push_back(state(question.layer, question.slot, question.q));
    cost_.costs(states_, costs);
  } else {
    std::fill(costs.begin(), costs.end(), 0.0);
  }
  if (!lattice_->has_node_costs()) return;
  for (std::size_t k = 0; k < questions.size(); ++k)
    costs[k] += lattice_->node_cost(questions[k].layer, questions[k].slot);
}

}  // namespace swivel
