// SPDX-License-Identifier: BSD-3-Clause
#include "page/page_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "page/packed.hpp"
#include "swivel/core/timing/time_path.hpp"

namespace swivel::detail {

bool may_turn(const Lattice& lattice) {
  const auto grid = lattice.describe().grid;
  return grid && grid->rolls;
}

std::vector<PageRow> placed(const Lattice& lattice, const LatticeMap& map,
                            const std::vector<TrajectoryRow>& rows, const std::vector<int>& slots) {
  const bool turned = may_turn(lattice);
  const std::vector<double> turns = rolls_of(rows);
  const ToolPath& path = lattice.path_of_rows();
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
    row.angle = map.place(row.at.phi);
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
        const double away = (*node - row.at.q).norm();
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

/// Returns the place of a row in the map.
Json place_json(const PageRow& row) {
  Json json = {
      {"layer", row.layer}, {"phi", row.at.phi}, {"sheet", row.solution}, {"angle", row.angle}};
  if (row.roll) json["roll"] = *row.roll;
  return json;
}

}  // namespace

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
    row["q"] = std::vector<double>(at.q.begin(), at.q.end());
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

Json beside_json(const std::vector<PageRow>& rows) {
  Json json = Json::array();
  for (const PageRow& row : rows) json.push_back(place_json(row));
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

Json settings_json(const Problem& problem, const Lattice& lattice) {
  return {{"ds", problem.resolution.ds},
          {"dphi", problem.resolution.dphi},
          {"clearance_mm", 1e3 * problem.limits.clearance},
          {"joint_step",
           lattice.has_layers_between() ? Json(nullptr) : Json(problem.limits.joint_step)},
          {"edges", problem.limits.edges == EdgeMode::kContinuous ? "continuous" : "nodes"}};
}

double SampleFinder::place(const TrajectoryRow& sample) {
  // The step is found by s, or by the joints where nothing but they tell it.
  double share = 0;
  for (;; ++step_) {
    const double length = path_ == nullptr ? 0 : path_->layer(static_cast<int>(step_)).step_length;
    const Config way = rows_[step_ + 1].q - rows_[step_].q;
    if (length > 0)
      share = (sample.s - path_->layer(static_cast<int>(step_)).s) / length;
    else
      share = way.squaredNorm() > 0 ? (sample.q - rows_[step_].q).dot(way) / way.squaredNorm() : 0;
    if (share < 1 || step_ + 2 >= rows_.size()) break;
  }
  return static_cast<double>(step_) + std::clamp(share, 0.0, 1.0);
}

Json motion_json(const std::vector<TimedRow>& samples, double rate, const JointRates& rates,
                 const Chain& chain, const std::function<double(std::size_t)>& place_of) {
  constexpr std::size_t kMost = 2000;
  const auto n = static_cast<std::ptrdiff_t>(samples.size());
  const auto q = [&](std::ptrdiff_t k) -> const Config& {  // at rest before and after
    return samples[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n - 1))].row.q;
  };
  const std::ptrdiff_t each = n / static_cast<std::ptrdiff_t>(kMost) + 1;
  Json t = Json::array(), layers = Json::array(), tool = Json::array(),
       ratios[3] = {Json::array(), Json::array(), Json::array()};
  std::array<double, 3> most{};
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const double place = place_of(static_cast<std::size_t>(k));
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
    layers.push_back(place);
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
          {"jerk", std::move(ratios[2])}};
}

}  // namespace swivel::detail
