// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "files/csv.hpp"
#include "problems/problem_values.hpp"
#include "schema/yaml_edit.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

YAML::Node scalar(double value) {
  return YAML::Node(csv_number(value));
}

/// Returns where the tool stands before a stroke or after it: a length against its z axis, or a
/// vector.
YAML::Node offset_node(const Vector3d& offset) {
  if (offset.x() == 0 && offset.y() == 0 && offset.z() <= 0)
    return scalar(offset.z() == 0 ? 0 : -offset.z());
  YAML::Node section;
  for (const double number : offset) section["xyz"].push_back(csv_number(number));
  return section;
}

/// Makes the values of one job.
class JobValues {
 public:
  JobValues(const Problem& job, const fs::path& folder, const JobLayout& layout,
            const std::string& file)
      : job_(job), folder_(folder), layout_(layout), file_(file) {
    static_cast<Robot&>(shared_) = job.arm();
    if (!job.arm().strokes.empty()) static_cast<Task&>(shared_) = job.arm().strokes.front();
    shared_.limits = job.arm().transition_limits;
    shared_.scene = job.scene;
    shared_.vary = job.vary;
  }

  YAML::Node all() {
    const YAML::Node of_all = problem_values(shared_, folder_, layout_.scene, file_);
    limits_ = of_all["limits"];
    approach_ = shared_offset(&Stroke::approach, layout_.with_approach);
    retract_ = shared_offset(&Stroke::retract, layout_.with_retract);
    YAML::Node root;
    root["robot"] = of_all["robot"];
    if (layout_.path)
      root["path"] = path(job_.arm().strokes.front());
    else
      for (const Stroke& one : job_.arm().strokes) root["strokes"].push_back(stroke(one));
    for (const char* const section : {"scene", "resolution", "limits", "cost", "refine", "vary"})
      if (of_all[section].IsDefined()) root[section] = of_all[section];
    add_motion_between(root);
    return root;
  }

 private:
  void add_motion_between(YAML::Node& root) const {
    if (!layout_.path) {
      if (job_.arm().home)
        for (std::size_t j = 0; j < coordinates_of(job_.arm()); ++j)
          root["home"]["joints"].push_back(
              csv_number((*job_.arm().home)[static_cast<Eigen::Index>(j)]));
      root["order"] = job_.arm().order == StrokeOrder::kBest ? "best" : "given";
      root["rapid"] = scalar(job_.arm().rapid);
      if (approach_) root["approach"] = offset_node(*approach_);
      if (retract_) root["retract"] = offset_node(*retract_);
      if (job_.arm().process_speed) root["process_speed"] = scalar(*job_.arm().process_speed);
      if (job_.arm().approach_speed) root["approach_speed"] = scalar(*job_.arm().approach_speed);
    }
    if (!job_.arm().lift) return;
    root["lift"]["allowed"] = "true";
    root["lift"]["cost"] = scalar(job_.arm().lift->cost);
    root["lift"]["overlap"] = scalar(job_.arm().lift->overlap);
  }

  /// Returns the offset that most strokes have which do not state one of their own in the file;
  /// none if all do.
  [[nodiscard]] std::optional<Vector3d> shared_offset(const Vector3d Stroke::*offset,
                                                      const std::set<std::string>& own) const {
    std::optional<Vector3d> most;
    std::ptrdiff_t count = 0;
    for (const Stroke& one : job_.arm().strokes) {
      if (own.contains(one.name)) continue;
      const auto alike = std::count_if(
          job_.arm().strokes.begin(), job_.arm().strokes.end(), [&](const Stroke& other) {
            return !own.contains(other.name) && other.*offset == one.*offset;
          });
      if (alike > count) most = one.*offset, count = alike;
    }
    return most;
  }

  [[nodiscard]] PathProblem problem_of(const Stroke& stroke) const {
    PathProblem problem;
    static_cast<Robot&>(problem) = job_.arm();
    problem.attached.clear();
    static_cast<Task&>(problem) = stroke;
    return problem;
  }
  [[nodiscard]] YAML::Node path(const Stroke& stroke) const {
    return problem_values(problem_of(stroke), folder_, {}, file_)["path"];
  }

  [[nodiscard]] YAML::Node stroke(const Stroke& stroke) const {
    const YAML::Node of_stroke = problem_values(problem_of(stroke), folder_, {}, file_);
    YAML::Node section;
    section["name"] = stroke.name;
    section["path"] = of_stroke["path"];
    section["reversible"] = stroke.reversible ? "true" : "false";
    if (!approach_ || stroke.approach != *approach_ || layout_.with_approach.contains(stroke.name))
      section["approach"] = offset_node(stroke.approach);
    if (!retract_ || stroke.retract != *retract_ || layout_.with_retract.contains(stroke.name))
      section["retract"] = offset_node(stroke.retract);
    if (stroke.process_speed) section["process_speed"] = scalar(*stroke.process_speed);
    if (stroke.approach_speed) section["approach_speed"] = scalar(*stroke.approach_speed);
    for (const auto& entry : of_stroke["limits"])
      if (const std::string key = entry.first.Scalar(); !same_values(limits_[key], entry.second))
        section["limits"][key] = entry.second;
    return section;
  }

  const Problem& job_;
  const fs::path& folder_;
  const JobLayout& layout_;
  const std::string& file_;
  PathProblem shared_;  ///< what all strokes have
  YAML::Node limits_;
  std::optional<Vector3d> approach_, retract_;
};

}  // namespace

YAML::Node job_values(const Problem& job, const fs::path& folder, const JobLayout& layout,
                      const std::string& file) {
  return JobValues(job, folder, layout, file).all();
}

}  // namespace swivel::io
