// SPDX-License-Identifier: BSD-3-Clause
// The parameter by which two arms move: what both travels over it must be like, by samples.
#include "swivel/core/timing/shared_travel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "inner_posture.hpp"
#include "seed.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kFinest = 1e-9;

std::vector<Waypoint> polyline(Random& random, int segments) {
  std::vector<Waypoint> waypoints{{Vector3d(0.4, 0, 0.3), Quaterniond(0.5, 0.5, -0.5, 0.5)}};
  for (int k = 0; k < segments; ++k) {
    Waypoint to = waypoints.back();
    const Vector3d turn = random_vector(random, random.uniform(0, 0.4));
    to.position += random_vector(random, std::exp(random.uniform(std::log(1e-3), std::log(0.1))));
    to.orientation =
        to.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm() + 1e-12, turn.normalized()));
    waypoints.push_back(to);
  }
  return waypoints;
}

/// Two paths with as many steps each; the second one's tool may be carried by the first one's.
struct TwoPaths {
  std::optional<ToolPath> first, second;
  std::vector<int> steps;  // between waypoints
};
TwoPaths two_paths(Random& random, bool follows) {
  TwoPaths two;
  const int segments = 1 + random.below(4);
  for (int k = 0; k < segments; ++k) two.steps.push_back(1 + random.below(20));
  const Resolution resolution{.ds = 1, .dphi = 0.1, .dalpha = 3};
  const auto smooth = random.coin(0.2) ? PathSmoothing{0, 0} : PathSmoothing{};
  two.first.emplace(polyline(random, segments), resolution, "first", Budget(), smooth, false,
                    two.steps);
  std::vector<Waypoint> waypoints = polyline(random, segments);
  std::vector<int> steps = two.steps;
  if (follows) {
    const std::vector<Waypoint> on_tool = std::move(waypoints);
    waypoints.clear();
    int layer = 0;
    for (std::size_t k = 0; k < two.steps.size(); ++k)
      for (int n = k == 0 ? 0 : 1; n <= two.steps[k]; ++n) {
        const double t = static_cast<double>(n) / two.steps[k];
        Waypoint& waypoint = waypoints.emplace_back();
        const Pose& tool = two.first->layer(layer++).tool;
        waypoint.position = tool * Vector3d((1 - t) * on_tool[k].position +
                                            t * on_tool[k + 1].position - on_tool[0].position);
        waypoint.orientation = Quaterniond(tool.linear()) *
                               on_tool[k].orientation.slerp(t, on_tool[k + 1].orientation);
      }
    steps.assign(waypoints.size() - 1, 1);
  }
  two.second.emplace(waypoints, resolution, "second", Budget(), PathSmoothing{}, false, steps);
  return two;
}

/// What was seen of the travel of an arm.
struct Seen {
  int layers = 0, blends = 0, samples = 0;
  double off = 0;   // m, of layers inside blends
  double jump = 0;  // of second derivatives, times the length of the step that measured it
};

/// Returns whether a parameter lies in a blend, or within `margin` of one.
bool in_blend(const SharedTravel& travel, double x) {
  return std::any_of(travel.blends().begin(), travel.blends().end(),
                     [&](const SharedTravel::Blend& blend) {
                       return std::abs(x - blend.x) < blend.reach + kFinest;
                     });
}

/// Checks the travel of one arm over the parameter, `xs` at layers.
void check_travel(const SharedTravel& travel, const ToolPath& path, const std::vector<double>& xs,
                  const std::vector<bool>& waypoint, Seen& seen) {
  for (int i = 0; i < path.size(); ++i) {
    const double x = xs[static_cast<std::size_t>(i)], there = path.layer(i).travel;
    const double off = std::abs(travel.travel(x) - there);
    ++seen.layers;
    if (!in_blend(travel, x) || waypoint[static_cast<std::size_t>(i)])
      EXPECT_LE(off, 1e-12) << "layer " << i;
    else
      seen.off = std::max(seen.off, off);
    EXPECT_NEAR(travel.travel(travel.parameter(there)), there, 1e-12);
  }
  double before = travel.travel(0);
  const double end = xs.back();
  for (int k = 1; k <= 2000; ++k, ++seen.samples) {
    const double now = travel.travel(end * k / 2000);
    EXPECT_GE(now, before) << "at " << end * k / 2000;
    before = now;
  }
  for (const SharedTravel::Blend& blend : travel.blends()) {
    ++seen.blends;
    const double h = blend.reach * 1e-6;
    for (const double x : {blend.x - blend.reach, blend.x, blend.x + blend.reach}) {
      const auto [slope, bend] = travel.derivatives(x - h);
      const auto [slope_after, bend_after] = travel.derivatives(x + h);
      EXPECT_NEAR(slope, slope_after, 1e-4);
      seen.jump = std::max(seen.jump, std::abs(bend - bend_after) * blend.reach);
    }
  }
}

/// Returns the parameter at each layer of two paths: between waypoints it grows evenly, by the
/// longer travel.
std::vector<double> parameters(const TwoPaths& two) {
  std::vector<double> xs{0};
  int layer = 0;
  for (const int steps : two.steps) {
    const auto length = [&](const ToolPath& path) {
      return path.layer(layer + steps).travel - path.layer(layer).travel;
    };
    const double longer = std::max(length(*two.first), length(*two.second)), from = xs.back();
    for (int n = 1; n <= steps; ++n) xs.push_back(from + longer * n / steps);
    layer += steps;
  }
  return xs;
}

TEST(SharedTravel, AscendsSmoothlyThroughLayersThatAreSimultaneous) {
  Random random(seed("SharedTravel.AscendsSmoothlyThroughLayersThatAreSimultaneous"));
  Seen seen;
  int rests = 0, followers = 0;
  double off_of_followers = 0;
  const int count = trials(300);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const bool follows = random.coin();
    const TwoPaths two = two_paths(random, follows);
    const double reach = random.coin(0.8) ? 0.02 : 0;
    const CommonParameter common =
        common_parameter({&*two.first, &*two.second}, follows ? 1 : -1, reach);
    const std::vector<double> xs = parameters(two);
    std::vector<bool> waypoint(xs.size(), false);
    std::size_t layer = 0;
    for (const int steps : two.steps) waypoint[layer += static_cast<std::size_t>(steps)] = true;
    Seen own;
    for (std::size_t k = 0; k < 2; ++k)
      check_travel(common.travel[k], k == 0 ? *two.first : *two.second, xs, waypoint, own);
    for (const ToolPath* path : {&*two.first, &*two.second})
      for (const ToolPath::Corner& corner : path->corners()) {
        if (corner.reach > 0 || !waypoint[static_cast<std::size_t>(corner.layer)]) continue;
        EXPECT_TRUE(std::find(common.rests.begin(), common.rests.end(), corner.layer) !=
                    common.rests.end());
      }
    EXPECT_TRUE(reach > 0 || common.blended.empty());
    if (follows) off_of_followers = std::max(off_of_followers, own.off);
    followers += follows;
    rests += static_cast<int>(common.rests.size());
    seen.layers += own.layers, seen.blends += own.blends, seen.samples += own.samples;
    seen.off = std::max(seen.off, own.off), seen.jump = std::max(seen.jump, own.jump);
  }
  std::printf(
      "%d pairs of paths, %d with a follower: %d layers, %d blends, %d rests, %d samples; layers "
      "in blends off by %.3g mm, of followers %.3g mm; second derivatives jump by %.2g\n",
      count, followers, seen.layers, seen.blends, rests, seen.samples, 1e3 * seen.off,
      1e3 * off_of_followers, seen.jump);
  EXPECT_LE(off_of_followers, 0.05e-3 * (1 + 1e-6));
  EXPECT_LE(seen.jump, 1e-3);
  EXPECT_GE(seen.blends, at_least(count / 2));
  EXPECT_GE(rests, at_least(count / 10));
  EXPECT_GE(seen.layers, at_least(10 * count));
}

}  // namespace
}  // namespace swivel
