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
#include "swivel/core/problem/path_problem.hpp"

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
  /// How deep the two may be in each other, m. If unset, any depth is allowed and the pair is not
  /// among World::pairs().
  std::optional<double> depth;
};

/// How near the bodies of a pair may come, m. A value less than zero says how deep the two may be
/// in each other.
struct RequiredClearance {
  /// At layers. Contact is never allowed, except to a depth; then a part of that depth is kept in
  /// reserve for motions.
  double node = 0;
  double motion = 0;  ///< on motions between layers
  /// h > 0: a motion is proved by midpoints at which the pair is clear by motion + h.
  double tolerance = 0;
};

/// A pair of robot bodies that must keep clear. Pairs that the model excludes (by its SRDF, as one
/// rigid group, or as parent and child) are not among them.
///
/// An SRDF says which pairs can never meet. Where it says nothing of a pair (there is no SRDF, or a
/// body is attached), many seeded postures inside the joint limits decide. A pair that touches in
/// all of them touches by design and is dropped. A pair that is near by design could not keep the
/// clearance asked for: it keeps at most half of its median clearance at layers and a quarter of it
/// between them, and its tolerance is at most half of the median, but at least kVerdictBand. All
/// other pairs keep self_clearance at layers, edge_clearance (or half of self_clearance) between
/// them, and the tolerance h. What a pair keeps never shrinks as a limit grows, so that no path
/// exists only because a clearance is larger.
struct RobotPair {
  BodyPair pair;
  bool dropped = false;
  bool near = false;     ///< near by design: the median is small or reduces what the pair keeps
  bool reduced = false;  ///< keeps less than other robot pairs
  /// Median of the clearance over the sampled postures, m; infinite if an SRDF decides about the
  /// pair or it is too far apart to matter.
  double median = 0;
  RequiredClearance required;  ///< meaningless if dropped
};

/// The part of a RequiredClearance with which the clearance of every pair is compared.
enum class ClearanceRule {
  kNothing,
  kNode,  ///< RequiredClearance::node
  /// RequiredClearance::motion. Pairs that are near by design or may touch are left to EdgeRule.
  kMotion,
  kMidpoint,  ///< RequiredClearance::motion + RequiredClearance::tolerance
};
struct Threshold {
  Threshold(double distance) : more(distance) {}  // implicit, to say "all pairs below 5 mm"
  Threshold(ClearanceRule which, double and_more = 0) : rule(which), more(and_more) {}
  ClearanceRule rule = ClearanceRule::kNothing;
  /// Added to the rule's clearance, m. No pair is below a threshold less than zero, except pairs
  /// that may touch.
  double more = 0;
};

/// A segment of a motion that is straight in joint space, from q - half to q + half about its
/// middle posture q. How much nearer the bodies of a pair can come on it than at q is bounded by
/// their speeds at q and by how far the path of a point can bend away from its tangent
/// (docs/theory.md, Lemma 9).
struct MotionSegment {
  Config half = Config::Zero();  ///< rad
  double tangent_deviation = 0;  ///< m, for any point: EdgeRule::tangent_deviation(half)
  double margin = 0;             ///< m, required in addition
};

/// What edge_blocked() must prove of a motion from q0 to q1 that is straight in joint space (q0 + t
/// (q1 - q0), rad; the caller unwraps continuous joints): every pair keeps its
/// RequiredClearance::motion throughout. docs/model.md, "Motions". Made by World::edge_rule().
struct EdgeRule {
  std::array<double, kDof> radii{};  ///< motion_radii() of the arm, m
  double h = 0.0005;                 ///< m; > 0
  /// A pair that has a rule of its own: it is near by design (RobotPair), or it may touch and must
  /// not be deeper than a given depth (AllowedPair). On most motions, the common rule would need
  /// many midpoints for it; how its two bodies move against each other, by the joints between them
  /// alone, proves it with few.
  struct Near {
    BodyPair pair;
    double d_edge = 0, h = 0;       ///< m; a d_edge less than zero is a depth
    int first_joint = 0, last = 0;  ///< the joints between them: first_joint <= j < last
  };
  std::vector<Near> near;
  FollowerMotion followers;  ///< m per rad, rad; already part of `radii`
  /// Returns a bound on how far any point moves from q0 to q1, m: the sum of |dq_j| R_j over the
  /// joints first <= j < last, as seen from the link below them.
  [[nodiscard]] double motion(const Config& q0, const Config& q1, int first = 0,
                              int last = kDof) const;
  /// Returns a bound on how far a point at q + dq is from where its velocity at q would bring it,
  /// m: the sum of |dq_i dq_j| R_max(i,j) / 2, plus what followers add.
  [[nodiscard]] double tangent_deviation(const Config& dq) const;
  /// Returns the number of midpoints N: the smallest power of two with B / (2 N) <= tolerance,
  /// where B is motion() of all joints.
  [[nodiscard]] std::int64_t midpoints(const Config& q0, const Config& q1, double tolerance) const;
  [[nodiscard]] std::int64_t midpoints(const Config& q0, const Config& q1) const {
    return midpoints(q0, q1, h);
  }
};

/// How a Query decides. The answers are the same either way.
enum class DistanceProofs {
  kOff,  ///< by FCL, behind bounding volumes
  /// By closed forms where they prove that a clearance is outside the band about its threshold
  /// (kVerdictBand); within the band by trees of triangles or FCL.
  kOn,
};

/// The bodies of a robot and a scene, and which pairs of them must keep clear. FCL decides about
/// every pair that neither a distance proof nor Swivel's own distance of triangles settles.
/// Immutable after construction; threads may share it if each has its own Query. Verdicts are those
/// of docs/model.md: fcl::distance (LIBCCD, tolerance 1e-10, fresh result, a before b) >= d; for a
/// sphere or capsule the equivalent boolean on the inflated body; closed meshes are solids.
class World {
 public:
  /// Builds the world of a problem. Its pairs are those of two robot bodies that are not dropped
  /// (RobotPair), and those of a moving robot body and a scene object that are not allowed to
  /// touch, or only to a depth. Throws InputError for a mesh without triangles; Stopped.
  World(const RobotModel& robot, const ArmModel& arm, const PathProblem& problem,
        const Budget& budget = {});
  /// Builds the world of a problem, and shares the trees of every mesh that `like` has met. Throws
  /// InputError and Stopped.
  World(const World& like, const RobotModel& robot, const ArmModel& arm, const PathProblem& problem,
        const Budget& budget = {});
  /// Builds a world with the robot and the limits of `like` and another scene. It shares the robot
  /// pairs of `like`, its scene's shapes and the trees of every mesh that it has met, so that an
  /// episode with moved objects costs next to nothing. Threads may call this with one `like`.
  /// Throws InputError and Stopped.
  World(const World& like, const std::vector<SceneObject>& scene, const Budget& budget = {});
  /// Builds a world with the robot of `like` and the scene and limits of `problem`. Pairs may be
  /// nearer by `forgiven`, m, than they should, but not touch. Throws InputError and Stopped.
  World(const World& like, const PathProblem& problem, const Budget& budget = {},
        double forgiven = 0);
  /// Which pairs to keep: those with one of some scene objects (kOf), which a change of these
  /// objects may affect, or all others (kBut), which it does not.
  enum class Pairs { kOf, kBut };
  /// Builds a world with all bodies of `whole` and some of its pairs. `objects`: indices into the
  /// scene.
  World(const World& whole, const std::vector<int>& objects, Pairs pairs = Pairs::kOf);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Returns the names of all bodies: robot bodies in the order of bodies(), then scene objects. A
  /// link with several shapes has its name several times.
  [[nodiscard]] const std::vector<std::string>& body_names() const;
  [[nodiscard]] std::array<std::string, 2> names(const BodyPair& pair) const;
  /// Returns the pairs that must keep clear, in the order in which find_violating_pair() asks about
  /// them: pairs with the scene before pairs of the robot, spheres and capsules before other
  /// shapes, bodies near the tool before those near the base.
  [[nodiscard]] const std::vector<BodyPair>& pairs() const;
  /// Returns the pairs of a moving body and a scene object that may touch, in the order of the
  /// scene and, for one object, of bodies().
  [[nodiscard]] const std::vector<AllowedPair>& allowed() const;
  [[nodiscard]] const std::vector<RobotBody>& bodies() const;
  /// Returns the joints that move the two bodies of a pair against each other.
  [[nodiscard]] Chain::Joints joints_between(const BodyPair& pair) const;
  /// Returns a bound on how far any point of scene object `object` moves from one pose to another,
  /// m, rounding included. The poses are in the base frame.
  [[nodiscard]] double displacement(int object, const Pose& from, const Pose& to) const;
  /// Returns whether the robot or the scene has meshes. Questions then take a hundred times as
  /// long.
  [[nodiscard]] bool has_meshes() const;
  /// Returns the number of triangles of the meshes whose trees make_ready() would build.
  [[nodiscard]] std::size_t triangles_to_make_ready() const;
  /// Builds the trees of triangles that questions about meshes need, in the order of pairs(), until
  /// `stop` returns true. A tree that is missing is built by the first question that needs it. May
  /// run beside questions on other threads.
  void make_ready(const std::function<bool()>& stop) const;
  /// Returns what one of pairs() must keep by the limits of this world.
  [[nodiscard]] RequiredClearance required_clearance(const BodyPair& pair) const;
  /// Returns the clearance that is asked of a pair, by its index in pairs(), m: its
  /// RequiredClearance less what this world forgives. It is less than zero if the pair may be so
  /// deep, and minus infinity if nothing is asked of it.
  [[nodiscard]] double required(std::size_t pair, ClearanceRule rule) const;
  [[nodiscard]] const std::vector<RobotPair>& robot_pairs() const;
  /// Returns robot_pairs() with the median clearance of every pair, however far apart its bodies
  /// are.
  [[nodiscard]] std::vector<RobotPair> robot_pairs_with_medians() const;
  /// Returns how motions are proved free in this world. `radii`: motion_radii() of the arm, m.
  [[nodiscard]] EdgeRule edge_rule(const std::array<double, kDof>& radii) const;
  /// Returns warnings about open meshes (treated as surfaces), links without a shape, and pairs
  /// that are dropped or keep less than others.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

  /// The state of one caller of the world: where the bodies are, bounds that it found, and
  /// counters. Cheap enough to make one for each thread, but not one for each question. The world
  /// must outlive it, and may be moved meanwhile. Configurations `q` are in rad; distances in m;
  /// points in the base frame.
  class Query {
   public:
    explicit Query(const World& world, DistanceProofs distance_proofs = DistanceProofs::kOff);
    ~Query();
    Query(Query&&) noexcept;
    Query& operator=(Query&&) noexcept;

    /// Returns the first of pairs() whose clearance at q is below its threshold; nothing if all
    /// pairs have at least that clearance. `suspected`, a pair that is likely to be below, is asked
    /// about before the others. The answer depends on the arguments alone.
    [[nodiscard]] std::optional<BodyPair> find_violating_pair(
        const Config& q, const Threshold& threshold, const std::optional<BodyPair>& suspected = {});
    /// Answers as find_violating_pair(), but faster if consecutive postures lie near each other: it
    /// keeps a lower bound of every pair's clearance from one such question to the next, less what
    /// the two bodies have moved. The number of FCL calls and what is proved without FCL depend on
    /// earlier questions. Keeps nothing with DistanceProofs::kOff.
    [[nodiscard]] std::optional<BodyPair> find_violating_pair_incremental(
        const Config& q, const Threshold& threshold, const std::optional<BodyPair>& suspected = {});
    /// Answers as find_violating_pair_incremental(), for `suspected` and the pairs with scene
    /// objects alone.
    [[nodiscard]] std::optional<BodyPair> find_violating_pair_with_scene(
        const Config& q, const Threshold& threshold, const std::optional<BodyPair>& suspected);
    /// Answers as find_violating_pair_incremental() for the posture q in the middle of a segment,
    /// but asks Threshold::more of a pair only as far as the pair can come nearer on the segment.
    [[nodiscard]] std::optional<BodyPair> find_violating_pair_over_motion(
        const MotionSegment& segment, const Config& q, const Threshold& threshold);
    /// Returns by how much at least every pair's clearance, as FCL sees it, exceeds what was asked
    /// of it, m, at the posture of the last find_violating_pair_incremental() or
    /// find_violating_pair_over_motion(), which must have named no pair at this threshold. Returns
    /// a number less than 0 if that is not known.
    [[nodiscard]] double slack(const Threshold& threshold) const;
    /// Returns a number, m, that the clearance of a pair (by its index in pairs()), as FCL sees it,
    /// is not below; found without FCL. The search is for a number between `least` >= 0 and
    /// `enough`, m; a result below `least` may be far too low. With DistanceProofs::kOff only
    /// bounding volumes are used.
    [[nodiscard]] double clearance_lower_bound(const Config& q, std::size_t pair, double least,
                                               double enough);
    /// Returns for each body a bound on how far any of its points has moved in all, m, on the
    /// chords from each posture asked about here or in find_violating_pair_incremental() to the
    /// next. Valid until the next question.
    [[nodiscard]] std::span<const double> accumulated_displacement(const Config& q);
    /// Returns whether the clearance of the pair that the last question named, or
    /// proves_violation() was asked about, is proved to be below its threshold by more than FCL may
    /// err.
    [[nodiscard]] bool violation_is_proved() const;
    /// Returns whether the clearance of one pair is below its threshold.
    [[nodiscard]] bool pair_violates(const Config& q, const BodyPair& pair,
                                     const Threshold& threshold);
    /// Returns true if it is proved, without FCL, that the clearance of one pair is below its
    /// threshold. A threshold may be below zero here; then one body must contain a point of the
    /// other as deep inside it. Returns false if a short search finds no proof.
    [[nodiscard]] bool proves_violation(const Config& q, const BodyPair& pair,
                                        const Threshold& threshold);
    /// Returns whether proves_violation() proves most violations of a pair in a fraction of the
    /// time that it takes to prove the pair free elsewhere: if one body is a mesh of many triangles
    /// and the other a box or a cylinder.
    [[nodiscard]] bool violation_proof_is_cheap(const BodyPair& pair) const;
    /// Returns how deep the two bodies of a pair are in each other, within 0.02 mm and, for a
    /// cylinder, 0.3 % of its radius. The search ends early once at_most <= `from`, m. FCL is not
    /// asked.
    [[nodiscard]] Depth depth(const Config& q, const BodyPair& pair,
                              double from = -std::numeric_limits<double>::infinity());
    /// The result of clearance().
    struct Clearance {
      double distance = 0;  ///< m; 0 if the two touch or one is inside the other
      BodyPair pair;
      double required = 0;  ///< what the pair must keep on layers, m
      double least = 0;     ///< clearance of the nearest of all pairs, m
      [[nodiscard]] double margin() const { return distance - required; }
    };
    /// Returns the pair with the least margin, as exactly as FCL tells: the first that has it, and
    /// a pair that touches before any that does not. Returns nothing if there are no pairs. Pairs
    /// that may touch are left out.
    [[nodiscard]] std::optional<Clearance> clearance(const Config& q);
    /// Returns clearance(q), or nothing if neither its margin nor its least clearance is below that
    /// of `so_far`, whose bodies do not touch; a proof of that suffices. If only the least
    /// clearance is below, the result's distance is the largest double.
    [[nodiscard]] std::optional<Clearance> clearance_if_less(const Config& q,
                                                             const Clearance& so_far);
    /// How far a body is from the nearest one that it must keep clear of.
    struct BodyClearance {
      double distance = 0;  ///< m; 0 if the two touch or one is inside the other
      BodyPair pair;
    };
    /// Returns for each body, by its index in body_names(), the nearest of the pairs that it is in,
    /// as exactly as FCL tells, whatever the pairs must keep: the first of those that are equally
    /// near. Nothing for a body without pairs. Pairs that may touch are left out.
    [[nodiscard]] std::vector<std::optional<BodyClearance>> body_clearances(const Config& q);
    /// Returns a point of each of the two bodies of clearance(q), in the base frame, that are as
    /// far apart as the bodies are, within 0.1 mm; meant for drawing. Returns nothing if the bodies
    /// touch or if FCL's points are not credible.
    [[nodiscard]] std::optional<std::array<Vector3d, 2>> nearest_points(const Config& q,
                                                                        const Clearance& clearance);
    /// Returns a point that both bodies contain, in the base frame, within 0.1 mm; meant for
    /// drawing. Returns nothing if they do not touch or no point is found soon.
    [[nodiscard]] std::optional<Vector3d> common_point(const Config& q, const BodyPair& pair);
    [[nodiscard]] CollisionCounters counters() const;

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

 private:
  struct Impl;
  World(detail::MeshStore meshes, const RobotModel& robot, const ArmModel& arm,
        const PathProblem& problem, const Budget& budget);
  std::unique_ptr<Impl> impl_;
};

/// Returns nothing if the motion from q0 to q1 (rad, straight in joint space) is proved free: every
/// pair is clear by its RequiredClearance::motion + h at every midpoint t = (m + 1/2) / N, where N
/// and h are the pair's own. Otherwise returns a pair that comes too near. The search bisects from
/// coarse to fine: an interval is free if each pair is clear in its middle by as much as it can
/// come nearer within the interval, and blocked if a pair in its middle is below
/// RequiredClearance::motion. The query must be of the world that `rule` was made by; it keeps
/// clearances from one motion to the next. `slack`, if not null and no pair is returned, is set to
/// a distance, m: the answer would stay if scene objects stood elsewhere by less than that. It is 0
/// if the rule has pairs with a rule of their own. Throws Stopped.
[[nodiscard]] std::optional<BodyPair> edge_blocked(World::Query& query, const EdgeRule& rule,
                                                   const Config& q0, const Config& q1,
                                                   const Budget& budget = {},
                                                   double* slack = nullptr);
/// Returns whether one pair of the world blocks the motion from q0 to q1 whatever other pairs do,
/// because it is too near at one of the midpoints. Throws Stopped.
[[nodiscard]] bool edge_blocked_by(const BodyPair& pair, World::Query& query, const EdgeRule& rule,
                                   const Config& q0, const Config& q1, const Budget& budget = {});

}  // namespace swivel
