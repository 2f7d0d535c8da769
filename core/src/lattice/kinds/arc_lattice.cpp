// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/arc_lattice.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "kinematics/self_motion/pose_solutions.hpp"
#include "lattice/given_posture.hpp"
#include "lattice/kinds/arc_layers.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"

namespace swivel {

namespace {

using Point = ExplicitLattice::Point;

std::array<double, kDof> scaling(const Chain& chain, const Cost& cost) {
  std::array<double, kDof> weights = joint_weights(cost, chain);
  for (std::size_t j = 0; cost.metric == CostMetric::kTime && j < kDof; ++j)
    weights[j] = chain.limit[j].velocity > 0 ? 1 / chain.limit[j].velocity : chain.roll ? 0 : 1;
  return weights;
}

/// Returns the point on the axis of joint `axis` that is nearest to that of its neighbour `other`.
Vector3d foot(const Chain& chain, std::size_t axis, std::size_t other) {
  const Vector3d &a = chain.axis[axis], &b = chain.axis[other], n = a.cross(b),
                 d = chain.point[other] - chain.point[axis];
  const double sine2 = n.squaredNorm();
  if (sine2 < 1e-12) return chain.point[axis];
  return chain.point[axis] + (d.cross(b).dot(n) / sine2) * a;
}

/// Returns which joints count as circles although they are bounded.
std::array<bool, kDof> bounded_circles(const Chain& chain, const SelfMotion& motion) {
  std::array<bool, kDof> circles = motion.circles();
  for (std::size_t j = 0; j < kDof; ++j) circles[j] = circles[j] && !chain.limit[j].continuous;
  return circles;
}

/// Throws InputError unless the posture that the problem gives for an end of the path is within its
/// limits and puts the tool there.
void require_fits(PathEnd which, const PathProblem& problem, const Chain& chain,
                  const ToolPath& path) {
  validate_given(which, problem, chain, path);
  if (chain.roll)
    static_cast<void>(roll_of_given(which, problem, chain, path,
                                    {chain.limit.back().lower, chain.limit.back().upper}));
}

/// Returns the nodes of layer 0 as those of the last layer of a closed path. They continue no node
/// of the layer before.
std::vector<Point> as_last_layer(std::vector<Point> points) {
  for (Point& point : points) point.along = {-1, -1};
  return points;
}

/// Returns a given posture as the only node of its layer, in the winding that the lattice's nodes
/// have.
Point given_point(const SelfMotion& motion, const Config& q) {
  Point point;
  point.q = q;
  static_cast<void>(motion.canonical(point.q));
  return point;
}

}  // namespace

ArcLattice::Data ArcLattice::build(const Chain& chain, const LockMethod& method,
                                   const ToolPath& whole, const PathProblem& problem,
                                   const Budget& budget) {
  const TraceSpan span("arcs");
  const double knot = chain.roll_fixed ? 0 : problem.resolution.knot_of_arcs();
  Data result(knot > 0 ? Knots(whole, knots_along(whole, knot)) : Knots(whole));
  std::vector<std::vector<Point>> points;
  const ToolPath& path = result.knots.path();
  if (problem.start) require_fits(PathEnd::kFirst, problem, chain, path);
  const bool ends_given = problem.end && !path.ends_early();
  if (ends_given) require_fits(PathEnd::kLast, problem, chain, path);
  result.motion = std::make_shared<const SelfMotion>(chain, method, problem.limits.joint_margin,
                                                     scaling(chain, problem.cost));
  const SelfMotion& motion = *result.motion;
  result.circles = bounded_circles(chain, motion);
  const ArcLayerMaker maker(chain, method, problem, motion);
  CarriedNodes before;
  std::vector<std::int64_t> solutions;  // of each layer
  for (int i = 0; i < path.size(); ++i) {
    budget.poll();
    if (i + 1 == path.size() && ends_given) {  // the end is the only node, and continues none
      points.push_back({given_point(motion, joints_given(PathEnd::kLast, problem, chain, path))});
      break;
    }
    if (i + 1 == path.size() && path.closed() && !problem.start) {
      points.push_back(as_last_layer(points.front()));
      break;
    }
    ArcLayer made = maker.make(path.layer(i), before, i > 0 ? &points.back() : nullptr);
    result.arcs += made.arcs;
    solutions.push_back(made.arcs);
    before = std::move(made.carried);
    if (i == 0 && problem.start) {
      // The start is the only node of layer 0; the others are transported as if there were none.
      const Point start = given_point(motion, joints_given(PathEnd::kFirst, problem, chain, path));
      before.q.push_back(start.q);
      before.slots.push_back(before.nodes);
      before.start = true;
      points.push_back({start});
      continue;
    }
    points.push_back(std::move(made.points));
  }
  if (chain.roll_fixed)
    maker.carry_back(path, solutions, points, problem.start || path.closed() ? 1 : 0);
  result.points = shared(std::move(points));
  return result;
}

ArcLattice::ArcLattice(const Chain& chain, const LockMethod& method, const ToolPath& path,
                       const PathProblem& problem, const Budget& budget, const SrsArm* srs)
    : ArcLattice(chain, method, problem, build(chain, method, path, problem, budget)) {
  data_.srs = srs;
  if (srs) data_.planes = carried_planes(*srs, path, budget);
}

ArcLattice::ArcLattice(const Chain& chain, const LockMethod& method, const PathProblem& problem,
                       Data&& data)
    : ExplicitLattice(chain, data.knots, problem, std::move(data.points), data.circles),
      method_(method),
      problem_(problem),
      data_(std::move(data)) {
  data_.points.clear();
}

int arc_branch(const Chain& chain, const LockMethod& method, const Config& q) {
  const auto J = chain.jacobian(q);
  const int left_out = chain.roll_fixed ? kDof - 1 : method.best >= 0 ? method.best : 2;
  Matrix6 rest;
  rest << J.leftCols(left_out), J.rightCols(kSix - left_out);
  const bool whole = rest.determinant() < 0;
  if (method.best < 0) return whole ? 1 : 0;
  const ClosedFormFit& fit = *method.by_joint[static_cast<std::size_t>(method.best)];
  // The triple, or the last of three parallel axes and the two behind it.
  const int first = fit.structure == Structure::kParallel ? (fit.first == 1 ? 3 : 0) : fit.first;
  const auto axis = [&](int k) -> Vector3d {
    return rest.block<3, 1>(3, std::min(first + k, kSix - 1));
  };
  const bool triple = axis(0).dot(axis(1).cross(axis(2))) < 0;
  return (triple ? 1 : 0) | (whole != triple ? 2 : 0);
}

double arc_angle(const Chain& chain, const Config& q) {
  if (chain.roll) return q[kDof - 1];
  if (const int slide = chain.slide(); slide >= 0)
    return wrap_angle(q[slide + 1 < kDof ? slide + 1 : slide - 1]);
  const auto G = chain.displacements(q);
  const Vector3d S = G[1] * foot(chain, 1, 0), E = G[3] * foot(chain, 3, 2),
                 W = G[5] * foot(chain, 5, 6);
  const Vector3d u = (W - S).normalized();
  Vector3d r = u.cross(Vector3d::UnitZ());
  if (r.norm() < 1e-3) r = u.cross(Vector3d::UnitX());
  const Vector3d up = r.cross(u), elbow = E - S;
  return std::atan2(u.dot(up.cross(elbow)), up.dot(elbow));
}

TrajectoryRow ArcLattice::labelled(int layer, const Config& q) const {
  const double s = path_of_rows().layer(layer).s;
  if (data_.srs)
    return {s, arm_angle(*data_.srs, data_.planes[static_cast<std::size_t>(layer)], q),
            data_.srs->branch(q), q};
  return {s, arc_angle(chain(), q), arc_branch(chain(), method_, q), q};
}

int ArcLattice::branch(int layer, int slot) const {
  return labelled(layer_of_rows(layer), point(layer, slot).q).branch;
}

double ArcLattice::phi(int layer, int slot) const {
  return labelled(layer_of_rows(layer), point(layer, slot).q).phi;
}

int ArcLattice::next_on_arc(int layer, int slot) const {
  return data_.next.empty()
             ? neighbour_in_redundancy(layer, slot, 1)
             : data_.next[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
}

std::optional<Config> ArcLattice::given(int layer) const {
  if (layer == 0 && problem_.start) return joints_given(PathEnd::kFirst, problem_, *chain_, *path_);
  return layer == layers() - 1 ? end_ : std::nullopt;
}

std::optional<Config> ArcLattice::row_between(int, int, int, int i, double,
                                              const Config& chord) const {
  return data_.motion->image(chord, path_of_rows().layer(i).tool);
}

std::vector<TrajectoryRow> ArcLattice::path_rows(const std::vector<int>& slots) const {
  if (!has_layers_between()) return ExplicitLattice::path_rows(slots);
  std::vector<TrajectoryRow> rows;
  const ToolPath& path = path_of_rows();
  for (const Config& q : path_joints(slots))
    rows.push_back(labelled(static_cast<int>(rows.size()), q));
  count_from_waypoints(chain(), path, rows);
  return rows;
}

void ArcLattice::slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                            std::vector<int>& out) const {
  if (data_.on_circles.empty() || ExplicitLattice::shares_body_poses(groups))
    return ExplicitLattice::slots_with_same_body_poses(layer, slot, groups, out);
  out.clear();
  const int node = slot_on_circles(layer, slot);
  for (int other = 0; other < slots(layer); ++other)
    if (slot_on_circles(layer, other) == node) out.push_back(other);
}

std::vector<Lattice::NodeFault> ArcLattice::beyond_limits(int layer) const {
  std::vector<Config> points;
  const Pose& tool = path().layer(layer).tool;
  if (chain().roll_fixed)
    points = PoseSolutions(chain(), method_).at(tool);
  else
    for (const SelfMotionArc& curve : data_.motion->curves(tool))
      points.insert(points.end(), curve.q.begin(), curve.q.end());
  std::vector<NodeFault> faults;
  const double margin = limits().joint_margin - kLimitTolerance;
  for (Config& q : points) {
    if (data_.motion->canonical(q)) continue;
    NodeFault fault{NodeStatus::kLimit, 0, q};
    for (std::size_t j = 0; j < chain().coordinates(); ++j) {
      const JointLimit& limit = chain().limit[j];
      const double x = q[static_cast<Eigen::Index>(j)];
      if (!continuous()[j] && !(x >= limit.lower + margin && x <= limit.upper - margin))
        fault.joints |= static_cast<std::uint8_t>(1u << j);
    }
    if (fault.joints != 0) faults.push_back(fault);
  }
  return faults;
}

LatticeInfo ArcLattice::describe() const {
  LatticeInfo info = Lattice::describe();
  info.arcs = arcs();
  return info;
}

void ArcLattice::add_images(std::size_t joint, std::size_t first,
                            std::vector<WoundPoint>& images) const {
  constexpr std::int64_t kMostTurns = 128;  // more than a joint has whose turns are told apart
  const auto at = static_cast<Eigen::Index>(joint);
  const std::size_t last = images.size();
  for (std::size_t k = first; k < last; ++k) {
    const WoundPoint point = images[k];
    each_image(joint, point.q[at], [&](double value) {
      WoundPoint& image = images.emplace_back(point);
      image.turns = kMostTurns * point.turns + std::lround((value - point.q[at]) / kTwoPi);
      image.q[at] = value;
    });
  }
  images.erase(images.begin() + static_cast<std::ptrdiff_t>(first),
               images.begin() + static_cast<std::ptrdiff_t>(last));
}

std::unique_ptr<Lattice> ArcLattice::with_knots(const std::set<int>& steps,
                                                const Budget& budget) const {
  const TraceSpan span("more knots");
  std::optional<Knots> halved = knots().halved(steps);
  if (!halved) return nullptr;
  Data finer = data_;
  finer.knots = *std::move(halved);
  finer.next.clear();
  finer.on_circles.clear();
  finer.windings.clear();
  finer.circles = bounded_circles(chain(), *data_.motion);
  finer.points = data_.unwound.empty() ? all_points() : data_.unwound;
  finer.unwound.clear();
  const ArcLayerMaker maker(chain(), method_, problem_, *data_.motion);
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    budget.poll();
    const auto at = static_cast<std::ptrdiff_t>(*step) + 1;
    if (!can_halve(*step)) continue;
    const int middle = middle_layer(path_of_rows(), layer_of_rows(*step), layer_of_rows(*step + 1));
    auto &layer_before = finer.points[static_cast<std::size_t>(at) - 1],
         &layer_after = finer.points[static_cast<std::size_t>(at)];
    std::vector<Point> before = *layer_before, after = *layer_after;
    for (Point& point : before)
      point.along[1] = -1;  // those that lead to the layer inserted follow
    ArcLayer made = maker.make(path_of_rows().layer(middle), maker.carried_from(before), &before);
    finer.arcs += made.arcs;
    for (Point& point : made.points)
      if (const int source = point.along[0]; source >= 0)
        point.along[1] = (*layer_before)[static_cast<std::size_t>(source)].along[1];
    for (Point& point : after)
      if (int& source = point.along[0]; source >= 0)
        source = before[static_cast<std::size_t>(source)].along[1];
    const auto share = [](std::vector<Point> points) {
      return std::make_shared<const std::vector<Point>>(std::move(points));
    };
    layer_before = share(std::move(before));
    layer_after = share(std::move(after));
    finer.points.insert(finer.points.begin() + at, share(std::move(made.points)));
  }
  std::unique_ptr<Lattice> lattice(new ArcLattice(chain(), method_, problem_, std::move(finer)));
  for (const Joints& told : data_.windings) lattice = lattice->with_windings(told);
  lattice->take_clearances(limits());
  return lattice;
}

std::unique_ptr<Lattice> ArcLattice::with_windings(const Joints& joints) const {
  Data wound = data_;
  std::vector<std::vector<Point>> all;
  wound.next.clear();
  wound.on_circles.clear();
  if (has_layers_between() && wound.unwound.empty()) wound.unwound = all_points();
  wound.windings.push_back(joints);
  for (std::size_t j = 0; j < kDof; ++j) wound.circles[j] = wound.circles[j] && !joints[j];
  std::vector<WoundPoint> images;
  std::vector<std::size_t> first, order, place;  // of slots in `images`; of these in `points`
  for (int i = 0; i < layers(); ++i) {
    images.clear();
    first.clear();
    for (int slot = 0; slot < slots(i); ++slot) {
      first.push_back(images.size());
      images.push_back({0, slot, given(i).value_or(point(i, slot).q)});
      for (std::size_t j = 0; j < kDof && !given(i); ++j)
        if (joints[j] && circles()[j]) add_images(j, first.back(), images);
    }
    first.push_back(images.size());
    // Nodes of one turn stay together, as they lie on their arcs.
    order.resize(images.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return images[a].turns < images[b].turns;
    });
    auto& points = all.emplace_back(images.size());
    auto& on_circles = wound.on_circles.emplace_back(images.size());
    place.resize(images.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      place[order[k]] = k;
      points[k].q = images[order[k]].q;
      on_circles[k] = slot_on_circles(i, images[order[k]].slot);
    }
    // An arc goes on from an image to that of the next node to which no joint turns by half a turn.
    auto& next = wound.next.emplace_back(points.size(), -1);
    for (int slot = 0; slot < slots(i); ++slot) {
      const int after = next_on_arc(i, slot);
      if (after < 0) continue;
      const auto from = static_cast<std::size_t>(slot), to = static_cast<std::size_t>(after);
      for (std::size_t a = first[from]; a < first[from + 1]; ++a)
        for (std::size_t b = first[to]; b < first[to + 1]; ++b)
          if ((images[b].q - images[a].q).cwiseAbs().maxCoeff() < kPi)
            next[place[a]] = static_cast<int>(place[b]);
    }
  }
  wound.points = shared(std::move(all));
  return std::unique_ptr<Lattice>(new ArcLattice(chain(), method_, problem_, std::move(wound)));
}

}  // namespace swivel
