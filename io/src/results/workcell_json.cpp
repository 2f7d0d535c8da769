// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "results/result_parts.hpp"
#include "schema/schema.hpp"
#include "swivel/io/results/result.hpp"
#include "tables/run_settings.hpp"

namespace swivel::io {

namespace {

Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json arm_json(const ArmAnswer& arm) {
  const RunAnswer& run = arm.run();
  const bool solved = !arm.parts.empty();
  Json json = {{"name", arm.name},
               {"given", arm.given},
               {"least_cost", finite_or_null(run.least_cost)},
               {"cost", solved ? Json(arm.cost()) : Json(nullptr)},
               {"summary", summary_json(run, arm.rows())},
               {"lattice", lattice_json(run.lattice, solved)}};
  add_measures(json, run, solved);
  json["counters"] = counters_json(arm.counters);
  json["diagnosis"] = run.diagnosis ? diagnosis_json(*run.diagnosis) : Json(nullptr);
  json["trajectory"] =
      solved ? trajectory_json(arm.rows(), named_joints(arm.joint_names)) : Json(nullptr);
  json["partial"] = partial_json(arm);
  add_robot(json, arm, arm.warnings);
  return json;
}

/// Returns the refinement of both arms: what they have together, and that of each.
Json refinement_of_both(const RefinedRuns& refined, const std::array<std::string, 2>& names) {
  Json json = {{"cost_before", refined.cost_before},
               {"cost", refined.cost},
               {"turns", refined.turns},
               {"arms", Json::array()}};
  for (std::size_t k = 0; k < 2; ++k) {
    Json arm = {{"name", names[k]}};
    arm.update(refinement_json(refined.runs[k]));
    json["arms"].push_back(std::move(arm));
  }
  return json;
}

/// Returns the motion of both arms: what they have together, and the measures of each.
Json motion_of_both(const Answer& answer) {
  const std::optional<MotionTiming>& timed = answer.motion;
  if (!answer.timing || (!timed && !answer.stopped)) return nullptr;
  const TimingOptions& asked = *answer.timing;
  Json json = {{"executable", answer.timed() != nullptr},
               {"reason", timed ? Json(nullptr) : Json("stopped")},
               {"arm", nullptr},
               {"at_s", nullptr},
               {"speed", asked.speed},
               {"turn_speed", or_null(asked.turn_speed)},
               {"rate", asked.rate},
               {"chord", or_null(asked.chord)}};
  if (timed && timed->failure) {
    json["reason"] = timed->failure->reason;
    json["arm"] = answer.arms[timed->failed_arm].name;
    json["at_s"] = timed->failure->s;
  }
  if (answer.timed() == nullptr) return json;
  const Motion& motion = *answer.timed();
  json["samples"] = motion.arms[0].rows.size();
  json["duration"] = motion.duration;
  json["ideal"] = motion.ideal;
  json["blended"] = motion.blended;
  json["follower"] = nullptr;
  if (motion.follower)
    json["follower"] = {{"arm", motion.arms[*motion.follower].name},
                        {"position", motion.follower_position},
                        {"angle", motion.follower_angle}};
  json["arms"] = Json::array();
  for (std::size_t k = 0; k < 2; ++k) {
    Json arm = {{"name", motion.arms[k].name}, {"speed", motion.arms[k].speed}};
    add_motion_measures(arm, motion.arms[k], answer.arms[k].joint_names);
    json["arms"].push_back(std::move(arm));
  }
  json["warnings"] = motion.warnings;
  return json;
}

Json advice_on_workcell(const AdviceList& all) {
  Json cell = Json::array(), arms = Json::array();
  for (const Advice& one : all.changes) {
    Json json = advice_json(one);
    json.erase("reached_s");
    json["arm"] = one.arm.empty() ? Json(nullptr) : Json(one.arm);
    cell.push_back(std::move(json));
  }
  for (const AdviceAlone& one : all.alone)
    arms.push_back({{"arm", one.name}, {"advice", advice_json(one.advice)}});
  return {{"cell", cell}, {"arms", arms}};
}

}  // namespace

Json two_arms_json(const Answer& result, const AnswerExtras& extras) {
  const bool solved = result.has_rows();
  Json json;
  json["schema_version"] = kResultVersion;
  json["status"] = to_string(result.status);
  json["cost"] = solved ? Json(result.cost) : Json(nullptr);
  json["bound"] = finite_or_null(result.bound);
  json["checked"] = solved ? Json(result.checked) : Json(nullptr);
  json["planner"] = result.planner;
  json["threads"] = result.threads;
  json["decided_by"] = to_string(result.pair.decided_by);
  json["arms"] = {arm_json(result.arms[0]), arm_json(result.arms[1])};
  json["refinement"] = result.refinement
                           ? refinement_of_both(*result.refinement, names_of_arms(result))
                           : Json(nullptr);
  json["motion"] = motion_of_both(result);
  json["conflict"] = nullptr;
  if (const auto& conflict = result.pair.conflict)
    json["conflict"] = {{"layer", conflict->layer},
                        {"on_motion", conflict->of_motion},
                        {"s", conflict->s},
                        {"bodies", conflict->bodies}};
  json["advice"] = extras.advice ? advice_on_workcell(*extras.advice) : Json(nullptr);
  json["between_arms"] = nullptr;
  if (const auto& nearest = result.pair.nearest)
    json["between_arms"] = {{"clearance_mm", 1e3 * nearest->clearance},
                            {"margin_mm", 1e3 * nearest->margin},
                            {"bodies", nearest->bodies},
                            {"row", nearest->row}};
  json["between_arms_status"] = to_string(result.pair.nearest_status());
  json["counters"] = {{"rounds", result.pair.counters.rounds},
                      {"pops", result.pair.counters.pops},
                      {"node_pairs", result.pair.counters.node_pairs},
                      {"move_pairs", result.pair.counters.move_pairs}};
  json["time_ms"] = time_json(result.time_ms);
  json["warnings"] = result.warnings;
  return json;
}

}  // namespace swivel::io
