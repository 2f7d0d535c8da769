// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "results/result_parts.hpp"
#include "schema/schema.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/io/results/result.hpp"
#include "swivel/io/tables/campaign.hpp"
#include "tables/run_settings.hpp"

namespace swivel::io {

namespace {

Json spread_json(const Spread& spread) {
  return {{"median", spread.median}, {"p5", spread.p5}, {"p95", spread.p95}};
}

/// What the certificate holds; the whole is a file of its own.
Json certificate_json(const InfeasibilityCertificate& certificate, std::size_t bytes) {
  const CertificateCounts counts = count(certificate);
  Json removed = Json::array();
  for (std::size_t k = 0; k < certificate.witnesses.size(); ++k)
    removed.push_back({{"reason", words(certificate.witnesses[k])},
                       {"cause", cause_json(certificate.witnesses[k])},
                       {"nodes", counts.by_witness[k].nodes},
                       {"edges", counts.by_witness[k].edges}});
  return {{"layers",
           {certificate.first_layer,
            certificate.first_layer + static_cast<int>(certificate.band.size()) - 1}},
          {"reached", counts.reached},
          {"removed", std::move(removed)},
          {"bytes", bytes}};
}

Json motion_json(const TimingResult& timed, const TimingOptions& asked, const JointNames& names) {
  Json json = {{"executable", timed.motion.has_value()},
               {"reason", timed.failure ? Json(timed.failure->reason) : Json(nullptr)},
               {"at_s", timed.failure ? Json(timed.failure->s) : Json(nullptr)},
               {"speed", asked.speed},
               {"turn_speed", or_null(asked.turn_speed)},
               {"rate", asked.rate},
               {"chord", or_null(asked.chord)}};
  if (!timed.motion) return json;
  const TimedPath& motion = *timed.motion;
  json["samples"] = motion.rows.size();
  json["duration"] = motion.duration;
  json["ideal"] = motion.ideal;
  add_motion_measures(json, motion, names);
  return json;
}

}  // namespace

std::string to_json(const CampaignSummary& summary, const std::vector<HeldJoint>& held) {
  const Json json = {{"schema_version", kResultVersion},
                     {"episodes", summary.episodes},
                     {"answered", summary.answered()},
                     {"solved", summary.solved},
                     {"infeasible", summary.infeasible},
                     {"errors", summary.errors},
                     {"plan_ms", spread_json(summary.plan_ms)},
                     {"nodes_checked", spread_json(summary.nodes_checked)},
                     {"fcl_calls", spread_json(summary.fcl_calls)},
                     {"held", held_json(held)}};
  return document_of(json);
}

std::string error_json(const std::string& message) {
  return Json{{"schema_version", kResultVersion}, {"status", "error"}, {"message", message}}.dump(
             2, ' ', false, Json::error_handler_t::replace) +
         '\n';
}

std::string to_json(const PlanResult& result) {
  return to_json(result, PlanExtras{});
}

std::string to_json(const PlanResult& result, const PlanExtras& extras) {
  const bool solved = result.status == PlanStatus::kSolved;
  Json json;
  json["schema_version"] = kResultVersion;
  json["status"] = to_string(result.status);
  json["summary"] = summary_json(result, solved ? result.trajectory : std::vector<TrajectoryRow>());
  json["cost"] = solved ? Json(result.cost) : Json(nullptr);
  json["checked"] = solved ? Json(result.checked) : Json(nullptr);
  json["planner"] = result.planner;
  json["threads"] = result.threads;
  json["lattice"] = lattice_json(result.lattice, solved);
  json["counters"] = counters_json(result.counters);
  json["time_ms"] = time_json(result.time_ms);
  add_measures(json, result, solved);
  json["refinement"] = extras.refinement ? refinement_json(*extras.refinement) : Json(nullptr);
  json["motion"] = extras.motion ? motion_json(*extras.motion, extras.timing, result.joint_names)
                                 : Json(nullptr);
  json["diagnosis"] = result.status == PlanStatus::kInfeasible && result.diagnosis
                          ? diagnosis_json(*result.diagnosis)
                          : Json(nullptr);
  json["advice"] = extras.advice ? advice_json(*extras.advice) : Json(nullptr);
  json["certificate"] = extras.certificate
                            ? certificate_json(*extras.certificate, extras.certificate_bytes)
                            : Json(nullptr);
  json["trajectory"] = trajectory_json(result.trajectory);
  json["partial"] = trajectory_json(result.partial);
  json["robot_pairs"] = robot_pairs_json(result.dropped_pairs, result.reduced_pairs);
  json["held"] = held_json(result.held);
  json["warnings"] = result.warnings;
  json["joint_names"] = result.joint_names;
  return document_of(json);
}

}  // namespace swivel::io
