// SPDX-License-Identifier: BSD-3-Clause
#include "page/page_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "page/packed.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/timing/time_path.hpp"

namespace swivel::detail {

namespace {

constexpr double kSeen = 1e-3;  ///< rad or m: a smaller difference of a joint is not seen

}  // namespace

bool may_turn(const Lattice& lattice) {
  const auto grid = lattice.describe().grid;
  return grid && grid->rolls;
}

std::vector<PageRow> placed(const Lattice& lattice, const LatticeMap& map,
                            const std::vector<TrajectoryRow>& rows, const std::vector<int>& slots) {
  const bool turned = may_turn(lattice);
  const ToolPath& path = lattice.path_of_rows();
  std::vector<TrajectoryRow> counted = rows;  // as the map has its angles
  count_from_path(lattice.chain(), path, counted);
  const std::vector<double> turns = rolls_of(counted);
  std::vector<PageRow> shown;
  std::size_t knot = 0;  // the layer of the lattice at the row, or before it
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto layer_of = [&](std::size_t k) {
      return static_cast<std::size_t>(lattice.layer_of_rows(static_cast<int>(k)));
    };
    if (knot + 1 < slots.size() && layer_of(knot + 1) <= i) ++knot;
    PageRow row{rows[i], static_cast<double>(knot)};
    if (const std::size_t first = layer_of(knot); i > first) {
      const std::size_t last = layer_of(knot + 1);
      const auto s = [&](std::size_t layer) { return path.layer(static_cast<int>(layer)).s; };
      const auto count = static_cast<double>(i - first) / static_cast<double>(last - first);
      row.layer += s(last) > s(first) ? (s(i) - s(first)) / (s(last) - s(first)) : count;
    }
    const double value = map.value_at(counted[i].phi, counted[i].q);
    row.angle = map.place(value);
    if (map.joint >= 0) row.joint = value;
    row.solution = map.path[knot] / map.angles;
    if (turned) row.roll = turns[i];
    if (const int branch = row.at.branch; row.solution / map.windings != branch) {
      row.solution = branch * map.windings;
      double least = std::numeric_limits<double>::infinity();
      for (int solution = row.solution, end = solution + map.windings;
           map.grid() && !turned && solution < end; ++solution) {
        const int cell = static_cast<int>(std::lround(row.angle)) % map.angles;
        const auto node = lattice.node(static_cast<int>(i), solution * map.angles + cell);
        if (!node) continue;
        const double away = joint_norm(*node - row.at.q);
        if (away < least) least = away, row.solution = solution;
      }
    }
    shown.push_back(std::move(row));
  }
  return shown;
}

namespace {

/// Returns how far the tool leaves its path on the way from each row to the next, in mm: one number
/// less than there are rows.
std::vector<double> errors_mm(const Lattice& lattice, const std::vector<PageRow>& rows) {
  std::vector<double> errors;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const Config &from = rows[i].at.q, &to = rows[i + 1].at.q;
    double most = 0;
    for (const double error : path_deviation(lattice.chain(), lattice.path_of_rows(),
                                             static_cast<int>(i), from, to - from))
      most = std::max(most, 1e3 * error);
    errors.push_back(most);
  }
  return errors;
}

}  // namespace

Json place_json(const PageRow& row) {
  Json json = {{"layer", row.layer},
               {"phi", row.joint.value_or(row.at.phi)},
               {"sheet", row.solution},
               {"angle", row.angle}};
  if (row.roll) json["roll"] = *row.roll;
  return json;
}

Json rows_json(const World& world, const Lattice& lattice, const std::vector<PageRow>& shown,
               const Budget& budget) {
  World::Query query(world, DistanceProofs::kOn);
  const std::vector<double> errors = errors_mm(lattice, shown);
  Json rows = Json::array();
  for (std::size_t i = 0; i < shown.size(); ++i) {
    budget.poll();
    const TrajectoryRow& at = shown[i].at;
    Json row = place_json(shown[i]);
    row["s"] = at.s;
    row["q"] = std::vector<double>(at.q.data(), at.q.data() + kDof);
    row["error_mm"] = i < errors.size() ? Json(errors[i]) : Json(nullptr);
    if (const auto clearance = query.clearance(at.q)) {
      row["clearance_mm"] = 1e3 * clearance->distance;
      row["pair"] = {world.body_names()[clearance->pair.a], world.body_names()[clearance->pair.b]};
      if (const auto points = query.nearest_points(at.q, *clearance)) {
        // Within 0.1 mm anyway.
        const auto drawn = [](double x) { return std::round(1e6 * x) / 1e6; };
        row["nearest"] = Json::array();
        for (const Vector3d& point : *points)
          for (const double x : point) row["nearest"].push_back(drawn(x));
      } else {
        row["nearest"] = nullptr;
      }
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void NearBodies::add(const std::string& name, double distance, const std::string& other) {
  const auto [known, is_new] = by_name.try_emplace(name, Nearest{distance, other});
  if (!is_new && distance < known->second.distance) known->second = {distance, other};
}

void NearBodies::add(const World& world, World::Query& query, const Config& q) {
  const std::vector<std::string>& bodies = world.body_names();
  const auto found = query.body_clearances(q);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!found[k]) continue;
    const std::array<std::string, 2> pair = world.names(found[k]->pair);
    add(bodies[k], found[k]->distance, pair[pair[0] == bodies[k] ? 1 : 0]);
  }
}

Json near_json(const std::vector<NearBodies>& rows) {
  constexpr double kGrain = 1e-6;  // m
  constexpr double kMost = std::numeric_limits<std::int32_t>::max() / 4;
  Json names = Json::array();
  std::map<std::string, std::int32_t> index;
  std::vector<std::int32_t> distances, others;
  for (const NearBodies& row : rows) {
    if (index.empty())
      for (const auto& [name, near] : row.by_name) {
        index.emplace(name, static_cast<std::int32_t>(names.size()));
        names.push_back(name);
      }
    for (const auto& [name, near] : row.by_name) {
      distances.push_back(
          static_cast<std::int32_t>(std::lround(std::min(near.distance / kGrain, kMost))));
      others.push_back(index.at(near.other));
    }
  }
  return {{"names", names},
          {"distance", Json::binary(encode_samples(distances, names.size()))},
          {"other", Json::binary(encode_samples(others, names.size()))}};
}

Json near_json(const World& world, const std::vector<PageRow>& rows, const Budget& budget) {
  World::Query query(world, DistanceProofs::kOn);
  std::vector<NearBodies> near(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    budget.poll();
    near[k].add(world, query, rows[k].at.q);
  }
  return near_json(near);
}

Json beside_json(const std::vector<PageRow>& path, const std::vector<PageRow>& shown) {
  const auto same = [](const PageRow& a, const PageRow& b) {
    return (a.at.q - b.at.q)
               .unaryExpr([](double way) { return std::abs(std::remainder(way, kTwoPi)); })
               .maxCoeff() < kSeen;
  };
  Json json = Json::array();
  if (std::equal(path.begin(), path.end(), shown.begin(), shown.end(), same)) return json;
  for (const PageRow& row : path) json.push_back(place_json(row));
  return json;
}

Json tool_path_json(const ToolPath& path) {
  Json points = Json::array();
  for (int layer = 0; layer < path.size(); ++layer)
    points.push_back(vector_json(path.layer(layer).tool.translation()));
  return points;
}

std::vector<TrajectoryRow> rows_of(const Lattice& lattice, std::vector<int> slots) {
  std::vector<TrajectoryRow> rows;
  for (; !slots.empty() && rows.empty(); slots.pop_back()) rows = lattice.path_rows(slots);
  return rows;
}

Json settings_json(const PathProblem& problem, const Lattice& lattice) {
  return {{"ds", problem.resolution.ds},
          {"dphi", problem.resolution.dphi},
          {"clearance_mm", 1e3 * problem.limits.clearance},
          {"joint_step",
           lattice.has_layers_between() ? Json(nullptr) : Json(problem.limits.joint_step)},
          {"edges", problem.limits.edges == EdgeMode::kContinuous ? "continuous" : "nodes"}};
}

std::vector<double> places_of(std::span<const TimedRow> samples,
                              const std::vector<TrajectoryRow>& rows, const ToolPath* path) {
  std::vector<double> places;
  std::size_t step = 0;
  for (const TimedRow& sample : samples) {
    // The step is found by s, or by the joints where nothing but they tell it.
    double share = 0;
    for (;; ++step) {
      const double length = path == nullptr ? 0 : path->layer(static_cast<int>(step)).step_length;
      const Config way = rows[step + 1].q - rows[step].q;
      if (length > 0)
        share = (sample.row.s - path->layer(static_cast<int>(step)).s) / length;
      else if (joint_squared_norm(way) > 0)
        share = joint_dot(sample.row.q - rows[step].q, way) / joint_squared_norm(way);
      else
        share = 0;
      if (share < 1 || step + 2 >= rows.size()) break;
    }
    places.push_back(static_cast<double>(step) + std::clamp(share, 0.0, 1.0));
  }
  return places;
}

std::vector<TrajectoryRow> passed_rows(std::vector<TrajectoryRow> rows,
                                       std::span<const TimedRow> samples,
                                       const std::vector<double>& places) {
  std::size_t next = 0;  // the first sample at a row or beyond it, or the last of all
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto place = static_cast<double>(i);
    while (next + 1 < samples.size() && places[next] < place) ++next;
    const std::size_t last = next > 0 ? next - 1 : 0;
    const double way = places[next] - places[last],
                 share = way > 0 ? std::clamp((place - places[last]) / way, 0.0, 1.0) : 1;
    const TrajectoryRow &from = samples[last].row, &to = samples[next].row;
    const Config q = from.q + share * (to.q - from.q);
    if ((q - rows[i].q).cwiseAbs().maxCoeff() < kSeen) continue;
    rows[i].q = q;
    rows[i].phi = from.phi + share * wrap_angle(to.phi - from.phi);
    rows[i].roll = from.roll + share * wrap_angle(to.roll - from.roll);
    rows[i].branch = (share < 0.5 ? from : to).branch;
  }
  return rows;
}

namespace {

/// Returns the joints of a motion's samples, or of `most` that follow each other evenly, for the
/// page to play: in steps of `unit` rad or m, `dt` seconds apart.
Json played_joints(const std::vector<TimedRow>& samples, double rate, std::size_t most) {
  constexpr double kUnit = 1e-7, kMost = std::numeric_limits<std::int32_t>::max() / 4;
  const std::size_t each = samples.size() / most + 1;
  std::vector<std::int32_t> values;
  const auto add = [&](const TimedRow& sample) {
    for (const double q : sample.row.q.coordinates())
      values.push_back(
          static_cast<std::int32_t>(std::lround(std::clamp(q / kUnit, -kMost, kMost))));
  };
  for (std::size_t k = 0; k < samples.size(); k += each) add(samples[k]);
  if ((samples.size() - 1) % each != 0) add(samples.back());
  return {{"unit", kUnit},
          {"dt", static_cast<double>(each) / rate},
          {"values", Json::binary(encode_samples(values, kDof))}};
}

}  // namespace

Json motion_json(const std::vector<TimedRow>& samples, double rate, const JointRates& rates,
                 const Chain& chain, const std::vector<double>& places) {
  constexpr std::size_t kMost = 2000, kMostPlayed = 20'000;
  const auto n = static_cast<std::ptrdiff_t>(samples.size());
  const auto q = [&](std::ptrdiff_t k) -> const Config& {  // at rest before and after
    return samples[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n - 1))].row.q;
  };
  const std::ptrdiff_t each = n / static_cast<std::ptrdiff_t>(kMost) + 1;
  Json t = Json::array(), layers = Json::array(), tool = Json::array(),
       ratios[3] = {Json::array(), Json::array(), Json::array()};
  std::array<double, 3> most{};
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const Config move = q(k) - q(k - 1), before = q(k - 1) - q(k - 2), first = q(k - 2) - q(k - 3);
    for (int j = 0; j < kDof; ++j) {
      most[0] = std::max(most[0], std::abs(move[j]) * rate / rates.speed[j]);
      most[1] = std::max(most[1],
                         std::abs(move[j] - before[j]) * std::pow(rate, 2) / rates.acceleration[j]);
      most[2] = std::max(most[2], std::abs(move[j] - 2 * before[j] + first[j]) * std::pow(rate, 3) /
                                      rates.jerk[j]);
    }
    if (k % each != 0 && k + 1 < n) continue;
    t.push_back(samples[static_cast<std::size_t>(k)].t);
    layers.push_back(places[static_cast<std::size_t>(k)]);
    tool.push_back(1e3 * rate *
                   (chain.tool(q(k)).translation() - chain.tool(q(k - 1)).translation()).norm());
    for (std::size_t order = 0; order < 3; ++order) ratios[order].push_back(100 * most[order]);
    most = {};
  }
  return {{"t", std::move(t)},
          {"layers", std::move(layers)},
          {"tool_mm_s", std::move(tool)},
          {"speed", std::move(ratios[0])},
          {"acceleration", std::move(ratios[1])},
          {"jerk", std::move(ratios[2])},
          {"joints", played_joints(samples, rate, kMostPlayed)}};
}

}  // namespace swivel::detail
