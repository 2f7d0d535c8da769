// SPDX-License-Identifier: BSD-3-Clause
// Parts of results as JSON.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/io/results/result.hpp"

namespace swivel::io {

/// Its keys are in the order of the contract, for people who read the file.
using Json = nlohmann::ordered_json;

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}
[[nodiscard]] Json text_or_null(const std::string& text);

[[nodiscard]] Json lattice_json(const LatticeInfo& lattice, bool solved);
[[nodiscard]] Json counters_json(const Counters& counters);
[[nodiscard]] Json time_json(const std::map<std::string, double>& time_ms);
/// Returns a cause: keys that do not apply are null; the whole where there is no cause.
[[nodiscard]] Json cause_json(const Cause& cause);
[[nodiscard]] Json diagnosis_json(const Diagnosis& diagnosis);
/// Returns the number of a waypoint; null for -1.
[[nodiscard]] Json waypoint_json(int waypoint);

/// Returns the first `joints` coordinates of a configuration.
[[nodiscard]] Json joints_json(const Config& q, std::size_t joints);
/// Returns a row of a trajectory, with its roll if `roll` is true, and the first `joints` joints.
[[nodiscard]] Json row_json(const TrajectoryRow& row, bool roll, std::size_t joints);
[[nodiscard]] Json trajectory_json(const std::vector<TrajectoryRow>& trajectory,
                                   std::size_t joints);

/// Returns what rows come near to, at a glance. What is null was not asked for, or does not apply,
/// as where there are no rows.
[[nodiscard]] Json summary_json(const Measures& measures, const std::vector<TrajectoryRow>& rows);
/// Adds the keys that say how good rows are. `solved` says whether there are any.
void add_measures(Json& json, const Measures& measures, bool solved);

/// Adds what is known of an arm besides its answer: robot_pairs, held, `warnings`, joint_names.
void add_robot(Json& json, const ArmAnswer& arm, const std::vector<std::string>& warnings);
/// Returns the rows of the only part of a partial answer; an empty list where there is none.
[[nodiscard]] Json partial_json(const ArmAnswer& arm);

/// Returns the text of a file. Names of files and joints need not be UTF-8: what is not is
/// replaced.
[[nodiscard]] std::string document_of(const Json& json);

[[nodiscard]] Json refinement_json(const Refined& refined);
[[nodiscard]] Json advice_json(const Advice& one);
[[nodiscard]] Json advice_json(const std::vector<Advice>& advice);

/// Adds the keys that say how good a timed motion of an arm is. `names`: of its joints.
void add_motion_measures(Json& json, const TimedPath& motion, const JointNames& names);

/// Returns the result of one arm that runs strokes.
[[nodiscard]] Json strokes_json(const Answer& answer, const Problem& problem,
                                const AnswerExtras& extras);
/// Returns the result of two arms.
[[nodiscard]] Json two_arms_json(const Answer& answer, const AnswerExtras& extras);

}  // namespace swivel::io
