// SPDX-License-Identifier: BSD-3-Clause
#include "jobs/job_rows.hpp"
#include "results/result_parts.hpp"
#include "schema/schema.hpp"
#include "swivel/io/results/result.hpp"
#include "tables/run_settings.hpp"

namespace swivel::io {

namespace {

/// Writes the result of an arm that runs strokes.
class StrokesWriter {
 public:
  StrokesWriter(const Answer& result, const Problem& job, const AnswerExtras& extras)
      : result_(result),
        arm_(result.arm()),
        job_(job),
        extras_(extras),
        solved_(result.has_rows()),
        roll_(any_rolls(result.arm())) {}

  [[nodiscard]] Json write() const {
    Json json;
    json["schema_version"] = kResultVersion;
    json["status"] = to_string(result_.status);
    json["cost"] = if_solved(result_.cost);
    json["bound"] = if_solved(result_.bound);
    json["bound_any"] = if_solved(result_.bound_any);
    json["bound_orders"] = if_solved(result_.bound_orders);
    json["lattice_cost"] = if_solved(result_.lattice_cost);
    json["gap"] = gap();
    json["checked"] = solved_ ? Json(result_.checked) : Json(nullptr);
    json["planner"] = result_.planner;
    json["threads"] = result_.threads;
    json["order"] = order();
    json["runs"] = runs();
    json["transitions"] = transitions();
    json["lift_offs"] = lift_offs();
    json["no_transition"] = no_transition();
    json["advice"] = extras_.advice ? advice(*extras_.advice) : Json(nullptr);
    json["counters"] = counters_json(arm_.counters);
    json["transition_counters"] = {{"pairs", arm_.transitions.pairs},
                                   {"searches", arm_.transitions.searches},
                                   {"rounds", arm_.transitions.rounds}};
    json["time_ms"] = time_json(result_.time_ms);
    json["refinement"] = refinement();
    json["motion"] = motion();
    json["parts"] = parts(arm_.parts);
    json["partial"] = parts(arm_.partial);
    add_robot(json, arm_, result_.warnings);
    return json;
  }

 private:
  [[nodiscard]] Json if_solved(double value) const { return solved_ ? Json(value) : Json(nullptr); }

  [[nodiscard]] Json gap() const {
    if (!solved_ || (result_.bound <= 0 && result_.lattice_cost > 0)) return nullptr;
    return result_.lattice_cost > 0 ? result_.lattice_cost / result_.bound - 1 : 0.0;
  }

  [[nodiscard]] const std::string& name(const StrokeRun& run) const {
    return job_.arm().strokes[run.stroke].name;
  }
  /// Returns the name of the run that a transition leads from or to; null for the home.
  [[nodiscard]] Json name_or_home(std::size_t part) const {
    return part < arm_.parts.size() && arm_.parts[part].run ? Json(name(*arm_.parts[part].run))
                                                            : Json(nullptr);
  }

  [[nodiscard]] Json order() const {
    Json list = Json::array();
    for (const RunAnswer& one : arm_.runs)
      list.push_back({{"stroke", name(one.run)}, {"reversed", one.run.reversed}});
    return list;
  }

  /// Returns the part of the motion that is this run; null where there is none.
  [[nodiscard]] const Part* part_of(const StrokeRun& run) const {
    for (const Part& part : arm_.parts)
      if (part.run == run) return &part;
    return nullptr;
  }

  /// Returns the rows of a part; those of a run count s along the whole of its stroke.
  [[nodiscard]] std::vector<TrajectoryRow> rows_of(const Part& part) const {
    std::vector<TrajectoryRow> rows = part.rows;
    if (part.run)
      for (TrajectoryRow& row : rows) row.s += s_of_piece(job_.arm().strokes[part.run->stroke]);
    return rows;
  }

  [[nodiscard]] Json runs() const {
    Json list = Json::array();
    for (const RunAnswer& one : arm_.runs) {
      const Part* const part = part_of(one.run);
      const bool has_path = one.status == PlanStatus::kSolved;
      Json json = {
          {"stroke", name(one.run)},
          {"reversed", one.run.reversed},
          {"status", to_string(one.status)},
          {"least_cost", has_path ? Json(one.least_cost) : Json(nullptr)},
          {"cost", part ? Json(part->cost) : Json(nullptr)},
          {"summary", summary_json(one, part ? rows_of(*part) : std::vector<TrajectoryRow>())},
          {"lattice", lattice_json(one.lattice, part != nullptr)}};
      add_measures(json, one, part != nullptr);
      json["diagnosis"] = one.diagnosis ? diagnosis_json(*one.diagnosis) : Json(nullptr);
      list.push_back(std::move(json));
    }
    return list;
  }

  [[nodiscard]] Json transitions() const {
    Json list = Json::array();
    for (std::size_t k = 0; k < arm_.parts.size(); ++k) {
      const Part& part = arm_.parts[k];
      if (part.run) continue;
      list.push_back({{"from", k == 0 ? Json(nullptr) : name_or_home(k - 1)},
                      {"to", name_or_home(k + 1)},
                      {"cost", part.cost},
                      {"via", part.rows.size() < 2 ? 0 : part.rows.size() - 2}});
    }
    return list;
  }

  [[nodiscard]] Json lift_offs() const {
    Json list = Json::array();
    // strokes are counted as the problem file has them
    std::size_t part = 0, stroke = 0;
    for (const LiftOffAnswer& lift : arm_.lift_offs) {
      for (; stroke < lift.stroke; ++stroke) {
        const auto& piece = job_.arm().strokes[part].piece;
        const std::string whole = piece ? piece->stroke : "";
        ++part;
        while (piece && job_.arm().strokes[part].piece &&
               job_.arm().strokes[part].piece->stroke == whole)
          ++part;
      }
      // s of rows counts the approach as well
      const double approach = job_.arm().strokes[part].approach.norm();
      list.push_back({{"stroke", job_.arm().strokes[part].piece->stroke},
                      {"s", approach + lift.end},
                      {"resumed_s", approach + lift.resumed},
                      {"reached_s", approach + lift.reached},
                      {"cause", cause_json(lift.cause)}});
    }
    return list;
  }

  [[nodiscard]] Json no_transition() const {
    const std::optional<NoTransition>& none = arm_.no_transition;
    if (!none) return nullptr;
    const auto run = [&](std::size_t k) {
      return k < arm_.runs.size() ? Json(name(arm_.runs[k].run)) : Json(nullptr);
    };
    return {{"from", none->to == 0 ? Json(nullptr) : run(none->to - 1)},
            {"to", run(none->to)},
            {"where", to_string(none->where)},
            {"bodies", or_null(none->bodies)}};
  }

  [[nodiscard]] Json advice(const AdviceList& all) const {
    const std::size_t joints = named_joints(arm_.joint_names);
    Json job = Json::array(), strokes = Json::array();
    for (const Advice& one : all.changes)
      job.push_back({{"change", to_string(one.change)},
                     {"words", words(one)},
                     {"strokes", one.strokes},
                     {"length", or_null(one.length)},
                     {"home", one.home ? joints_json(*one.home, joints) : Json(nullptr)},
                     {"outcome", to_string(one.outcome)},
                     {"cost", or_null(one.cost)}});
    for (const AdviceAlone& one : all.alone)
      strokes.push_back({{"stroke", one.name}, {"advice", advice_json(one.advice)}});
    return {{"job", job}, {"strokes", strokes}};
  }

  [[nodiscard]] Json refinement() const {
    if (!result_.refinement) return nullptr;
    const RefinedRuns& all = *result_.refinement;
    Json json = {{"cost_before", all.cost_before}, {"cost", all.cost}, {"runs", Json::array()}};
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
      const StrokeRun& run = arm_.runs[k].run;
      Json one = {{"stroke", name(run)}, {"reversed", run.reversed}};
      one.update(refinement_json(all.runs[k]));
      json["runs"].push_back(std::move(one));
    }
    return json;
  }

  [[nodiscard]] Json motion() const {
    const std::optional<MotionTiming>& timed = result_.motion;
    if (!timed && !result_.stopped) return nullptr;
    Json json = {{"executable", result_.timed() != nullptr},
                 {"reason", timed ? Json(nullptr) : Json("stopped")},
                 {"part", nullptr},
                 {"at_s", nullptr}};
    if (timed && timed->failure) {
      json["reason"] = timed->failure->reason;
      json["part"] = timed->failed_part;
      json["at_s"] = timed->failure->s;
    }
    if (result_.timed() == nullptr) return json;
    const ArmMotion& motion = result_.timed()->arms.front();
    json["rate"] = motion.rate;
    json["samples"] = motion.rows.size();
    json["duration"] = motion.duration;
    json["events"] = Json::array();
    for (const ProcessEvent& event : motion.events)
      json["events"].push_back({{"t", event.t},
                                {"stroke", job_.arm().strokes[event.stroke].name},
                                {"s", event.s + s_of_piece(job_.arm().strokes[event.stroke])},
                                {"process", event.on ? "on" : "off"}});
    json["warnings"] = motion.warnings;
    return json;
  }

  [[nodiscard]] Json parts(const std::vector<Part>& parts) const {
    Json list = Json::array();
    const std::size_t joints = named_joints(arm_.joint_names);
    for (const Part& part : parts) {
      const std::vector<bool> process = process_of_rows(part, job_);
      Json rows = Json::array();
      for (const TrajectoryRow& row : rows_of(part)) {
        rows.push_back(part.run ? row_json(row, roll_, joints)
                                : Json{{"joints", joints_json(row.q, joints)}});
        rows.back()["process"] = process[rows.size() - 1];
      }
      list.push_back({{"stroke", part.run ? Json(name(*part.run)) : Json(nullptr)},
                      {"reversed", part.run && part.run->reversed},
                      {"cost", part.cost},
                      {"rows", std::move(rows)}});
    }
    return list;
  }

  const Answer& result_;
  const ArmAnswer& arm_;
  const Problem& job_;
  const AnswerExtras& extras_;
  const bool solved_, roll_;
};

}  // namespace

Json strokes_json(const Answer& answer, const Problem& problem, const AnswerExtras& extras) {
  return StrokesWriter(answer, problem, extras).write();
}

}  // namespace swivel::io
