// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "swivel/collision/proofs/verdict.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

namespace detail {
class MeshStore;
}

/// Two bodies that must keep clear of each other.
struct BodyPair {
  int a = 0, b = 0;  ///< indices into World::body_names(), a < b
  bool operator==(const BodyPair&) const = default;
};

/// A body of the robot and a scene object that may touch each other.
struct AllowedPair {
  BodyPair pair;
  std::optional<double>
      depth;  ///< how deep, m; unset: however deep, and the pair is none of World::pairs()
};

/// How near a pair may come, m; less than zero: how deep the two may be in each other.
struct RequiredClearance {
  double node = 0;    ///< on layers; contact is never allowed, save by a depth, of which a part is
                      ///< kept for motions
  double motion = 0;  ///< between layers
  double tolerance = 0;  ///< h: a motion is proved by midpoints that are clear by motion + h; > 0
};

/// A pair of robot bodies that the model does not take out (SRDF, one rigid group, parent and
/// child).
///
/// An SRDF says which pairs can never meet. Where none speaks for a pair (no SRDF, or an attached
/// body), many seeded postures inside the joint limits do. A pair that touches in all of them
/// touches by design and is dropped. A pair that is near by design could not keep the clearance
/// asked: it keeps at most half of its median clearance on layers, a quarter between them, and its
/// tolerance is half of it where it is below 2 h. All other pairs keep self_clearance, and
/// edge_clearance (or half of self_clearance). What a pair keeps never shrinks as a limit grows, so
/// that no larger clearance makes a path.
struct RobotPair {
  BodyPair pair;
  bool dropped = false;
  bool near = false;     ///< by design: the median is small or reduces what the pair keeps
  bool reduced = false;  ///< keeps less than other robot pairs
  double median = 0;  ///< m, over the samples; infinite where an SRDF speaks for the pair or it is
                      ///< too far to matter
  RequiredClearance required;  ///< unless dropped
};

/// What every pair's clearance is compared with: a distance, or what the pair must keep, and so
/// much more.
enum class ClearanceRule {
  kNothing,
  kNode,    ///< RequiredClearance::node
  kMotion,  ///< RequiredClearance::motion; pairs that are near by design, or may touch, are left to
            ///< EdgeRule
  kMidpoint,  ///< the same and RequiredClearance::tolerance
};
struct Threshold {
  Threshold(double distance) : more(distance) {}  // implicit: "all pairs below 5 mm"
  Threshold(ClearanceRule which, double and_more = 0) : rule(which), more(and_more) {}
  ClearanceRule rule = ClearanceRule::kNothing;
  double more = 0;  ///< m; no pair is below a threshold less than zero, save those that may touch
};

/// A segment of a motion that is straight in joint space, from q - half to q + half about its
/// middle posture q. How much nearer a pair can come on it than at q: by the speed of its bodies
/// there, and by how far a point's path can bend away from its tangent (docs/theory.md, Lemma 9).
struct MotionSegment {
  Config half = Config::Zero();  ///< rad
  double tangent_deviation = 0;  ///< m, of any point; EdgeRule::tangent_deviation(half)
  double margin = 0;             ///< m, asked for besides
};

/// What edge_blocked must prove of the whole motion from q0 to q1, straight in joint space (q0 + t
/// (q1 - q0); the caller unwraps continuous joints): every pair keeps its
/// RequiredClearance::motion. docs/model.md "Motions". Made by World::edge_rule.
struct EdgeRule {
  std::array<double, kDof> radii{};  ///< core motion_radii, m
  double h = 0.0005;                 ///< m; > 0
  /// A pair that is near by design (RobotPair), or that may touch and must not be deeper than so
  /// much (AllowedPair). On most motions it would need many midpoints; how its bodies move against
  /// each other, by the joints between them alone, proves it with few.
  struct Near {
    BodyPair pair;
    double d_edge = 0, h = 0;       ///< m; d_edge less than zero: a depth
    int first_joint = 0, last = 0;  ///< first_joint <= j < last
  };
  std::vector<Near> near;
  FollowerMotion followers;  ///< m per rad, rad; in `radii` already
  /// A bound on how far any point moves, m: sum |dq_j| R_j; for joints first <= j < last: as seen
  /// from the link below them.
  [[nodiscard]] double motion(const Config& q0, const Config& q1, int first = 0,
                              int last = kDof) const;
  /// A bound on how far a point's place at q + dq is from where its velocity at q would bring it,
  /// m: sum |dq_i dq_j| R_max(i,j) / 2, and of points on followers as much as these add.
  [[nodiscard]] double tangent_deviation(const Config& dq) const;
  /// Number of midpoints N: the smallest power of two with B / (2 N) <= tolerance, B = motion of
  /// all joints.
  [[nodiscard]] std::int64_t midpoints(const Config& q0, const Config& q1, double tolerance) const;
  [[nodiscard]] std::int64_t midpoints(const Config& q0, const Config& q1) const {
    return midpoints(q0, q1, h);
  }
};

/// How a Query decides. Its answers are the same.
enum class DistanceProofs {
  kOff,  ///< FCL, behind bounding volumes
  kOn,  ///< closed forms, where they prove the clearance outside the band; within it triangle trees
        ///< or FCL
};

/// The robot's bodies among the scene's, with FCL as the authority on every pair that neither a
/// distance proof nor our own distance of triangles settles. Immutable after construction; const
/// calls are safe from many threads, each with its own Query. Verdicts are those of docs/model.md:
/// fcl::distance (LIBCCD, tolerance 1e-10, fresh result, a before b) >= d; for a sphere or capsule
/// the equivalent boolean on the inflated body; closed meshes are solids.
class World {
 public:
  /// Which pairs count: of the robot those of RobotPair that are not dropped; of robot and scene
  /// those that move and are not allowed to touch, or to a depth only. Throws InputError for a mesh
  /// without triangles, and Stopped.
  World(const RobotModel& robot, const ArmModel& arm, const Problem& problem,
        const Budget& budget = {});
  /// The same with the trees of every mesh that `like` has met.
  World(const World& like, const RobotModel& robot, const ArmModel& arm, const Problem& problem,
        const Budget& budget = {});
  /// The robot of `like` in front of another scene: shares its robot pairs, its scene's shapes and
  /// the trees of every mesh that it has met, so that an episode with moved objects costs next to
  /// nothing. Safe to call from many threads on one `like`.
  World(const World& like, const std::vector<SceneObject>& scene, const Budget& budget = {});
  /// The same with the problem's scene and limits. Pairs may be nearer by `forgiven` than they
  /// should, m, but not touch.
  World(const World& like, const Problem& problem, const Budget& budget = {}, double forgiven = 0);
  /// Pairs with one of some scene objects, which a change of these may change, or the others, which
  /// it does not.
  enum class Pairs { kOf, kBut };
  /// The same bodies, but of its pairs only some. `objects`: by their number in the scene.
  World(const World& whole, const std::vector<int>& objects, Pairs pairs = Pairs::kOf);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Robot bodies in the order of bodies(), then scene objects. A link with several shapes has its
  /// name several times.
  [[nodiscard]] const std::vector<std::string>& body_names() const;
  [[nodiscard]] std::array<std::string, 2> names(const BodyPair& pair) const;
  /// In the order in which find_violating_pair asks: the environment before the robot itself,
  /// inflated booleans before distances, the tool before the base.
  [[nodiscard]] const std::vector<BodyPair>& pairs() const;
  /// The pairs of a moving body and a scene object that may touch, ordered by the scene and, for
  /// one object, as bodies() are.
  [[nodiscard]] const std::vector<AllowedPair>& allowed() const;
  [[nodiscard]] const std::vector<RobotBody>& bodies() const;
  /// The joints that move the two bodies of a pair against each other.
  [[nodiscard]] Chain::Joints joints_between(const BodyPair& pair) const;
  /// How far any point of a scene object moves at most from one pose to another, m, rounding
  /// included.
  [[nodiscard]] double displacement(int object, const Pose& from, const Pose& to) const;
  /// Of the robot or the scene: questions then take a hundred times as long.
  [[nodiscard]] bool has_meshes() const;
  /// Of the meshes that make_ready() would begin with.
  [[nodiscard]] std::size_t triangles_to_make_ready() const;
  /// Makes ready what questions about meshes need (trees of their triangles), in the order of
  /// pairs(), until `stop` says so; what is left is made where it is first needed. Safe beside
  /// questions on other threads.
  void make_ready(const std::function<bool()>& stop) const;
  /// One of pairs(): what it must keep, by the limits of this world.
  [[nodiscard]] RequiredClearance required_clearance(const BodyPair& pair) const;
  /// What is asked of a pair, by its place in pairs(), m: its RequiredClearance less what this
  /// world forgives. Less than zero where it may be so deep; minus infinity where it is asked
  /// nothing.
  [[nodiscard]] double required(std::size_t pair, ClearanceRule rule) const;
  [[nodiscard]] const std::vector<RobotPair>& robot_pairs() const;
  /// The same with every median known, however far.
  [[nodiscard]] std::vector<RobotPair> robot_pairs_with_medians() const;
  /// How motions are proved free here; radii as of core motion_radii.
  [[nodiscard]] EdgeRule edge_rule(const std::array<double, kDof>& radii) const;
  /// Open meshes (treated as surfaces), links without a shape, pairs that count less or not.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

  /// Mutable state of one caller: where the bodies are, counters. Cheap enough to make one per
  /// thread, not one per question. The world must outlive it, and may be moved meanwhile.
  class Query {
   public:
    explicit Query(const World& world, DistanceProofs distance_proofs = DistanceProofs::kOff);
    ~Query();
    Query(Query&&) noexcept;
    Query& operator=(Query&&) noexcept;

    /// First of pairs() whose clearance at q is below its threshold, or none: "clearance >=
    /// threshold" for all pairs. The pair that is likely to be below is asked before the others. A
    /// function of the arguments alone.
    [[nodiscard]] std::optional<BodyPair> find_violating_pair(
        const Config& q, const Threshold& threshold, const std::optional<BodyPair>& suspected = {});
    /// The same answer, sooner where postures lie near each other: from one such question to the
    /// next a lower bound of every pair's clearance is kept, less what the two bodies have moved.
    /// FCL calls and what is proved depend on such questions before. With Distance proofs::kOff
    /// nothing is kept.
    [[nodiscard]] std::optional<BodyPair> find_violating_pair_incremental(
        const Config& q, const Threshold& threshold, const std::optional<BodyPair>& suspected = {});
    /// The same of `suspected` and the pairs with the scene alone.
    [[nodiscard]] std::optional<BodyPair> find_violating_pair_with_scene(
        const Config& q, const Threshold& threshold, const std::optional<BodyPair>& suspected);
    /// The same, where more than the threshold's rule is asked of a pair only as far as it can come
    /// nearer on the segment about q.
    [[nodiscard]] std::optional<BodyPair> find_violating_pair_over_motion(
        const MotionSegment& segment, const Config& q, const Threshold& threshold);
    /// At the posture of the last find_violating_pair_incremental or
    /// find_violating_pair_over_motion, which named no pair at this threshold: as FCL sees it,
    /// every pair's clearance is more than what was asked of it by this, m; less than 0 where that
    /// is not known.
    [[nodiscard]] double slack(const Threshold& threshold) const;
    /// Without FCL: a number that the clearance of a pair, by its place in pairs(), is not below as
    /// FCL sees it, m. Looked for between `least`, >= 0, and `enough`; what is below `least` may be
    /// anything. With Distance proofs::kOff by bounds alone.
    [[nodiscard]] double clearance_lower_bound(const Config& q, std::size_t pair, double least,
                                               double enough);
    /// By body: how far no point of it has moved in all, m, on the chords from each posture asked
    /// about here or in find_violating_pair_incremental() to the next. Valid until the next
    /// question.
    [[nodiscard]] std::span<const double> accumulated_displacement(const Config& q);
    /// Of the pair that one of these has just named, or proves_violation(): its clearance is proved
    /// below its threshold by more than FCL may err.
    [[nodiscard]] bool violation_is_proved() const;
    /// Whether one pair's clearance is below its threshold.
    [[nodiscard]] bool pair_violates(const Config& q, const BodyPair& pair,
                                     const Threshold& threshold);
    /// Without FCL, proves that one pair's clearance is below its threshold, which may be below
    /// zero here: then that one body holds a point of the other as deep inside it. False where a
    /// short search finds no proof.
    [[nodiscard]] bool proves_violation(const Config& q, const BodyPair& pair,
                                        const Threshold& threshold);
    /// Whether proves_violation() proves most of what is below, in a fraction of the time that it
    /// takes to prove the rest free: where a mesh of many triangles is held against a box or a
    /// cylinder.
    [[nodiscard]] bool violation_proof_is_cheap(const BodyPair& pair) const;
    /// How deep the two bodies of a pair are in each other, within 0.02 mm and, of a cylinder, 0.3
    /// % of its radius. The search ends early once at_most <= `from`, m. FCL is not asked.
    [[nodiscard]] Depth depth(const Config& q, const BodyPair& pair,
                              double from = -std::numeric_limits<double>::infinity());
    /// Exact as FCL: the pair with the least margin, the first that has it, and one that touches
    /// before any that does not; none when there are no pairs. Pairs that may touch are left out.
    struct Clearance {
      double distance = 0;  ///< m; 0 when touching or one inside the other
      BodyPair pair;
      double required = 0;  ///< what the pair must keep on layers, m
      double least = 0;     ///< clearance of the nearest of all pairs, m
      [[nodiscard]] double margin() const { return distance - required; }
    };
    [[nodiscard]] std::optional<Clearance> clearance(const Config& q);
    /// The same, but none where neither its margin nor its least is below that of `so_far`, whose
    /// bodies do not touch: a proof of that will do. Where the least alone is, the distance is the
    /// largest number there is.
    [[nodiscard]] std::optional<Clearance> clearance_if_less(const Config& q,
                                                             const Clearance& so_far);
    /// A point of each of the two bodies of clearance(q), base frame, as far apart as the bodies
    /// are: within 0.1 mm. For drawing. None where they touch, and where FCL has no points that can
    /// be believed.
    [[nodiscard]] std::optional<std::array<Vector3d, 2>> nearest_points(const Config& q,
                                                                        const Clearance& clearance);
    /// A point of both bodies, base frame, within 0.1 mm. For drawing. None where they do not
    /// touch, and where none is found soon.
    [[nodiscard]] std::optional<Vector3d> common_point(const Config& q, const BodyPair& pair);
    [[nodiscard]] CollisionCounters counters() const;

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

 private:
  struct Impl;
  World(detail::MeshStore meshes, const RobotModel& robot, const ArmModel& arm,
        const Problem& problem, const Budget& budget);
  std::unique_ptr<Impl> impl_;
};

/// None when every pair is clear by its RequiredClearance::motion + h at every midpoint t = (m +
/// 1/2) / N; else a pair that comes too near. N is of the pair's own h. By bisection, coarse to
/// fine: an interval is free when each pair is clear in its middle by as much as it can come nearer
/// within the interval, blocked when its middle is below RequiredClearance::motion. The query is of
/// the world that the rule is of, and keeps clearances from one motion to the next, as from one
/// posture to the next. `slack`, where there is no such pair and the rule has none of its own: it
/// would be the same if scene objects stood elsewhere by less than this, m. Throws Stopped.
[[nodiscard]] std::optional<BodyPair> edge_blocked(World::Query& query, const EdgeRule& rule,
                                                   const Config& q0, const Config& q1,
                                                   const Budget& budget = {},
                                                   double* slack = nullptr);
/// Whether one pair of the world is what blocks it, whatever others do: too near at one of the
/// midpoints. Throws Stopped.
[[nodiscard]] bool edge_blocked_by(const BodyPair& pair, World::Query& query, const EdgeRule& rule,
                                   const Config& q0, const Config& q1, const Budget& budget = {});

}  // namespace swivel
