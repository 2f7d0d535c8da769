// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/srs_lattice.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "kinematics/kernels/kernels.hpp"
#include "kinematics/srs/exact_chain_turned.hpp"
#include "lattice/given_posture.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/memory.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

// rad, what a range may have beyond whole turns without another image
constexpr double kSliver = 1e-3;
constexpr double kFarthest = 1e6;  // rad; angles further from 0 lose too much precision
constexpr double kMostWindings = 1024;
constexpr int kShoulderJoints = 0, kElbowJoint = 3, kWristJoints = 4;
constexpr std::size_t kLastJoint = kDof - 1;
/// Bits of groups of links, as shares_body_poses() takes them.
constexpr unsigned kShoulderLinks = 0b0000110, kElbowLinks = 0b0011000, kWristLinks = 0b1100000,
                   kTool = 0b10000000;

int wrapped_index(long long j, int n) {
  return static_cast<int>(((j % n) + n) % n);
}

/// Returns q + 2 pi k, with the least whole k that makes it at least `base`; as the kernels compute
/// it.
double image_from(double q, double base) {
  return q + kTwoPi * std::ceil((base - q) / kTwoPi);
}

/// Returns where the turn begins, rad, in which the angles of a wide joint are given: the turn
/// about 0, or the nearest that leaves 31 turns to both limits.
double turn_within(const JointLimit& limit) {
  constexpr double kFromLimits = (kMostTurns / 2 - 1) * kTwoPi;
  return std::clamp(-kPi, limit.lower + kFromLimits, limit.upper - kFromLimits - kTwoPi);
}

std::uint64_t next_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

std::string gigabytes(double bytes) {
  return std::to_string(static_cast<long long>(bytes / 1e9 + 0.5)) + " GB";
}

/// Returns the highest value, rad, that the given postures have of a joint; `least` if that is
/// more.
double highest_of(const std::array<std::optional<Config>, 2>& given, Eigen::Index joint,
                  double least) {
  for (const std::optional<Config>& q : given)
    if (q) least = std::max(least, (*q)[joint]);
  return least;
}

/// Returns the number of windings of a node, given the images of each joint. Throws InputError
/// where images begin too far from 0, or there are too many windings.
template <class Images>
int count_windings(const std::array<Images, kDof>& images, const Chain& chain,
                   const std::string& source) {
  double windings = 1;
  std::string wound;  // the joints that have more than one image
  for (std::size_t j = 0; j < kDof; ++j) {
    if (!(std::abs(images[j].base) <= kFarthest))
      throw InputError(
          source,
          "joint '" + chain.joint_names[j] +
              "': its limits lie too far from 0: allowed are ranges that begin within 1e6 rad");
    if (images[j].count > 1)
      wound += (wound.empty() ? "" : ", ") + chain.joint_names[j] + ": " +
               std::to_string(images[j].count);
    windings *= images[j].count;
  }
  if (windings > kMostWindings) {
    const std::string number = formatted("%.4g", windings);
    throw InputError(source, "joint limits allow " + number + " windings (" + wound +
                                 "): allowed are 1024: narrow these limits in the URDF, or "
                                 "widen them to more than 64 turns, so that the joint "
                                 "counts as continuous");
  }
  return static_cast<int>(windings);
}

/// Throws InputError where a lattice of `layers` layers of `width` nodes needs more memory than the
/// machine has.
void require_memory(double width, int layers, const std::string& source) {
  const double needed = width * layers * 17.0;  // cost-to-go, states, search
  if (width > 1e8 || !fits_in_memory(needed))
    throw InputError(source, "resolution: " + std::to_string(layers) + " layers x " +
                                 std::to_string(static_cast<long long>(width)) + " nodes need " +
                                 gigabytes(needed) + ", this machine has " +
                                 gigabytes(machine_memory()) + ": allowed are larger ds or dphi");
}

/// Returns by how many of `angles` cells the arm angle may change on a step.
int cells_per_step(int angles, const Limits& limits, const Resolution& resolution) {
  const int window = static_cast<int>(std::min<double>(
      angles / 2,
      std::max(1.0, std::floor(limits.arm_slope * resolution.ds / resolution.dphi + 1e-9))));
  return std::max(window, angles > 1 ? 1 : 0);
}

/// Sets the sines and cosines of the grid angles, three times around the circle.
void fill_grid_angles(int angles, std::vector<double>& sine, std::vector<double>& cosine) {
  sine.resize(static_cast<std::size_t>(3 * angles));
  cosine.resize(sine.size());
  for (int j = 0; j < angles; ++j)
    for (const int k : {j, j + angles, j + 2 * angles}) {
      const double phi_j = -kPi + kTwoPi * j / angles;
      sine[static_cast<std::size_t>(k)] = std::sin(phi_j);
      cosine[static_cast<std::size_t>(k)] = std::cos(phi_j);
    }
}

/// Allots arrays of n numbers each, one after the other.
struct Allotment {
  std::size_t n = 0, used = 0;
  /// Returns where the first of so many arrays begins.
  std::size_t operator()(int arrays = 1) {
    const std::size_t offset = used;
    used += static_cast<std::size_t>(arrays) * n;
    return offset;
  }
};

/// Returns how many arrays the IK solutions of branches `moved` (bits) have of their own: joints
/// and a mask each.
std::size_t own_arrays(std::uint8_t moved, int windings) {
  return static_cast<std::size_t>(std::popcount(moved)) * static_cast<std::size_t>(windings) *
         (kDof + 1);
}

/// The arrays of one elbow side, by the sign of the triples.
struct ElbowArrays {
  std::array<std::array<std::size_t, kDof>, 2> joint{};  // [sign]: of the first image
  std::array<std::array<std::size_t, 2>, 2> mask{};      // [sign][triple]
};

/// Allots one array for each joint, sign of its triple and image, and a mask for each triple and
/// sign; with windings, which have masks of their own, the masks of triples are `never`.
template <class Images>
ElbowArrays allot_elbow(const std::array<Images, kDof>& images, bool windings, std::size_t never,
                        Allotment& allot) {
  ElbowArrays arrays;
  for (std::size_t sign = 0; sign < 2; ++sign) {
    for (std::size_t j = 0; j < kDof; ++j)
      arrays.joint[sign][j] =
          j == kElbowJoint && sign == 1 ? arrays.joint[0][j] : allot(images[j].count);
    for (std::size_t& triple : arrays.mask[sign]) triple = windings ? never : allot();
  }
  return arrays;
}

/// Gives an IK solution arrays of its own: joints, and a mask beside one that is `free`. `span` is
/// widened to hold them.
template <class Offsets, class Span>
void allot_own(std::size_t free, Allotment& allot, Offsets& offsets, Span& span) {
  if (span.end == 0) span.begin = allot.used;
  for (std::size_t& joint : offsets.q) joint = allot();
  offsets.mask = {allot(), free};
  span.end = allot.used;
}

/// Sets entries begin ... end - 1 of the arrays of all images but the first, of the joints whose
/// first images' arrays lie at `offsets`, a whole turn from image to image.
template <class Images>
void fill_images(const std::array<Images, kDof>& images,
                 const std::array<std::size_t, kDof>& offsets, std::size_t n, int begin, int end,
                 double* data) {
  for (std::size_t j = 0; j < kDof; ++j)
    for (std::size_t image = 1; image < static_cast<std::size_t>(images[j].count); ++image) {
      const double* from = data + offsets[j];
      double* to = data + offsets[j] + image * n;
      for (int k = begin; k < end; ++k) to[k] = from[k] + kTwoPi * static_cast<double>(image);
    }
}

/// Sets a winding's mask over entries begin ... begin + length - 1 of its IK solution: 0 where the
/// masks of both triples are 0 and all joints are within their limits, else infinity.
template <class Images>
void fill_winding_mask(const LayerNodes& nodes, int solution,
                       const std::array<Images, kDof>& images, const double* shoulder,
                       const double* wrist, int begin, std::size_t length, double* mask) {
  for (std::size_t k = 0; k < length; ++k) {
    double excess = shoulder[k] + wrist[k];
    for (int j = 0; j < kDof; ++j)
      excess = std::max(excess, nodes.q(solution, j)[static_cast<std::size_t>(begin) + k] -
                                    images[static_cast<std::size_t>(j)].upper);
    mask[k] = excess <= 0 ? 0 : std::numeric_limits<double>::infinity();
  }
}

}  // namespace

SrsLattice::SrsLattice(const Chain& chain, const SrsArm& arm, const ToolPath& path,
                       const PathProblem& problem, const Budget& budget,
                       std::vector<ArmPlane> planes, std::optional<double> last_joint,
                       const Joints& circles)
    : Lattice(chain, Knots(path), problem, arm.fit_error),
      id_(next_id()),
      source_(problem.source),
      has_arcs_(problem.resolution.arcs),
      arm_(&arm),
      last_joint_(last_joint),
      planes_(std::move(planes)) {
  const TraceSpan span("lattice");
  const Resolution& resolution = problem.resolution;
  set_circles(circles, {problem.start, end_});
  const double wanted = std::ceil(kTwoPi / resolution.dphi - 1e-9);
  require_memory(wanted * kBranches * windings_, layers(), problem.source);
  angles_ = static_cast<int>(wanted);
  window_ = cells_per_step(angles_, limits_, resolution);
  fill_grid_angles(angles_, sine_, cosine_);
  if (planes_.empty()) planes_ = carried_planes(arm, path, budget);

  const auto m = static_cast<std::size_t>(layers());
  reach_.reserve(m);
  elbow_circles_.reserve(m);  // half a kilobyte each: touched as they come
  for (int i = 0; i < layers(); ++i) {
    if (i % 64 == 0) budget.poll(Stage::kLattice, i, layers());
    reach_.push_back(reach_status(arm, plane(i).reach));
    auto& of_layer = elbow_circles_.emplace_back();
    if (reach_.back() == ReachStatus::kReachable)
      of_layer = elbow_circles(arm, plane(i), path.layer(i).tool);
  }
  if (problem.start) validate_given(PathEnd::kFirst, problem, chain, path);
  if (end_) validate_given(PathEnd::kLast, problem, chain, path);
  if (!arm.exact) pose_error_model_.emplace(chain, arm);
  place_nodes({problem.start, end_}, budget);
}

Lattice::Joints SrsLattice::possible_circles(const Chain& chain, const SrsArm& arm,
                                             const PathProblem& problem,
                                             const std::vector<Config>& step_bounds) {
  Joints circles{};
  for (std::size_t j = 0; j < kDof && !problem.resolution.arcs; ++j) {
    const auto joint = static_cast<Eigen::Index>(j);
    const JointLimit& limit = chain.limit[j];
    const double lower = limit.lower + problem.limits.joint_margin,
                 upper = limit.upper - problem.limits.joint_margin;
    circles[j] = !limit.continuous && !limit.wide() &&
                 images_between(lower, upper, lower, arm.fit_error[joint]).count > 1 &&
                 std::all_of(step_bounds.begin(), step_bounds.end(), [&](const Config& most) {
                   return most[joint] + 2 * arm.fit_error[joint] < kPi;
                 });
  }
  return circles;
}

void SrsLattice::set_circles(const Joints& circles,
                             const std::array<std::optional<Config>, 2>& given) {
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain_->limit[j];
    const auto joint = static_cast<Eigen::Index>(j);
    constexpr double kUnbounded = std::numeric_limits<double>::infinity();
    const bool rests = last_joint_ && j == kLastJoint;  // within its limits at every arm angle
    circles_[j] = circles[j] && !rests;
    continuous_[j] = limit.continuous || limit.wide() || rests || circles[j];
    if (rests) {
      images_[j] = {*last_joint_ - kPi, kUnbounded, 1};
    } else if (circles[j]) {
      images_[j] = {(limit.lower + limit.upper) / 2 - kPi, kUnbounded, 1};
    } else if (continuous_[j]) {
      images_[j] = {limit.continuous ? -kPi : turn_within(limit), kUnbounded, 1};
    } else {
      const double lower = limit.lower + limits_.joint_margin,
                   upper = limit.upper - limits_.joint_margin;
      images_[j] =
          images_between(lower, upper, highest_of(given, joint, lower), arm_->fit_error[joint]);
    }
  }
  windings_ = count_windings(images_, *chain_, source_);
  tracks_ = 2;
  for (const Images& images : images_) tracks_ += 4 * static_cast<std::size_t>(images.count);
  tracks_ += windings_ == 1 ? 8 : static_cast<std::size_t>(solutions());
}

void SrsLattice::place_nodes(const std::array<std::optional<Config>, 2>& given,
                             const Budget& budget) {
  const Images& images = images_[kElbowJoint];
  elbow_alive_.clear();
  for (std::size_t i = 0; i < elbow_circles_.size(); ++i)
    for (const ElbowCircle& circle : elbow_circles_[i])  // one elbow angle serves the whole circle
      elbow_alive_.push_back(reach_[i] == ReachStatus::kReachable &&
                             image_from(circle.q4, images.base) <= images.upper);
  if (given[0]) start_ = placed(0, *given[0]);
  if (given[1]) last_ = placed(layers() - 1, *given[1]);
  prepare_arcs();
  if (has_arcs_) place_off_grid_nodes(budget);
}

std::unique_ptr<Lattice> SrsLattice::with_windings(const Joints& joints) const {
  std::unique_ptr<SrsLattice> wound(new SrsLattice(*this));
  wound->id_ = next_id();
  wound->told_apart_.push_back(joints);
  Joints circles = circles_;
  for (std::size_t j = 0; j < kDof; ++j) circles[j] = circles[j] && !joints[j];
  std::array<std::optional<Config>, 2> given;
  if (start_) given[0] = start_->row;
  if (last_) given[1] = last_->row;
  wound->set_circles(circles, given);
  require_memory(wound->width(), layers(), source_);
  wound->place_nodes(given, {});
  return wound;
}

int SrsLattice::slot_on_circles(int, int slot) const {
  int solution = branch_of(slot);
  for (int j = 0; j < kDof; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const bool circle = std::any_of(told_apart_.begin(), told_apart_.end(),
                                    [k](const Joints& joints) { return joints[k]; });
    if (circle) continue;
    solution = solution * images_[k].count + winding_images(solution_of(slot) % windings_, j);
  }
  return solution * angles_ + angle_of(slot);
}

namespace {

/// Turns the planes of a closed path's layers back, so that the last one is the first one.
void turn_back(const ToolPath& path, std::vector<ArmPlane>& planes) {
  const Vector3d u = planes.back().u, r = planes.back().r, first = planes.front().r;
  const double holonomy = std::atan2(u.dot(first.cross(r)), first.dot(r)),
               whole = path.layer(path.size() - 1).travel;
  for (int i = 0; i < path.size(); ++i) {
    ArmPlane& plane = planes[static_cast<std::size_t>(i)];
    const double angle = -holonomy * path.layer(i).travel / whole;
    plane.r = (Eigen::AngleAxisd(angle, plane.u) * plane.r).normalized();
  }
  planes.front().r = first;
  planes.back() = planes.front();
}

}  // namespace

std::vector<ArmPlane> carried_planes(const SrsArm& arm, const ToolPath& path,
                                     const Budget& budget) {
  if (path.unturned()) {
    std::vector<ArmPlane> planes = carried_planes(arm, *path.unturned(), budget);
    for (int i = 0; i < path.size(); ++i) {
      ArmPlane& plane = planes[static_cast<std::size_t>(i)];
      plane = carry_plane(arm, plane, path.layer(i).tool);
    }
    return planes;
  }
  std::optional<ArmPlane> last;  // of the layers of the whole path so far
  const auto carried = [&](const Pose& tool) {
    return last ? carry_plane(arm, *last, tool) : first_plane(arm, tool);
  };
  for (std::size_t i = 0; i < path.before().size(); ++i) {
    if (i % 64 == 0) budget.poll();
    last = carried(path.before()[i]);
  }
  std::vector<ArmPlane> planes;
  planes.reserve(static_cast<std::size_t>(path.size()));
  for (int i = 0; i < path.size(); ++i) {
    if (i % 64 == 0) budget.poll();
    planes.push_back(carried(path.layer(i).tool));
    if (i > 0 || path.begins_on_layer()) last = planes.back();
  }
  if (path.closed()) turn_back(path, planes);
  return planes;
}

SrsLattice::Images SrsLattice::images_between(double lower, double upper, double highest,
                                              double fit_error) {
  const double whole = std::floor((upper - lower) / kTwoPi),
               rest = (upper - lower) - whole * kTwoPi;
  Images images;
  images.count = std::max(1, static_cast<int>(whole) + (rest > kSliver ? 1 : 0));
  const double length = images.count * kTwoPi;
  // The range is wider by the fit error at both ends, which must not add another image of an angle
  // that it has already.
  const double slack = std::max(0.0, (length - (upper - lower)) / 2);
  images.base = lower - kLimitTolerance - std::min(fit_error, slack);
  images.upper = upper + kLimitTolerance + fit_error;
  // A range of a sliver more than whole turns is cut off by the sliver: at the upper end, or at the
  // lower where a start or an end is there.
  if (highest >= images.base + length) images.base = upper + kLimitTolerance - length;
  return images;
}

SrsLattice::Given SrsLattice::placed(int layer, const Config& q) const {
  Given given;
  given.row = q;
  given.phi = plane(layer).angle_of(arm_->elbow_axis(q));
  given.node = arm_->exact ? q : fitted(layer, q, given.phi).value_or(q);
  int winding = 0;
  for (int k = 0; k < kDof; ++k) {
    const Images& images = images_[static_cast<std::size_t>(k)];
    const int image = images.count == 1
                          ? 0
                          : std::clamp(static_cast<int>(std::floor((q[k] - images.base) / kTwoPi)),
                                       0, images.count - 1);
    winding = winding * images.count + image;
  }
  const int nearest = wrapped_index(std::llround((given.phi + kPi) / kTwoPi * angles_), angles_);
  given.slot = (arm_->branch(q) * windings_ + winding) * angles_ + nearest;
  return given;
}

std::optional<Config> SrsLattice::fitted(int layer, const Config& q, double phi) const {
  const auto i = static_cast<std::size_t>(layer);
  if (reach_[i] != ReachStatus::kReachable) return std::nullopt;
  Config fitted = srs_ik(*arm_, elbow_circles_[i], phi, arm_->branch(q));
  if (singular(fitted)) return std::nullopt;
  for (int k = 0; k < kDof; ++k) {
    fitted[k] = q[k] + wrap_angle(fitted[k] - q[k]);
    if (!(std::abs(fitted[k] - q[k]) <= kMostCorrection)) return std::nullopt;
  }
  return fitted;
}

bool SrsLattice::singular(const Config& q) const {
  return std::abs(std::sin(arm_->shoulder_angle(q))) < kSingularSine ||
         std::abs(std::sin(arm_->wrist_angle(q))) < kSingularSine;
}

std::uint8_t SrsLattice::joints_outside(const Config& row) const {
  unsigned outside = 0;
  for (int k = 0; k < kDof; ++k) {
    const JointLimit& limit = chain_->limit[static_cast<std::size_t>(k)];
    const double margin = limits_.joint_margin - kLimitTolerance;
    if (!continuous_[static_cast<std::size_t>(k)] &&
        !(row[k] >= limit.lower + margin && row[k] <= limit.upper - margin))
      outside |= 1u << k;
  }
  return static_cast<std::uint8_t>(outside);
}

double SrsLattice::phi(int layer, int slot) const {
  if (const Given* const only = given(layer)) return only->phi;
  if (const OffGridNode* moved = find_off_grid(layer, slot)) return moved->phi;
  return cell_angle(slot);
}

int SrsLattice::winding_images(int winding, int joint) const {
  if (windings_ == 1) return 0;
  for (int k = kDof - 1; k > joint; --k) winding /= images_[static_cast<std::size_t>(k)].count;
  return winding % images_[static_cast<std::size_t>(joint)].count;
}

void SrsLattice::solve(int layer, int first, int count, LayerNodes& out) const {
  lay_out(layer, first, count, out);
  for (int elbow = 0; elbow < 2; ++elbow) solve_part(elbow, 0, count, out);
}

void LayerNodes::repeat(int elbow, int from, int to, int count) {
  for (const Span& arrays : arrays_[static_cast<std::size_t>(elbow)])
    for (std::size_t array = arrays.begin; array < arrays.end;
         array += static_cast<std::size_t>(count_))
      std::copy_n(data_.data() + array + from, count, data_.data() + array + to);
}

std::optional<double> SrsLattice::elbow_angle(int layer, int elbow) const {
  const Images& images = images_[kElbowJoint];
  if (images.count > 1 || continuous_[kElbowJoint] || is_given(layer) || !elbow_alive(layer, elbow))
    return std::nullopt;
  return image_from(
      elbow_circles_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(elbow)].q4,
      images.base);
}

void SrsLattice::lay_out(int layer, int first, int count, LayerNodes& out) const {
  const auto n = static_cast<std::size_t>(count);
  out.layer_ = layer;
  out.first_ = first;
  const Given* const only = given(layer);
  const std::uint8_t moved =
      off_grid_.empty() ? std::uint8_t{0} : off_grid_branches_[static_cast<std::size_t>(layer)];
  const LayerNodes::Layout layout{
      id_, count, elbow_alive(layer, 0), elbow_alive(layer, 1), only != nullptr, moved};
  if (layout == out.layout_ && !only) return;
  out.layout_ = layout;
  out.count_ = count;
  out.arrays_ = {};
  out.offsets_.resize(static_cast<std::size_t>(solutions()));
  const auto needed = static_cast<Eigen::Index>((tracks_ + own_arrays(moved, windings_)) * n);
  if (out.data_.size() < needed) out.data_.setZero(needed);
  Allotment allot{n};
  const std::size_t free = allot(), never = allot();
  std::fill_n(out.data_.data() + free, n, 0.0);
  std::fill_n(out.data_.data() + never, n, std::numeric_limits<double>::infinity());
  if (only) {
    for (LayerNodes::Offsets& solution : out.offsets_)
      solution = {.q = {}, .mask = {never, free}, .alive = false};
    return lay_out_given(*only, out);
  }
  for (int elbow = 0; elbow < 2; ++elbow) {
    const bool alive = elbow_alive(layer, elbow);
    const std::size_t begin = allot.used;
    ElbowArrays arrays;
    if (alive) arrays = allot_elbow(images_, windings_ > 1, never, allot);
    for (std::size_t sign = 0; alive && sign < 2; ++sign)
      out.shared_[static_cast<std::size_t>(elbow)][sign] = {arrays.joint[sign], arrays.mask[sign],
                                                            alive};
    const int first_solution = elbow ? kElbowBit * windings_ : 0;
    for (int solution = first_solution; solution < first_solution + 4 * windings_; ++solution) {
      const int branch = solution / windings_;
      LayerNodes::Offsets& offsets = out.offsets_[static_cast<std::size_t>(solution)];
      offsets.alive = alive;
      offsets.mask = {never, free};
      if (!alive) continue;
      const std::size_t shoulder = branch & kShoulderBit ? 1 : 0,
                        wrist = branch & kWristBit ? 1 : 0;
      if (windings_ == 1)
        offsets.mask = {arrays.mask[shoulder][0], arrays.mask[wrist][1]};
      else
        offsets.mask = {allot(), free};
      for (int j = 0; j < kDof; ++j)
        offsets.q[static_cast<std::size_t>(j)] =
            arrays.joint[j < kWristJoints ? shoulder : wrist][static_cast<std::size_t>(j)] +
            static_cast<std::size_t>(winding_images(solution % windings_, j)) * n;
    }
    out.arrays_[static_cast<std::size_t>(elbow)][0] = {begin, allot.used};
  }
  allot.used = tracks_ * n;
  for (int solution = 0; moved && solution < solutions(); ++solution)
    if (moved >> (solution / windings_) & 1)
      allot_own(free, allot, out.offsets_[static_cast<std::size_t>(solution)],
                out.arrays_[static_cast<std::size_t>(elbow_side_of(solution))][1]);
}

void SrsLattice::lay_out_given(const Given& given, LayerNodes& out) const {
  const int solution = solution_of(given.slot), n = out.count_;
  LayerNodes::Offsets& offsets = out.offsets_[static_cast<std::size_t>(solution)];
  offsets.alive = true;
  std::size_t used = 2 * static_cast<std::size_t>(n);
  for (std::size_t j = 0; j < kDof; ++j, used += static_cast<std::size_t>(n)) {
    offsets.q[j] = used;
    std::fill_n(out.data_.data() + used, n, given.node[static_cast<Eigen::Index>(j)]);
  }
  offsets.mask[0] = used;
  double* const mask = out.data_.data() + used;
  std::fill_n(mask, n, std::numeric_limits<double>::infinity());
  if (fault(out.layer_, given.slot).status != NodeStatus::kValid) return;
  for (int k = wrapped_index(static_cast<long long>(angle_of(given.slot)) - out.first_, angles_);
       k < n; k += angles_)
    mask[k] = 0;
}

TripleTask SrsLattice::triple_task(const ElbowCircle& circle, int triple) const {
  TripleTask task;
  const TripleCircle& m = triple == 0 ? circle.shoulder : circle.wrist;
  for (std::size_t row = 0; row < 5; ++row)
    for (std::size_t column = 0; column < 3; ++column) task.m[row][column] = m[row][column];
  task.shift = triple == 0 ? arm_->shoulder.shift : arm_->wrist.shift;
  task.least_sine = kSingularSine;
  for (std::size_t j = 0; j < 3; ++j) {
    const Images& images =
        images_[static_cast<std::size_t>(triple == 0 ? kShoulderJoints : kWristJoints) + j];
    task.base[j] = images.base;
    task.upper[j] = windings_ == 1 ? images.upper : std::numeric_limits<double>::infinity();
  }
  return task;
}

void SrsLattice::solve_part(int elbow, int begin, int end, LayerNodes& out) const {
  if (!elbow_alive(out.layer_, elbow) || is_given(out.layer_)) return;
  const ElbowCircle& circle =
      elbow_circles_[static_cast<std::size_t>(out.layer_)][static_cast<std::size_t>(elbow)];
  const int first_solution = elbow ? kElbowBit * windings_ : 0;
  double* const data = out.data_.data();
  const std::array<LayerNodes::Offsets, 2>& sign = out.shared_[static_cast<std::size_t>(elbow)];
  const bool shares_masks = windings_ == 1;
  // masks of singularity alone, where each winding has limits of its own
  std::vector<double> unlimited;
  if (!shares_masks) unlimited.resize(static_cast<std::size_t>(4 * (end - begin)));
  for (int triple = 0; triple < 2; ++triple) {
    const int joint0 = triple == 0 ? kShoulderJoints : kWristJoints;
    TripleTask task = triple_task(circle, triple);
    task.n = end - begin;
    task.sin_phi = sine_.data() + out.first_ + begin;
    task.cos_phi = cosine_.data() + out.first_ + begin;
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t s = 0; s < 2; ++s)
        task.q[s][j] = data + sign[s].q[static_cast<std::size_t>(joint0) + j] + begin;
    for (std::size_t s = 0; s < 2; ++s)
      task.mask[s] = shares_masks ? data + sign[s].mask[static_cast<std::size_t>(triple)] + begin
                                  : unlimited.data() + (static_cast<std::size_t>(triple) * 2 + s) *
                                                           static_cast<std::size_t>(task.n);
    circle_kernels().solve_triple(task);
  }
  for (std::size_t s = 0; s < 2 && last_joint_; ++s)
    std::fill(data + sign[s].q[kLastJoint] + begin, data + sign[s].q[kLastJoint] + end,
              *last_joint_);
  std::fill(data + sign[0].q[kElbowJoint] + begin, data + sign[0].q[kElbowJoint] + end,
            image_from(circle.q4, images_[kElbowJoint].base));
  for (std::size_t s = 0; s < 2 && !shares_masks; ++s)
    fill_images(images_, sign[s].q, static_cast<std::size_t>(out.count_), begin, end, data);
  for (int solution = first_solution;
       solution < first_solution + 4 * windings_ && out.layout_.moved; ++solution)
    if (out.layout_.moved >> (solution / windings_) & 1) copy_shared(solution, begin, end, out);
  const auto length = static_cast<std::size_t>(end - begin);
  for (int solution = first_solution; solution < first_solution + 4 * windings_ && !shares_masks;
       ++solution) {
    const int branch = solution / windings_;
    fill_winding_mask(out, solution, images_,
                      unlimited.data() + (branch & kShoulderBit ? length : 0),
                      unlimited.data() + (branch & kWristBit ? 3 : 2) * length, begin, length,
                      data + out.at(solution).mask[0] + begin);
  }
  for (const OffGridNode& moved : this->off_grid_nodes(out.layer_)) {
    const int solution = solution_of(moved.slot);
    if (elbow_side_of(solution) != elbow) continue;
    const LayerNodes::Offsets& own = out.at(solution);
    for (int k = wrapped_index(static_cast<long long>(angle_of(moved.slot)) - out.first_, angles_);
         k < end; k += angles_) {
      if (k < begin) continue;
      for (std::size_t j = 0; j < kDof; ++j)
        data[own.q[j] + static_cast<std::size_t>(k)] = moved.q[static_cast<Eigen::Index>(j)];
      data[own.mask[0] + static_cast<std::size_t>(k)] = 0;
    }
  }
}

void SrsLattice::copy_shared(int solution, int begin, int end, LayerNodes& out) const {
  const int branch = branch_of(solution * angles_);
  double* const data = out.data_.data();
  const std::array<LayerNodes::Offsets, 2>& sign = out.shared_[branch & kElbowBit ? 1 : 0];
  const LayerNodes::Offsets &shoulder = sign[branch & kShoulderBit ? 1 : 0],
                            &wrist = sign[branch & kWristBit ? 1 : 0];
  const LayerNodes::Offsets& own = out.at(solution);
  for (int j = 0; j < kDof; ++j) {
    const auto image = static_cast<std::size_t>(winding_images(solution % windings_, j)) *
                       static_cast<std::size_t>(out.count_);
    const double* from =
        data + (j < kWristJoints ? shoulder : wrist).q[static_cast<std::size_t>(j)] + image;
    std::copy(from + begin, from + end, data + own.q[static_cast<std::size_t>(j)] + begin);
  }
  if (windings_ > 1) return;  // each winding has a mask of its own
  for (int k = begin; k < end; ++k)
    data[own.mask[0] + static_cast<std::size_t>(k)] =
        data[shoulder.mask[0] + static_cast<std::size_t>(k)] +
        data[wrist.mask[1] + static_cast<std::size_t>(k)];
}

std::optional<Config> SrsLattice::node(int layer, int slot) const {
  if (const Given* const only = given(layer))
    return fault(layer, slot).status == NodeStatus::kValid ? std::optional(only->node)
                                                           : std::nullopt;
  if (const OffGridNode* moved = find_off_grid(layer, slot)) return moved->q;
  const auto j = static_cast<std::size_t>(angle_of(slot));
  return solved(layer, slot, sine_[j], cosine_[j]);
}

std::optional<Config> SrsLattice::solved(int layer, int slot, double sine, double cosine) const {
  const int branch = branch_of(slot), elbow = branch & kElbowBit ? 1 : 0;
  if (!elbow_alive(layer, elbow)) return std::nullopt;
  const ElbowCircle& circle =
      elbow_circles_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(elbow)];
  Config q;
  double excess = 0;
  for (int triple = 0; triple < 2; ++triple) {
    std::array<std::array<double, 3>, 2> joints;
    std::array<double, 2> mask;
    TripleTask task = triple_task(circle, triple);
    task.n = 1;
    task.sin_phi = &sine;
    task.cos_phi = &cosine;
    for (std::size_t s = 0; s < 2; ++s) {
      for (std::size_t j = 0; j < 3; ++j) task.q[s][j] = &joints[s][j];
      task.mask[s] = &mask[s];
    }
    circle_kernels().solve_triple(task);
    const std::size_t sign = branch & (triple == 0 ? kShoulderBit : kWristBit) ? 1 : 0;
    for (int j = 0; j < 3; ++j)
      q[(triple == 0 ? kShoulderJoints : kWristJoints) + j] =
          joints[sign][static_cast<std::size_t>(j)];
    excess += mask[sign];
  }
  q[kElbowJoint] = image_from(circle.q4, images_[kElbowJoint].base);
  if (last_joint_) q[kLastJoint] = *last_joint_;
  if (windings_ > 1)
    for (int j = 0; j < kDof; ++j) {
      q[j] += kTwoPi * static_cast<double>(winding_images(solution_of(slot) % windings_, j));
      excess = std::max(excess, q[j] - images_[static_cast<std::size_t>(j)].upper);
    }
  return excess <= 0 ? std::optional(q) : std::nullopt;
}

std::optional<Config> SrsLattice::on_exact_chain(int layer, int slot, const Config& q) const {
  const Pose& tool = path_->layer(layer).tool;
  return last_joint_
             ? solve_exact_chain_turned(*chain_, *arm_, plane(layer), tool, phi(layer, slot), q)
             : solve_exact_chain(*chain_, *arm_, plane(layer), tool, phi(layer, slot), q);
}

std::optional<Config> SrsLattice::exact_config(int layer, int slot, const Config& q) const {
  if (arm_->exact) return q;
  if (const Given* const only = given(layer)) return only->row;
  auto row = on_exact_chain(layer, slot, q);
  if (row && joints_outside(*row)) row.reset();
  return row;
}

Lattice::NodeFault SrsLattice::fault(int layer, int slot) const {
  NodeFault fault;
  const Given* const only = given(layer);
  if (only && slot != only->slot) return {NodeStatus::kNoIk};
  if (only && !arm_->exact)
    return {singular(only->row) ? NodeStatus::kSingular : NodeStatus::kValid};
  const ReachStatus reach = reach_[static_cast<std::size_t>(layer)];
  if (reach == ReachStatus::kOutOfReach) return {NodeStatus::kNoIk};
  if (reach == ReachStatus::kSingular) return {NodeStatus::kSingular};
  Config q = only ? only->row
                  : srs_ik(*arm_, elbow_circles_[static_cast<std::size_t>(layer)], phi(layer, slot),
                           branch_of(slot));
  if (singular(q)) return {NodeStatus::kSingular};
  if (only) return fault;
  if (last_joint_) q[kLastJoint] = *last_joint_;
  const int winding = solution_of(slot) % windings_;
  for (int j = 0; j < kDof; ++j) {
    const Images& images = images_[static_cast<std::size_t>(j)];
    const double first = image_from(q[j], images.base), below = first - kTwoPi;
    q[j] = first + kTwoPi * winding_images(winding, j);
    if (q[j] <= images.upper) continue;
    fault.joints |= static_cast<std::uint8_t>(1 << j);
    if (images.base - below < q[j] - images.upper) q[j] = below;
  }
  fault.q = q;
  if (!arm_->exact) {
    const auto row = on_exact_chain(layer, slot, q);
    if (!row) return {NodeStatus::kNoIk};
    fault.q = *row;
    if (const std::uint8_t outside = joints_outside(*row)) fault.joints = outside;
  }
  if (fault.joints) fault.status = NodeStatus::kLimit;
  return fault;
}

std::optional<Lattice::Reach> SrsLattice::out_of_reach(int layer) const {
  const double distance = plane(layer).reach, most = arm_->upper + arm_->fore,
               least = std::abs(arm_->upper - arm_->fore);
  if (distance > most) return Reach{distance, most};
  if (distance < least) return Reach{distance, least};
  return std::nullopt;
}

void SrsLattice::layer_nodes(int layer, std::vector<Node>& out) const {
  LayerNodes nodes;
  solve(layer, nodes);
  out.clear();
  for (int slot = 0; slot < width(); ++slot)
    if (nodes.valid(solution_of(slot), angle_of(slot)))
      out.push_back({slot, nodes.config(solution_of(slot), angle_of(slot))});
}

int SrsLattice::neighbour_in_redundancy(int, int slot, int by) const {
  return solution_of(slot) * angles_ + (angle_of(slot) + by + angles_) % angles_;
}

int SrsLattice::neighbour_along_path(int layer, int slot, int by) const {
  return layer + by < 0 || layer + by >= layers() ? -1 : slot;
}

void SrsLattice::slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                            std::vector<int>& out) const {
  if (!shares_body_poses(groups)) return out.assign(1, slot);
  if (last_joint_ && groups & kTool) groups |= kWristLinks;
  const bool all_angles = (groups & (kShoulderLinks | kElbowLinks | kWristLinks)) == 0;
  out.clear();
  const int signs = (groups & kShoulderLinks ? kShoulderBit : 0) |
                    (groups & kWristLinks ? kWristBit : 0) | (all_angles ? 0 : kElbowBit);
  const int branch = branch_of(slot);
  const int first = all_angles ? 0 : angle_of(slot), last = all_angles ? angles_ - 1 : first;
  for (int solution = 0, other = 0; solution < solutions(); solution += windings_, ++other) {
    if ((other ^ branch) & signs) continue;
    for (int winding = 0; winding < windings_; ++winding)
      for (int j = first; j <= last; ++j) out.push_back((solution + winding) * angles_ + j);
  }
  if (all_angles || off_grid_nodes(layer).empty()) return;
  const double angle = phi(layer, slot);  // cells move IK solution by IK solution
  std::erase_if(out, [&](int other) { return phi(layer, other) != angle; });
}

unsigned SrsLattice::manipulability_groups() const {
  return kElbowLinks;
}

bool SrsLattice::all_below_manipulability(int layer, const Config& q) const {
  // determinants of lengths of metres, which rounding changes by 1e-12
  constexpr double kBand = 1e-10;
  const auto J = chain_->jacobian(q);
  const Eigen::Matrix<double, 6, 6> G = J * J.transpose();
  const double found = G.determinant(),
               allowed = limits().manipulability * limits().manipulability - kBand;
  if (!pose_error_model_ || !(found < allowed)) return found < allowed;
  if (last_joint_ || is_given(layer) || found < kBand)
    return false;  // not known, or G's inverse is all rounding
  // No singular value s of J grows by more than `change` to the row, so their product, the
  // manipulability, grows by at most (1 + change * mean of 1 / s)^6. That mean is at most the root
  // of the mean of 1 / s^2, which are the eigenvalues of G's inverse. docs/theory.md, Lemma 6.
  const double change = pose_error_model_->jacobian_change(plane(layer).reach, q);
  const double ratio = 1 + change * std::sqrt(G.inverse().trace() / 6);
  return found * std::pow(ratio, 12) < allowed;
}

PoseErrorBound SrsLattice::pose_error_of_node(int layer, int group, const Config& q) const {
  if (!pose_error_model_) return {};
  return is_given(layer) ? PoseErrorBound::unknown(pose_error_model_->about(group))
                         : pose_error_model_->from_node(group, plane(layer).reach, q);
}

PoseErrorBound SrsLattice::pose_error_between(int layer, int group, const Config& q) const {
  if (!pose_error_model_) return {};
  return is_given(layer) ? PoseErrorBound::unknown(pose_error_model_->about(group))
                         : pose_error_model_->between_exact_configs(group, plane(layer).reach, q);
}

bool SrsLattice::may_change_elbow_side(int step_layer, int layer, int side, int other_layer,
                                       int other) const {
  if (side == other) return true;
  if (!alive(layer, side) || !alive(other_layer, other)) return false;
  const auto angle = elbow_angle(layer, side), other_angle = elbow_angle(other_layer, other);
  return !angle || !other_angle ||
         std::abs(*angle - *other_angle) <= step_bound(step_layer)[kElbowJoint];
}

bool SrsLattice::step_error_allowed(int layer, int a, int b) const {
  const double phi_a = phi(layer, a), phi_b = phi(layer + 1, b), dphi = wrap_angle(phi_b - phi_a);
  return step_error(*this, layer, 0, branch_of(a), phi_a, dphi) <= *limits().step_error &&
         step_error(*this, layer, 1, branch_of(b), phi_b, dphi) <= *limits().step_error;
}

bool SrsLattice::in_window(int layer, int a, int b) const {
  if (layer == 0 && start_)
    return std::abs(wrap_angle(cell_angle(b) - start_->phi)) <= window_ * kTwoPi / angles_ + 1e-9;
  const int apart = std::abs(angle_of(a) - angle_of(b));
  return std::min(apart, angles_ - apart) <= window_;
}

SrsLattice::Run SrsLattice::grid_run(double phi_from) const {
  const double step = kTwoPi / angles_;
  const auto first = static_cast<long long>(std::ceil((phi_from + kPi - 1e-9) / step - window_));
  const auto last = static_cast<long long>(std::floor((phi_from + kPi + 1e-9) / step + window_));
  return {wrapped_index(first, angles_),
          static_cast<int>(std::min<long long>(last - first + 1, angles_))};
}

void SrsLattice::successors(int layer, int a, std::vector<SlotRun>& out) const {
  const Run run = run_after(layer, a);
  out.clear();
  for (int solution = 0; solution < solutions(); ++solution) {
    const int zero = solution * angles_, end = run.first + run.count;
    out.push_back({zero + run.first, zero + std::min(end, angles_)});
    if (end > angles_) out.push_back({zero, zero + end - angles_});
  }
}

SrsLattice::Run SrsLattice::run_after(int layer, int a) const {
  if (layer == 0 && start_) return grid_run(start_->phi);
  return {wrapped_index(static_cast<long long>(angle_of(a)) - window_, angles_),
          std::min(2 * window_ + 1, angles_)};
}

SrsLattice::Run SrsLattice::run_before(int layer, int b) const {
  if (layer == 0 && start_)
    return in_window(0, start_->slot, b) ? Run{angle_of(start_->slot), 1} : Run{0, 0};
  return {wrapped_index(static_cast<long long>(angle_of(b)) - window_, angles_),
          std::min(2 * window_ + 1, angles_)};
}

LatticeInfo SrsLattice::describe() const {
  LatticeInfo info = Lattice::describe();
  info.grid = LatticeInfo::Grid{angles_, kBranches, windings_, window_};
  return info;
}

}  // namespace swivel
