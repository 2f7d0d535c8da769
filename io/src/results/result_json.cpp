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

/// Returns the motion along one path.
Json motion_json(const Answer& answer) {
  if (!answer.motion) return nullptr;
  const TimingOptions& asked = *answer.timing;
  const auto& failure = answer.motion->failure;
  Json json = {{"executable", answer.timed() != nullptr},
               {"reason", failure ? Json(failure->reason) : Json(nullptr)},
               {"at_s", failure ? Json(failure->s) : Json(nullptr)},
               {"speed", asked.speed},
               {"turn_speed", or_null(asked.turn_speed)},
               {"rate", asked.rate},
               {"chord", or_null(asked.chord)}};
  if (answer.timed() == nullptr) return json;
  const TimedPath& motion = answer.timed()->arms.front();
  json["samples"] = motion.rows.size();
  json["duration"] = motion.duration;
  json["ideal"] = motion.ideal;
  add_motion_measures(json, motion, answer.arm().joint_names);
  return json;
}

/// Returns the result of one path.
Json path_json(const Answer& answer, const AnswerExtras& extras) {
  const ArmAnswer& arm = answer.arm();
  const RunAnswer& run = arm.run();
  const bool solved = answer.status == PlanStatus::kSolved;
  Json json;
  json["schema_version"] = kResultVersion;
  json["status"] = to_string(answer.status);
  json["summary"] = summary_json(run, arm.rows());
  json["cost"] = solved ? Json(answer.cost) : Json(nullptr);
  json["checked"] = solved ? Json(answer.checked) : Json(nullptr);
  json["planner"] = answer.planner;
  json["threads"] = answer.threads;
  json["lattice"] = lattice_json(run.lattice, solved);
  json["counters"] = counters_json(arm.counters);
  json["time_ms"] = time_json(answer.time_ms);
  add_measures(json, run, solved);
  json["refinement"] =
      answer.refinement ? refinement_json(answer.refinement->runs.front()) : Json(nullptr);
  json["motion"] = motion_json(answer);
  json["diagnosis"] = answer.status == PlanStatus::kInfeasible && run.diagnosis
                          ? diagnosis_json(*run.diagnosis)
                          : Json(nullptr);
  json["advice"] = extras.advice ? advice_json(extras.advice->changes) : Json(nullptr);
  json["certificate"] = extras.certificate
                            ? certificate_json(*extras.certificate, extras.certificate_bytes)
                            : Json(nullptr);
  json["trajectory"] = trajectory_json(arm.rows(), named_joints(arm.joint_names));
  json["partial"] = partial_json(arm);
  add_robot(json, arm, answer.warnings);
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

std::string to_json(const Answer& answer, const Problem& problem, const AnswerExtras& extras) {
  if (answer.arms.size() == 2) return document_of(two_arms_json(answer, extras));
  if (!is_path(problem)) return document_of(strokes_json(answer, problem, extras));
  return document_of(path_json(answer, extras));
}

std::string to_json(const PlanResult& result) {
  return document_of(path_json(answer_of(result), {}));
}

}  // namespace swivel::io
