// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis_text.hpp"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace swivel::cli {

namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

std::string range(double low, double high) {
  const std::string first = text("%.3g", low), last = text("%.3g", high);
  return first == last ? first : first + " to " + last;
}

double degrees(double angle) {
  return angle * 180 / kPi;
}

/// "no IK (out of reach by 3 mm)": by how much, over some layers of one reason.
std::string reason_text(const std::string& reason, const std::optional<Shortfall>& shortfall, double least, double most) {
  if (!shortfall) return reason;
  switch (shortfall->kind) {
    case Shortfall::Kind::kTooFar:
      return reason + " (out of reach by " + range(1e3 * least, 1e3 * most) + " mm)";
    case Shortfall::Kind::kTooNear:
      return reason + " (too near to the shoulder by " + range(1e3 * least, 1e3 * most) + " mm)";
    case Shortfall::Kind::kLowerLimit:
    case Shortfall::Kind::kUpperLimit:
      return reason + " (" + (reason == "joint " + shortfall->joint ? "" : shortfall->joint + ": ") +
             range(degrees(least), degrees(most)) + " deg beyond " + text("%.2f deg)", degrees(shortfall->limit));
  }
  return reason;
}

/// Layers, one after the other, that are empty for one reason.
struct Run {
  const EmptyLayer* first;
  const EmptyLayer* last;
  int first_waypoint = -1, last_waypoint = -1;
  double least = 0, most = 0;  // of the shortfalls

  explicit Run(const EmptyLayer& layer) : first(&layer), last(&layer) {
    if (layer.shortfall) least = most = layer.shortfall->by();
    add_waypoint(layer);
  }
  [[nodiscard]] bool takes(const EmptyLayer& layer) const {
    const auto &a = first->shortfall, &b = layer.shortfall;
    return layer.layer == last->layer + 1 && layer.reason == first->reason && a.has_value() == b.has_value() &&
           (!a || (a->kind == b->kind && a->joint == b->joint));
  }
  void add(const EmptyLayer& layer) {
    last = &layer;
    if (layer.shortfall) {
      least = std::min(least, layer.shortfall->by());
      most = std::max(most, layer.shortfall->by());
    }
    add_waypoint(layer);
  }
  void add_waypoint(const EmptyLayer& layer) {
    if (layer.waypoint < 0) return;
    if (first_waypoint < 0) first_waypoint = layer.waypoint;
    last_waypoint = layer.waypoint;
  }
  [[nodiscard]] std::string line() const {
    std::string line = first == last ? text("  layer %d", first->layer) : text("  layers %d to %d", first->layer, last->layer);
    if (first_waypoint >= 0)
      line += first_waypoint == last_waypoint ? text(" (waypoint %d)", first_waypoint)
                                              : text(" (waypoints %d to %d)", first_waypoint, last_waypoint);
    line += first == last ? text(", s = %.4f m", first->s) : text(", s = %.4f to %.4f m", first->s, last->s);
    return line + ": no valid node: " + reason_text(first->reason, first->shortfall, least, most) + '\n';
  }
};

}  // namespace

std::string diagnosis_text(const PlanResult& result) {
  const Diagnosis& d = result.diagnosis;
  if (d.reason.empty()) return "no path at this resolution; stopped before it was known what ends every one\n";
  const double by = d.shortfall ? d.shortfall->by() : 0;
  const std::string why = reason_text(d.reason, d.shortfall, by, by);
  std::string answer = d.reached_layer ? text("no path at this resolution: every one ends by layer %d of %d (s = %.4f m), where ",
                                              *d.reached_layer, result.lattice.layers - 1, *d.reached_s) +
                                             why + " stops it\n"
                                       : "no path at this resolution: the first layer has no valid node: " + why + '\n';
  std::vector<Run> runs;
  for (const EmptyLayer& layer : d.empty_layers) {
    if (!runs.empty() && runs.back().takes(layer))
      runs.back().add(layer);
    else
      runs.emplace_back(layer);
  }
  constexpr std::size_t kMostLines = 40;
  for (std::size_t k = 0; k < runs.size() && k < kMostLines; ++k) answer += runs[k].line();
  if (runs.size() > kMostLines) answer += text("  ... and %zu more, listed in --json\n", runs.size() - kMostLines);
  if (!d.complete && d.layers_known < result.lattice.layers)
    answer += text("  layers from %d on were not looked at\n", d.layers_known);
  return answer;
}

}  // namespace swivel::cli
