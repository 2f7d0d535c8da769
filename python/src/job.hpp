// SPDX-License-Identifier: BSD-3-Clause
// Jobs and workcells as Python holds them.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel::python {

/// A workcell. It does not change.
struct Workcell {
  std::shared_ptr<const swivel::Problem> cell;  // shared with plans
};

/// A stroke of a job. What is unset is as the job says, as in a problem file.
struct Stroke {
  std::string name;
  std::vector<Waypoint> waypoints;
  std::string frame;
  std::optional<PathSmoothing> smooth;
  bool reversible = false;
  std::optional<Vector3d> approach, retract;
  std::optional<double> process_speed, approach_speed;
  std::vector<double> feed;
  std::optional<Limits> limits;
  std::optional<Resolution> resolution;
  std::optional<Config> end;
  bool closed = false;
  bool operator==(const Stroke&) const = default;
};

/// A job. Its strokes are a list of Python's, which a user changes in place. Copies have strokes of
/// their own. The interpreter's lock must be held when it is made, copied and destroyed.
struct Job : Robot {
  std::string source;
  std::vector<SceneObject> scene;
  std::vector<Variation> vary;
  py::list strokes;
  Limits limits;
  Resolution resolution;
  Cost cost;
  Refinement refinement;
  std::optional<Config> home;
  StrokeOrder order = StrokeOrder::kGiven;
  Vector3d approach = Vector3d::Zero(), retract = Vector3d::Zero();
  std::optional<double> process_speed, approach_speed;
  double rapid = 1;
  std::optional<LiftOffs> lift;

  Job() = default;
  Job(const Job& other);
  Job(Job&&) = default;
  Job& operator=(const Job&) = delete;
  Job& operator=(Job&&) = default;
  ~Job() = default;
  /// Returns copies of the strokes. Throws TypeError for a thing in the list that is none.
  [[nodiscard]] std::vector<Stroke> all_strokes() const;
  void set_strokes(const std::vector<Stroke>& all);
};

/// Returns a job for the planner, and the other way round. Strokes that say what all strokes say
/// get it from the job. Throws as Job::all_strokes() and swivel::validate() do.
[[nodiscard]] swivel::Problem to_core(const Job& job);
[[nodiscard]] Job from_core(swivel::Problem job);

/// A job, or the name of its file.
using JobOrFile = std::variant<const Job*, std::filesystem::path>;
/// Returns a job for the planner. Throws as to_core() and io::load_job() do.
[[nodiscard]] swivel::Problem to_core(const JobOrFile& job);

void bind_job(py::module_& m);
void bind_job_results(py::module_& m);
void bind_job_functions(py::module_& m);

}  // namespace swivel::python
