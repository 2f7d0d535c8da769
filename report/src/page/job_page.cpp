// SPDX-License-Identifier: BSD-3-Clause
#include "page/job_page.hpp"

#include <algorithm>
#include <span>

#include "drawing.hpp"
#include "page/page_parts.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

using namespace detail;

namespace {

/// Makes the data of a job's page, and the maps for a page without JavaScript.
class JobPage {
 public:
  JobPage(const PlannedJob& planned, const std::string& result_json, const Budget& budget)
      : job_(planned.job),
        result_(planned.result),
        runs_(planned.view.runs),
        run_maps_(planned.maps),
        motion_(planned.motion),
        robot_(planned.robot),
        chain_(planned.robot.arm().chain),
        world_(runs_.empty() ? planned.robot.world() : runs_.front().world),
        budget_(budget),
        json_(Json::parse(result_json)) {
    for (const RunAnswer& run : result_.arm().runs) order_.push_back(run.run);
    for (std::size_t k = 0; order_.size() < job_.arm().strokes.size(); ++k)
      order_.push_back({k, false});
    if (motion_ == nullptr) return;
    std::size_t run = 0;
    for (std::size_t part = 0; part < result_.arm().parts.size(); ++part) {
      const bool is_run = result_.arm().parts[part].run.has_value();
      places_.push_back(places_of(samples_of(part), result_.arm().parts[part].rows,
                                  is_run ? &runs_[run].lattice.path_of_rows() : nullptr));
      run += is_run ? 1 : 0;
    }
  }

  /// Returns the data of the page. Throws Stopped.
  Json data(const PageWords& words) {
    Bodies bodies(world_, job_.scene);
    if (words.visual != nullptr)
      bodies.add_visual(*words.visual, *job_.arm().model, {{robot_.arm()}});
    Json strokes = Json::array();
    for (std::size_t k = 0; k < order_.size(); ++k) strokes.push_back(stroke(k));
    Json parts = result_.arm().parts.empty() ? partial_parts() : parts_of_job();
    json_.erase("parts");
    return {{"result", std::move(json_)},
            {"chain", chain_json(chain_)},
            {"ground", ground_json(*job_.arm().model, robot_.arm())},
            {"bodies", std::move(bodies.bodies)},
            {"visual", std::move(bodies.visual)},
            {"meshes", std::move(bodies.meshes)},
            {"home", home()},
            {"strokes", std::move(strokes)},
            {"parts", std::move(parts)},
            {"motion", motion()}};
  }
  /// Returns the maps of the strokes as HTML, after data() was called.
  [[nodiscard]] const std::string& maps() const { return maps_; }

 private:
  /// Returns the index of a run's part in the result; nullopt where there is no job.
  [[nodiscard]] std::optional<std::size_t> part_of(std::size_t run) const {
    for (std::size_t p = 0; p < result_.arm().parts.size(); ++p)
      if (result_.arm().parts[p].run == order_[run]) return p;
    return std::nullopt;
  }

  /// Returns the samples of the motion that lead through a part, from the one at its begin on.
  [[nodiscard]] std::span<const TimedRow> samples_of(std::size_t part) const {
    const auto [first, last] = std::ranges::equal_range(motion_->part, part);
    const auto begin = first - motion_->part.begin() - (first == motion_->part.begin() ? 0 : 1);
    return std::span(motion_->rows)
        .subspan(static_cast<std::size_t>(begin),
                 static_cast<std::size_t>(last - motion_->part.begin() - begin));
  }

  /// Returns a stroke in its direction: where the tool goes, its rows, map, and where its paths
  /// end. A run between lift-offs counts s along the whole of its stroke.
  Json stroke(std::size_t k) {
    const std::string& name = job_.arm().strokes[order_[k].stroke].name;
    const double begin = s_of_piece(job_.arm().strokes[order_[k].stroke]);
    Json json = {{"name", name}, {"reversed", order_[k].reversed}, {"rows", Json::array()}};
    if (runs_.empty()) {
      json["beside"] = Json::array();
      json["tool_path"] =
          tool_path_json(path_within_scale(problem_of_run(job_, order_[k]), chain_, budget_));
      json["map"] = json["cut"] = json["run"] = json["near"] = nullptr;
      return json;
    }
    const PlanView& view = runs_[k];
    const Lattice& lattice = view.lattice;
    const auto part = part_of(k);
    const LatticeMap& map = run_maps_[k].map;
    const std::vector<PageRow> path = placed(lattice, map, rows_of(lattice, view.path), view.path);
    std::vector<PageRow> rows = part ? placed_part(*part, k, view, map) : path;
    json["beside"] = (motion_ || result_.refined) && part ? beside_json(path, rows) : Json::array();
    for (PageRow& row : rows) row.at.s += begin;
    json["run"] = json_["runs"][k];
    json["settings"] = settings_json(view.problem, lattice);
    json["tool_path"] = tool_path_json(lattice.path_of_rows());
    json["rows"] = rows_json(view.world, lattice, rows, budget_);
    json["near"] = near_json(view.world, rows, budget_);
    if (part)
      for (std::size_t row = 0; row < rows.size(); ++row)
        json["rows"][row]["process"] = json_["parts"][*part]["rows"][row]["process"];
    const Json& diagnosis = json["run"]["diagnosis"];
    json["cut"] = diagnosis.is_object()
                      ? cut_json(map, lattice, view.world, view.path, rows, diagnosis)
                      : Json(nullptr);
    if (!json["cut"].is_null()) json["cut"]["s"] = json["cut"]["s"].get<double>() + begin;
    json["map"] = map_json(map, lattice, view.world, view.path, rows, cells_each(), budget_);
    maps_ += "<h2>" + std::to_string(k + 1) + " " + escaped(name) +
             (order_[k].reversed ? " (backwards)" : "") + "</h2>\n" + to_svg(map);
    return json;
  }
  /// Returns the rows of a part, which is the run of this number, on its map. A run between
  /// lift-offs measures arm angles from other planes in its rows than in its lattice, by the same
  /// angle all along.
  [[nodiscard]] std::vector<PageRow> placed_part(std::size_t part, std::size_t run,
                                                 const PlanView& view,
                                                 const LatticeMap& map) const {
    std::vector<TrajectoryRow> rows = result_.arm().parts[part].rows;
    const double first =
        (result_.refinement ? result_.refinement->runs.at(run).rows_before : rows).front().phi;
    if (motion_) rows = passed_rows(std::move(rows), samples_of(part), places_[part]);
    const bool piece = job_.arm().strokes[result_.arm().parts[part].run->stroke].piece.has_value();
    const double turned = piece ? wrap_angle(view.lattice.phi(0, view.path.front()) - first) : 0;
    for (TrajectoryRow& row : rows) row.phi += turned;
    std::vector<PageRow> shown = placed(view.lattice, map, rows, view.path);
    for (PageRow& row : shown) row.at.phi -= turned;
    return shown;
  }
  /// Returns how many cells the map of a stroke may have.
  [[nodiscard]] std::size_t cells_each() const {
    constexpr std::size_t kAll = kMostCells * 3 / 2, kLeast = kMostCells / 10;
    return std::clamp(kAll / order_.size(), kLeast, kMostCells);
  }

  /// Returns the job's parts in their order: the index of the stroke, or the joints of a
  /// transition's corners.
  Json parts_of_job() {
    Json list = Json::array();
    std::size_t next = 0;
    for (const Part& part : result_.arm().parts) {
      Json json = {{"stroke", part.run ? Json(next++) : Json(nullptr)}, {"cost", part.cost}};
      if (!part.run) {
        json["rows"] = Json::array();
        for (const TrajectoryRow& row : part.rows)
          json["rows"].push_back({{"q", std::vector<double>(row.q.data(), row.q.data() + kDof)}});
        json["barred_by"] = part.barred_by ? Json(*part.barred_by) : Json(nullptr);
      }
      list.push_back(std::move(json));
    }
    return list;
  }
  /// Returns the strokes that have a path as far as it goes, where there is no job.
  Json partial_parts() {
    Json list = Json::array();
    for (std::size_t k = 0; k < runs_.size(); ++k)
      if (!runs_[k].path.empty()) list.push_back({{"stroke", k}, {"cost", nullptr}});
    return list;
  }

  /// Returns the joints at home, and the two bodies that come too near there.
  [[nodiscard]] Json home() const {
    if (!job_.arm().home) return nullptr;
    const std::optional<NoTransition>& none = result_.arm().no_transition;
    const bool barred = none && none->where == NoTransition::Where::kHome && none->bodies;
    return {{"q", std::vector<double>(job_.arm().home->data(), job_.arm().home->data() + kDof)},
            {"pair", barred ? Json(*none->bodies) : Json(nullptr)}};
  }

  /// Returns the job's motion in time. The place of a sample counts the steps between rows of all
  /// parts; the last row of a part is the first one of the next.
  [[nodiscard]] Json motion() const {
    if (motion_ == nullptr) return nullptr;
    std::vector<double> places{0}, begin(result_.arm().parts.size(), 0.0);
    double steps = 0;
    for (std::size_t part = 0; part < result_.arm().parts.size(); ++part) {
      // The first sample of a part is the last one of the part before.
      for (std::size_t k = 1; k < places_[part].size(); ++k)
        places.push_back(steps + places_[part][k]);
      steps += static_cast<double>(result_.arm().parts[part].rows.size() - 1);
    }
    const auto& rows = motion_->rows;
    for (std::size_t k = 1; k < rows.size(); ++k)
      if (motion_->part[k] != motion_->part[k - 1]) begin[motion_->part[k]] = rows[k - 1].t;
    Json json =
        motion_json(rows, motion_->rate,
                    joint_rates(chain_, job_.arm().transition_limits, job_.source), chain_, places);
    json["begin"] = begin;
    return json;
  }

  const Problem& job_;
  const Answer& result_;
  const std::vector<PlanView>& runs_;
  std::span<const RunMap> run_maps_;
  const ArmMotion* motion_;
  const PreparedRobot& robot_;
  const Chain& chain_;
  const World& world_;
  const Budget& budget_;
  Json json_;                     ///< the result
  std::vector<StrokeRun> order_;  ///< in which the strokes are shown
  /// For each part, the places of its samples (samples_of()) in its rows. Empty without a motion.
  std::vector<std::vector<double>> places_;
  std::string maps_;
};

}  // namespace

std::string to_job_page(const PlannedJob& planned, const std::string& result_json,
                        const Budget& budget, const PageWords& words) {
  JobPage page(planned, result_json, budget);
  Json data = page.data(words);
  return filled_page(planned.job.source, words, std::move(data), page.maps());
}

}  // namespace swivel
