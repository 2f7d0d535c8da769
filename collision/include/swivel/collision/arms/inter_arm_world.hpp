// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// An arm as the world between two arms sees it. References must outlive that world.
struct ArmInPair {
  const ArmModel* arm = nullptr;
  const std::vector<AttachedBody>* attached = nullptr;
};

/// The pairs of bodies of two arms of one robot that must keep clear of each other: the links that
/// either arm moves and what is attached to them. What an arm must keep from everything else is its
/// own World's. Pairs are numbered by the bodies of arm 0 and, after them, those of arm 1. As with
/// the pairs of one arm (RobotPair), an SRDF says which pairs can never meet; pairs for which none
/// speaks are dropped if they touch at all of many sampled postures of both arms, and keep less if
/// they are near by design.
class InterArmWorld {
 public:
  /// Builds the world between two arms of a robot. `limits` says what the pairs keep: d_self() at
  /// layers, d_self_edge() on motions, and the tolerance. `may_touch`: names of pairs of bodies
  /// that are left out. Throws InputError for an unknown name in `may_touch`, a mesh without area
  /// and what robot_bodies() refuses, and Stopped.
  InterArmWorld(const RobotModel& robot, const std::array<ArmInPair, 2>& arms,
                const std::vector<std::array<std::string, 2>>& may_touch, const Limits& limits,
                const Budget& budget = {});
  ~InterArmWorld();
  InterArmWorld(InterArmWorld&&) noexcept;
  InterArmWorld& operator=(InterArmWorld&&) noexcept;

  [[nodiscard]] const std::vector<std::string>& body_names() const;
  [[nodiscard]] std::array<std::string, 2> names(const BodyPair& pair) const;
  /// Returns the pairs that must keep clear, with what each keeps, and those that are dropped.
  [[nodiscard]] const std::vector<RobotPair>& pairs() const;
  /// Returns warnings about pairs that are dropped or keep less than others.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

  /// Where bodies of one arm are at some of its configurations. Configurations at which they stand
  /// alike, to 1e-8 (m, and entries of rotations), share a stance.
  class Stances {
   public:
    /// Returns the number of the stance of a configuration.
    [[nodiscard]] std::size_t stance_of(std::size_t configuration) const;
    /// Returns the number of stances.
    [[nodiscard]] std::size_t count() const;
    Stances(Stances&&) noexcept;
    Stances& operator=(Stances&&) noexcept;
    ~Stances();

   private:
    friend class InterArmWorld;
    struct Impl;
    explicit Stances(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
  };

  /// The state of one caller. The world must outlive it. Joint configurations, rad, are those of
  /// arm 0 and arm 1; distances in m. Answers depend on the arguments alone.
  class Query {
   public:
    explicit Query(const InterArmWorld& world,
                   DistanceProofs distance_proofs = DistanceProofs::kOn);
    ~Query();
    Query(Query&&) noexcept;
    Query& operator=(Query&&) noexcept;

    /// Returns the first of pairs() whose clearance is below what it keeps at layers (kNode) or on
    /// motions (kMotion); nothing if all pairs keep it. `forgiven`, m, is taken off, but contact is
    /// never allowed.
    [[nodiscard]] std::optional<BodyPair> find_violating_pair(const std::array<Config, 2>& q,
                                                              ClearanceRule rule,
                                                              double forgiven = 0);
    /// Returns the pair below what it keeps at layers whose bodies are deepest in each other, or
    /// nearest where none touch; nothing if all pairs keep it.
    [[nodiscard]] std::optional<BodyPair> find_deepest_pair(const std::array<Config, 2>& q);
    /// Returns nothing if the motion of both arms at one time, each straight in joint space from
    /// `from` to `to`, is proved free: every pair is clear by what it keeps on motions plus its
    /// tolerance h at every midpoint t = (m + 1/2) / N. N is the least power of two for which no
    /// two points of the pair's bodies come nearer by more than h within 1 / (2 N); how far joints
    /// move bodies is bounded by `radii`, m, motion_radii() of either arm. Otherwise returns a pair
    /// that comes too near. `forgiven` as above. Throws Stopped.
    [[nodiscard]] std::optional<BodyPair> find_pair_blocking_motion(
        const std::array<std::array<double, kDof>, 2>& radii, const std::array<Config, 2>& from,
        const std::array<Config, 2>& to, double forgiven = 0, const Budget& budget = {});

    /// Returns where bodies of one arm are at configurations `q`: `body` alone (an index of
    /// body_names()), or all bodies of the arm if it is -1.
    [[nodiscard]] Stances stances(int arm, int body, std::span<const Config> q);
    /// Returns whether a pair is below what it keeps at layers, at every configuration of its first
    /// body's stance i of `a` and every one of its second body's stance j of `b`: below it by 1e-6
    /// m where stances may stand for several configurations.
    [[nodiscard]] bool violates(const BodyPair& pair, const Stances& a, std::size_t i,
                                const Stances& b, std::size_t j);
    /// Returns whether any pair is below what it keeps, as violates() does; `a` and `b` have all
    /// bodies.
    [[nodiscard]] bool any_violates(const Stances& a, std::size_t i, const Stances& b,
                                    std::size_t j);

    /// A pair and its clearance, m; 0 if the two touch.
    struct Clearance {
      double distance = 0, required = 0;
      BodyPair pair;
      [[nodiscard]] double margin() const { return distance - required; }
    };
    /// Returns the pair with the least margin over what it keeps at layers, as FCL tells; nothing
    /// if there are no pairs.
    [[nodiscard]] std::optional<Clearance> clearance(const std::array<Config, 2>& q);
    /// Returns for each body, by its index in body_names(), the nearest of the bodies of the other
    /// arm that it must keep clear of, as FCL tells: the pair, how far the two are apart, and what
    /// the pair keeps. Nothing for a body without pairs.
    [[nodiscard]] std::vector<std::optional<Clearance>> body_clearances(
        const std::array<Config, 2>& q);
    /// Returns a point of each of the two bodies of clearance(q), in the base frame, that are as
    /// far apart as the bodies are, within 0.1 mm; meant for drawing. Returns nothing if the bodies
    /// touch or if FCL's points are not credible.
    [[nodiscard]] std::optional<std::array<Vector3d, 2>> nearest_points(
        const std::array<Config, 2>& q, const Clearance& clearance);
    /// Returns a point that both bodies contain, in the base frame, within 0.1 mm; meant for
    /// drawing. Returns nothing if they do not touch or no point is found soon.
    [[nodiscard]] std::optional<Vector3d> common_point(const std::array<Config, 2>& q,
                                                       const BodyPair& pair);
    [[nodiscard]] CollisionCounters counters() const;

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel
