// SPDX-License-Identifier: BSD-3-Clause
// Problems and answers as bytes, for pickle. A structured binding takes each struct apart; it does
// not compile if a member was added to the struct and not listed here. An object that is shared
// within another, as the mesh of many links, is written once.
#pragma once
#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/map.hpp>
#include <cereal/types/memory.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/variant.hpp>
#include <cereal/types/vector.hpp>
#include <sstream>
#include <string>
#include <typeinfo>

#include "results.hpp"
#include "runs.hpp"
#include "swivel/core/answer/advice.hpp"
#include "swivel/core/base/fnv1a.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/core/study/placement.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/verify/check.hpp"

namespace cereal {

// Writes coefficients one by one, since Eigen's own conversions would select other overloads.
template <class Archive, int Rows, int Columns>
void serialize(Archive& archive, Eigen::Matrix<double, Rows, Columns>& x) {
  static_assert(Rows > 0 && Columns > 0);
  for (int k = 0; k < Rows * Columns; ++k) archive(x.data()[k]);
}
template <class Archive>
void serialize(Archive& archive, Eigen::Quaterniond& x) {
  archive(x.coeffs());
}
template <class Archive>
void serialize(Archive& archive, Eigen::Isometry3d& x) {
  archive(x.matrix());
}

}  // namespace cereal

namespace swivel {

// --- problems

template <class A>
void serialize(A& archive, Sphere& x) {
  auto& [radius] = x;
  archive(radius);
}
template <class A>
void serialize(A& archive, Box& x) {
  auto& [size] = x;
  archive(size);
}
template <class A>
void serialize(A& archive, Cylinder& x) {
  auto& [radius, length] = x;
  archive(radius, length);
}
template <class A>
void serialize(A& archive, Capsule& x) {
  auto& [radius, length] = x;
  archive(radius, length);
}
template <class A>
void serialize(A& archive, TriangleMesh& x) {
  auto& [vertices, triangles, source, closed, scale] = x;
  archive(vertices, triangles, source, closed, scale);
}
template <class A>
void serialize(A& archive, PlacedShape& x) {
  auto& [shape, pose] = x;
  archive(shape, pose);
}
template <class A>
void serialize(A& archive, Link& x) {
  auto& [name, collision, parent_joint] = x;
  archive(name, collision, parent_joint);
}
template <class A>
void serialize(A& archive, Joint::Mimic& x) {
  auto& [joint, multiplier, offset] = x;
  archive(joint, multiplier, offset);
}
template <class A>
void serialize(A& archive, Joint::Range& x) {
  auto& [lower, upper] = x;
  archive(lower, upper);
}
template <class A>
void serialize(A& archive, Joint& x) {
  auto& [name, type, parent, child, origin, axis, lower, upper, velocity, acceleration, jerk, mimic,
         hard, passive, line] = x;
  archive(name, type, parent, child, origin, axis, lower, upper, velocity, acceleration, jerk,
          mimic, hard, passive, line);
}
template <class A>
void serialize(A& archive, ModelFiles& x) {
  auto& [urdf, srdf, packages, without, soft_limits, joint_limits, limits, joint_margin] = x;
  archive(urdf, srdf, packages, without, soft_limits, joint_limits, limits, joint_margin);
}
template <class A>
void serialize(A& archive, RobotModel& x) {
  auto& [name, source, links, joints, root_link, has_srdf, disabled_pairs, warnings, files] = x;
  archive(name, source, links, joints, root_link, has_srdf, disabled_pairs, warnings, files);
}
template <class A>
void serialize(A& archive, Waypoint& x) {
  auto& [position, orientation, roll] = x;
  archive(position, orientation, roll);
}
template <class A>
void serialize(A& archive, Allowed& x) {
  auto& [body, depth] = x;
  archive(body, depth);
}
template <class A>
void serialize(A& archive, SceneObject& x) {
  auto& [name, shape, pose, allow] = x;
  archive(name, shape, pose, allow);
}
template <class A>
void serialize(A& archive, AttachedBody& x) {
  auto& [name, shape, pose, link] = x;
  archive(name, shape, pose, link);
}
template <class A>
void serialize(A& archive, PathSmoothing& x) {
  auto& [position, angle] = x;
  archive(position, angle);
}
template <class A>
void serialize(A& archive, Refinement& x) {
  auto& [smoothing, joint_margin, singular_margin] = x;
  archive(smoothing, joint_margin, singular_margin);
}
template <class A>
void serialize(A& archive, Limits& x) {
  auto& [clearance, self_clearance, manipulability, joint_margin, joint_step, arm_slope, roll_slope,
         step_error, tool_path_error, tool_angle_error, tool_speed, tool_turn_speed, edges,
         edge_clearance, edge_tolerance, joint_speed, joint_acceleration, joint_jerk] = x;
  archive(clearance, self_clearance, manipulability, joint_margin, joint_step, arm_slope,
          roll_slope, step_error, tool_path_error, tool_angle_error, tool_speed, tool_turn_speed,
          edges, edge_clearance, edge_tolerance, joint_speed, joint_acceleration, joint_jerk);
}
template <class A>
void serialize(A& archive, Resolution& x) {
  auto& [ds, dphi, dalpha, arc, arcs, droll, knot] = x;
  archive(ds, dphi, dalpha, arc, arcs, droll, knot);
}
template <class A>
void serialize(A& archive, Cost& x) {
  auto& [metric, weights, roll] = x;
  archive(metric, weights, roll);
}
template <class A>
void serialize(A& archive, Variation& x) {
  auto& [object, xyz, rpy] = x;
  archive(object, xyz, rpy);
}
template <class A>
void serialize(A& archive, Roll& x) {
  auto& [lower, upper] = x;
  archive(lower, upper);
}
template <class A>
void serialize(A& archive, Robot& x) {
  auto& [model, base_link, tip_link, tool, hold, attached, roll] = x;
  archive(model, base_link, tip_link, tool, hold, attached, roll);
}
template <class A>
void serialize(A& archive, Task& x) {
  auto& [path_frame, waypoints, smooth, resolution, limits, rolls, start, start_at, start_tolerance,
         end, closed, cost, refinement, steps] = x;
  archive(path_frame, waypoints, smooth, resolution, limits, rolls, start, start_at,
          start_tolerance, end, closed, cost, refinement, steps);
}
/// Lists the members of a PathProblem and of its two bases, which no structured binding takes apart
/// together.
template <class A>
void serialize(A& archive, PathProblem& x) {
  struct Listed : Robot, Task {
    std::string source;
    std::vector<SceneObject> scene;
    std::vector<Variation> vary;
  };
  static_assert(sizeof(Listed) == sizeof(PathProblem));
  archive(static_cast<Robot&>(x), static_cast<Task&>(x), x.source, x.scene, x.vary);
}

// --- answers

template <class A>
void serialize(A& archive, TrajectoryRow& x) {
  auto& [s, phi, branch, q, roll] = x;
  archive(s, phi, branch, q, roll);
}
template <class A>
void serialize(A& archive, Counters& x) {
  auto& [ik_nodes, edges, nodes_checked, edges_checked, fcl_calls, proved_free, proved_colliding,
         expansions, iterations] = x;
  archive(ik_nodes, edges, nodes_checked, edges_checked, fcl_calls, proved_free, proved_colliding,
          expansions, iterations);
}
template <class A>
void serialize(A& archive, LatticeInfo::Grid& x) {
  auto& [phi, branches, windings, window, rolls] = x;
  archive(phi, branches, windings, window, rolls);
}
template <class A>
void serialize(A& archive, LatticeInfo& x) {
  auto& [layers, nodes, grid, arcs, method, complete, merged_waypoints, cost] = x;
  archive(layers, nodes, grid, arcs, method, complete, merged_waypoints, cost);
}
template <class A>
void serialize(A& archive, Cause& x) {
  auto& [kind, side, joint, other_joints, unwinds, slides, bodies, between_layers, object, value,
         limit, over, check] = x;
  archive(kind, side, joint, other_joints, unwinds, slides, bodies, between_layers, object, value,
          limit, over, check);
}
template <class A>
void serialize(A& archive, EmptyLayers& x) {
  auto& [first, last, first_s, last_s, first_waypoint, last_waypoint, cause, most] = x;
  archive(first, last, first_s, last_s, first_waypoint, last_waypoint, cause, most);
}
template <class A>
void serialize(A& archive, Diagnosis::Removed& x) {
  auto& [cause, count] = x;
  archive(cause, count);
}
template <class A>
void serialize(A& archive, Diagnosis::Unreachable& x) {
  auto& [layer, s, waypoint] = x;
  archive(layer, s, waypoint);
}
template <class A>
void serialize(A& archive, Diagnosis& x) {
  auto& [reached_layer, reached_s, cause, at_s, waypoints, without_it, without_it_s, together,
         empty_layers, removed, unreachable, complete, layers_known] = x;
  archive(reached_layer, reached_s, cause, at_s, waypoints, without_it, without_it_s, together,
          empty_layers, removed, unreachable, complete, layers_known);
}
template <class A>
void serialize(A& archive, Advice& x) {
  auto& [change, object, slides, from, to, offset, also, also_offset, outcome, cost, reached_s] = x;
  archive(change, object, slides, from, to, offset, also, also_offset, outcome, cost, reached_s);
}
template <class A>
void serialize(A& archive, Evidence& x) {
  auto& [tool_path_error, postures, layers, contact] = x;
  archive(tool_path_error, postures, layers, contact);
}
template <class A>
void serialize(A& archive, LeastMargin& x) {
  auto& [margin, clearance, required, bodies, row] = x;
  archive(margin, clearance, required, bodies, row);
}
template <class A>
void serialize(A& archive, SpecialPair& x) {
  auto& [bodies, median, clearance, edge_clearance] = x;
  archive(bodies, median, clearance, edge_clearance);
}
template <class A>
void serialize(A& archive, NearestLimit& x) {
  auto& [margin, joint, side, row, slides] = x;
  archive(margin, joint, side, row, slides);
}
template <class A>
void serialize(A& archive, TopToolSpeed& x) {
  auto& [speed, joint, row] = x;
  archive(speed, joint, row);
}
template <class A>
void serialize(A& archive, decltype(Measures::tool_path_error_mm)& x) {
  auto& [mean, max, row, allowed] = x;
  archive(mean, max, row, allowed);
}
template <class A>
void serialize(A& archive, DeepestContact& x) {
  auto& [depth, at_most, bodies, allowed, row] = x;
  archive(depth, at_most, bodies, allowed, row);
}
template <class A>
void serialize(A& archive, Measures& x) {
  auto& [nearest_limit, nearest_slide_limit, top_tool_speed, evidence, asked, tool_path_error_mm,
         min_clearance, min_margin, deepest_contact, min_manipulability, arm_angle] = x;
  archive(nearest_limit, nearest_slide_limit, top_tool_speed, evidence, asked, tool_path_error_mm,
          min_clearance, min_margin, deepest_contact, min_manipulability, arm_angle);
}
template <class A>
void serialize(A& archive, HeldJoint& x) {
  auto& [name, position, slides, given, leader] = x;
  archive(name, position, slides, given, leader);
}
/// Lists the members of a PlanResult and of its base, which no structured binding takes apart
/// together.
template <class A>
void serialize(A& archive, PlanResult& x) {
  struct Listed : Measures {
    PlanStatus status;
    double cost;
    std::string planner;
    int threads;
    LatticeInfo lattice;
    Counters counters;
    std::map<std::string, double> time_ms;
    std::vector<TrajectoryRow> trajectory;
    bool checked;
    std::vector<TrajectoryRow> partial;
    std::array<std::string, kDof> joint_names;
    std::vector<HeldJoint> held;
    Diagnosis diagnosis;
    std::vector<SpecialPair> dropped_pairs, reduced_pairs;
    std::vector<std::string> warnings;
  };
  static_assert(sizeof(Listed) == sizeof(PlanResult));
  archive(static_cast<Measures&>(x), x.status, x.cost, x.planner, x.threads, x.lattice, x.counters,
          x.time_ms, x.trajectory, x.checked, x.partial, x.joint_names, x.held, x.diagnosis,
          x.dropped_pairs, x.reduced_pairs, x.warnings);
}
template <class A>
void serialize(A& archive, Refined& x) {
  auto& [rows, refined, reason, cost_before, cost, bend_before, bend, rounds, nodes_asked,
         edges_asked, from_second_seed] = x;
  archive(rows, refined, reason, cost_before, cost, bend_before, bend, rounds, nodes_asked,
          edges_asked, from_second_seed);
}
template <class A>
void serialize(A& archive, SpeedFrom& x) {
  auto& [s, speed] = x;
  archive(s, speed);
}
template <class A>
void serialize(A& archive, TimingOptions& x) {
  auto& [speed, speeds, turn_speed, rate, chord] = x;
  archive(speed, speeds, turn_speed, rate, chord);
}
template <class A>
void serialize(A& archive, TimedRow& x) {
  auto& [t, row, v, a] = x;
  archive(t, row, v, a);
}
template <class A>
void serialize(A& archive, TimedPath::Peak& x) {
  auto& [ratio, joint, t, s] = x;
  archive(ratio, joint, t, s);
}
template <class A>
void serialize(A& archive, TimedPath::Slow& x) {
  auto& [from_s, to_s, from_t, to_t, share, joint, reason, singular, singular_angle] = x;
  archive(from_s, to_s, from_t, to_t, share, joint, reason, singular, singular_angle);
}
template <class A>
void serialize(A& archive, TimedPath::Stop& x) {
  auto& [s, t, waypoint] = x;
  archive(s, t, waypoint);
}
template <class A>
void serialize(A& archive, TimedPath& x) {
  auto& [rows, rate, speed, roll, duration, ideal, peaks, slow, stops, rounded, rounded_position,
         rounded_angle, between_position, between_angle, rounds, warnings] = x;
  archive(rows, rate, speed, roll, duration, ideal, peaks, slow, stops, rounded, rounded_position,
          rounded_angle, between_position, between_angle, rounds, warnings);
}
template <class A>
void serialize(A& archive, NoMotion& x) {
  auto& [s, reason, too_near] = x;
  archive(s, reason, too_near);
}
template <class A>
void serialize(A& archive, TimingResult& x) {
  auto& [motion, failure] = x;
  archive(motion, failure);
}
template <class A>
void serialize(A& archive, MotionResult& x) {
  archive(static_cast<TimingResult&>(x), x.time_ms, x.check_ms);
}
template <class A>
void serialize(A& archive, MotionPlan& x) {
  auto& [result, lattice_path, refinement, motion, stopped] = x;
  archive(result, lattice_path, refinement, motion, stopped);
}
template <class A>
void serialize(A& archive, CheckResult::LimitDistance& x) {
  auto& [joint, by, row] = x;
  archive(joint, by, row);
}
template <class A>
void serialize(A& archive, CheckResult::Motion::Peak& x) {
  auto& [ratio, joint, t] = x;
  archive(ratio, joint, t);
}
template <class A>
void serialize(A& archive, CheckResult::Motion& x) {
  auto& [peaks, duration, tool_speed, turn_speed] = x;
  archive(peaks, duration, tool_speed, turn_speed);
}
template <class A>
void serialize(A& archive, CheckResult& x) {
  auto& [passed, failures, failure_count, worst_position, worst_angle, worst_path_error,
         worst_path_angle, largest_step, cost, rounded, min_clearance, min_margin, deepest_contact,
         min_clearance_status, deepest_contact_status, nearest_limit, nearest_slide_limit, motion,
         rows_examined, moves_examined, fcl_calls] = x;
  archive(passed, failures, failure_count, worst_position, worst_angle, worst_path_error,
          worst_path_angle, largest_step, cost, rounded, min_clearance, min_margin, deepest_contact,
          min_clearance_status, deepest_contact_status, nearest_limit, nearest_slide_limit, motion,
          rows_examined, moves_examined, fcl_calls);
}
template <class A>
void serialize(A& archive, PlacementRow& x) {
  auto& [cell, offset, hold, status, cost, clearance, clearance_margin, joint_margin, slide_margin,
         tool_speed, failed_s, cause, by, reason, checked] = x;
  archive(cell, offset, hold, status, cost, clearance, clearance_margin, joint_margin, slide_margin,
          tool_speed, failed_s, cause, by, reason, checked);
}
template <class A>
void serialize(A& archive, EpisodeRow& x) {
  auto& [episode, status, cost, plan_ms, nodes_checked, fcl_calls, error_mean, error_max, failed_s,
         cause, by, reason, checked, offsets] = x;
  archive(episode, status, cost, plan_ms, nodes_checked, fcl_calls, error_mean, error_max, failed_s,
          cause, by, reason, checked, offsets);
}

namespace python {

template <class A>
void serialize(A& archive, Trajectory& x) {
  auto& [rows, joint_names] = x;
  archive(rows, joint_names);
}
template <class A>
void serialize(A& archive, Motion& x) {
  auto& [timing, joint_names, frame] = x;
  archive(timing, joint_names, frame);
}
template <class A>
void serialize(A& archive, RefinedPath& x) {
  auto& [refined, joint_names] = x;
  archive(refined, joint_names);
}
/// Leaves out the problem, which would be most of a plan.
template <class A>
void serialize(A& archive, Plan& x) {
  auto& [plan, timing, frame, refined, own_functions, problem] = x;
  archive(plan, timing, frame, refined, own_functions);
}
template <class A>
void serialize(A& archive, Check& x) {
  auto& [result, joint_names] = x;
  archive(result, joint_names);
}
template <class A>
void serialize(A& archive, Mesh& x) {
  auto& [mesh] = x;
  archive(mesh);
}
template <class A, class Row>
void serialize(A& archive, Table<Row>& x) {
  auto& [rows, coordinates] = x;
  archive(rows, coordinates);
}

/// Returns the checksum of bytes that stand for a T. The name of the class is part of it, so that
/// the same bytes of another class have another checksum.
template <class T>
std::uint64_t checksum_of(const std::string& bytes) {
  return fnv1a(bytes, fnv1a(typeid(T).name()));
}

/// Returns what `def` of a class takes to support Python's module pickle, between processes and
/// machines with the same version of this package. The state is (version, checksum, bytes). The
/// checksum matters because damaged bytes could be read as lengths of lists that fill the memory.
template <class T>
auto pickling() {
  return py::pickle(
      [](const T& self) {
        std::ostringstream bytes(std::ios::binary);
        cereal::PortableBinaryOutputArchive archive(bytes);
        archive(self);
        return py::make_tuple(SWIVEL_VERSION, checksum_of<T>(bytes.str()), py::bytes(bytes.str()));
      },
      [](const py::tuple& state) {
        const std::string version = state.size() > 0 ? py::str(state[0]).cast<std::string>() : "?";
        if (version != SWIVEL_VERSION)
          throw py::value_error("pickled by version " + version +
                                " of swivel: allowed is that of this one, " SWIVEL_VERSION);
        if (state.size() != 3 || !py::isinstance<py::int_>(state[1]) ||
            !py::isinstance<py::bytes>(state[2]))
          throw py::value_error(
              "not a pickle of swivel: allowed are a version, a checksum and bytes");
        std::string content = state[2].cast<std::string>();
        if (const py::object told = state[1]; !told.equal(py::int_(checksum_of<T>(content))))
          throw py::value_error("a damaged pickle of swivel: its checksum is not that of its " +
                                std::to_string(content.size()) +
                                " bytes: allowed is what pickle wrote");
        std::istringstream bytes(std::move(content), std::ios::binary);
        T self;
        try {
          cereal::PortableBinaryInputArchive archive(bytes);
          archive(self);
        } catch (const std::exception& error) {
          throw py::value_error(std::string("not a pickle of swivel: ") + error.what());
        }
        return self;
      });
}

}  // namespace python

}  // namespace swivel
