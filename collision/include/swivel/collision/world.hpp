// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/arm.hpp"
#include "swivel/core/problem.hpp"

namespace swivel {

/// Two bodies that must keep clear of each other. Robot bodies come first; scene objects follow.
struct BodyPair {
  int a = 0, b = 0;  ///< indices into World::body_names(), a < b
};

/// Work counted per query object; add up over threads.
struct CollisionCounters {
  std::int64_t fcl_calls = 0;
  CollisionCounters& operator+=(const CollisionCounters& o) {
    fcl_calls += o.fcl_calls;
    return *this;
  }
};

/// The robot's bodies among the scene's, with FCL as the authority on every pair. Immutable after construction; const calls are
/// safe from many threads, each with its own Query.
/// Verdicts are those of design.md 1: fcl::distance (LIBCCD, 1e-6, fresh result, a before b) >= d; for a sphere or capsule the
/// equivalent boolean on the inflated body; closed meshes are solids.
class World {
 public:
  /// Which pairs count (design.md 1): not disabled by the SRDF, not rigid to each other, not parent and child, not allowed to touch;
  /// without an SRDF, and for attached bodies, also not below max(d_safe, d_edge + h) in all of many seeded samples.
  World(const RobotModel& robot, const ArmModel& arm, const Problem& problem);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  [[nodiscard]] const std::vector<std::string>& body_names() const;
  [[nodiscard]] const std::vector<BodyPair>& pairs() const;
  [[nodiscard]] const std::vector<RobotBody>& bodies() const;
  /// Open meshes (treated as surfaces) and the like.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

  /// Mutable state of one caller: placed FCL objects, counters. Cheap enough to make one per thread, not one per question.
  class Query {
   public:
    explicit Query(const World& world);
    ~Query();
    Query(Query&&) noexcept;
    Query& operator=(Query&&) noexcept;

    /// First pair (in an order fixed by the world) whose clearance at q is below d, or none: "clearance >= d" for all pairs.
    [[nodiscard]] std::optional<BodyPair> first_below(const Config& q, double d);
    /// Exact-as-FCL least clearance over all pairs and where, m; negative or zero when touching; none when there are no pairs.
    struct Clearance {
      double distance = 0;
      BodyPair pair;
    };
    [[nodiscard]] std::optional<Clearance> clearance(const Config& q);
    [[nodiscard]] const CollisionCounters& counters() const;

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The motion from q0 to q1, straight in joint space: its bound, and the verdict by bisection.
/// radii: core motion_radii. Returns the first failing midpoint's pair, or none when the edge is free:
/// clearance >= d_edge is proved for the whole motion exactly as design.md 1 "Edge collision" defines it.
/// `first_below(q, d)` is asked at midpoints only.
struct EdgeRule {
  std::array<double, kDof> radii{};
  double d_edge = 0, h = 0.0005;
  /// Number of midpoints N: the smallest power of two with B / (2 N) <= h, B = sum |dq_j| R_j.
  [[nodiscard]] std::int64_t midpoints(const Config& q0, const Config& q1) const;
};
[[nodiscard]] std::optional<BodyPair> edge_blocked(World::Query& query, const EdgeRule& rule, const Config& q0, const Config& q1);
/// The plain rule, every leaf asked: what edge_blocked must agree with.
[[nodiscard]] std::optional<BodyPair> edge_blocked_plain(World::Query& query, const EdgeRule& rule, const Config& q0, const Config& q1);

}  // namespace swivel
