// SPDX-License-Identifier: BSD-3-Clause
// Parts of plan_many() of the package: problems that differ from one in their paths, in where
// objects and the robot stand, or in where the arm begins and ends.
#include "swivel/planner/study/plan_many.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/archive.hpp"
#include "base/interruptible.hpp"
#include "plan_keywords.hpp"
#include "problems/problem.hpp"
#include "runs.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/messages/nearest_name.hpp"
#include "swivel/io/files/files.hpp"

namespace swivel::python {

/// What became of one of many problems.
struct Planned {
  EpisodeRow row;
  std::shared_ptr<const std::vector<double>> joints;  ///< row by row; shared with arrays
  int width = kDof;                                   ///< joints of a row
};

/// What became of many problems, in the order of their numbers (EpisodeRow::episode).
struct Plans {
  using Row = EpisodeRow;
  static constexpr const char* kSaving =
      "As .npz of numpy or as .csv, by the ending of the name. .npz: arrays number, status (text), "
      "cost, failed_s, cause, reason, joints and offsets. .csv: without the joints, "
      "docs/formats.md, \"Campaign\". Raises InputError for other endings.";

  std::shared_ptr<const std::vector<EpisodeRow>> rows;  ///< shared with arrays, as the next two
  /// All rows of all trajectories, one after the other; rad.
  std::shared_ptr<const std::vector<double>> joints;
  /// Rows offsets[k] to offsets[k + 1] of `joints` are those of the k-th problem.
  std::shared_ptr<const std::vector<std::int64_t>> offsets;
  int width = kDof;  ///< joints of a row: those of one arm, or of two side by side

  /// Returns the joints of the k-th problem, row by row.
  [[nodiscard]] std::span<const double> joints_of(std::size_t k) const {
    const auto place = [&](std::size_t number) {
      return static_cast<std::size_t>((*offsets)[number]) * static_cast<std::size_t>(width);
    };
    return std::span(*joints).subspan(place(k), place(k + 1) - place(k));
  }
  [[nodiscard]] Planned at(std::size_t k) const {
    const auto own = joints_of(k);
    return {(*rows)[k], std::make_shared<const std::vector<double>>(own.begin(), own.end()), width};
  }
  [[nodiscard]] std::string to_csv() const { return io::to_csv(*rows, {}); }
  /// Throws InputError if the file cannot be written.
  void save(const std::filesystem::path& file) const;
  /// Returns the rows of several tables as one.
  [[nodiscard]] static Plans joined(const std::vector<Plans>& parts);
};

/// What differs between problems: of each list one entry for each of them, or none where they have
/// what the problem has of which they are made.
struct Varied {
  std::vector<std::uint64_t> numbers;  ///< of the problems
  std::vector<std::vector<Waypoint>> paths;
  /// Poses of objects in the base frame, by the object's index in the scene.
  std::vector<std::pair<std::uint64_t, std::vector<Pose>>> poses;
  std::vector<Pose> bases;  ///< of the robot, in the base frame that the problem has
  std::vector<Config> starts, ends;

  /// Returns the k-th problem, made of `base`.
  [[nodiscard]] swivel::Problem problem(const swivel::Problem& base, std::size_t k) const;
  /// Returns some of the problems, by their places in this list. Throws std::out_of_range.
  [[nodiscard]] Varied part(const std::vector<std::size_t>& places) const;
};

namespace {

// --- tables

Plans to_plans(std::vector<EpisodeRow> rows, std::vector<double> joints,
               std::vector<std::int64_t> offsets, int width) {
  return {std::make_shared<const std::vector<EpisodeRow>>(std::move(rows)),
          std::make_shared<const std::vector<double>>(std::move(joints)),
          std::make_shared<const std::vector<std::int64_t>>(std::move(offsets)), width};
}

/// Returns a table of one row.
Plans one_plan(EpisodeRow row, std::vector<double> joints, int width) {
  const auto count = static_cast<std::int64_t>(joints.size()) / width;
  return to_plans({std::move(row)}, std::move(joints), {0, count}, width);
}

/// Returns joints as a read-only view of shape (R, width).
py::array_t<double> view_of(const std::shared_ptr<const std::vector<double>>& joints, int width) {
  return column(joints, joints->data())
      .attr("reshape")(static_cast<py::ssize_t>(joints->size()) / width, width);
}

/// Returns the joints of all problems as one array, (n, L, width), with `fill` behind the rows of
/// those that have fewer than L, the most that any has.
py::array_t<double> padded(const Plans& plans, double fill) {
  const std::size_t count = plans.rows->size();
  std::size_t most = 0;
  for (std::size_t k = 0; k < count; ++k) most = std::max(most, plans.joints_of(k).size());
  py::array_t<double> array({static_cast<py::ssize_t>(count),
                             static_cast<py::ssize_t>(most) / plans.width,
                             static_cast<py::ssize_t>(plans.width)});
  double* out = array.mutable_data();
  for (std::size_t k = 0; k < count; ++k) {
    const auto own = plans.joints_of(k);
    out = std::fill_n(std::copy(own.begin(), own.end(), out), most - own.size(), fill);
  }
  return array;
}

/// Returns the contents of a file of numpy with the arrays of a table.
std::string to_npz(const Plans& plans) {
  const py::module_ numpy = py::module_::import("numpy");
  const auto words = [&](const std::vector<std::string>& all) {
    return numpy.attr("array")(all, "U");
  };
  std::vector<std::string> status;
  for (const EpisodeRow& row : *plans.rows) status.emplace_back(to_string(row.status));
  const py::object file = py::module_::import("io").attr("BytesIO")();
  numpy.attr("savez")(file, py::arg("number") = plain(plans, &EpisodeRow::episode),
                      py::arg("status") = words(status),
                      py::arg("cost") = numbers(plans, &EpisodeRow::cost),
                      py::arg("failed_s") = numbers(plans, &EpisodeRow::failed_s),
                      py::arg("cause") = words(texts(plans, &EpisodeRow::cause)),
                      py::arg("reason") = words(texts(plans, &EpisodeRow::reason)),
                      py::arg("joints") = view_of(plans.joints, plans.width),
                      py::arg("offsets") = column(plans.offsets, plans.offsets->data()));
  return file.attr("getvalue")().cast<std::string>();
}

std::string planned_words(const Planned& planned) {
  const EpisodeRow& row = planned.row;
  const std::string number =
      formatted("<Planned %llu: ", static_cast<unsigned long long>(row.episode));
  const std::string what =
      row.cost ? formatted("cost %.6g, %zu rows", *row.cost,
                           planned.joints->size() / static_cast<std::size_t>(planned.width))
      : row.status == PlanStatus::kInfeasible
          ? "no path, " + row.reason
          : std::string(to_string(row.status)) + ", " + row.reason;
  return number + what + formatted(", %.1f ms>", row.plan_ms);
}

// --- what is given in Python

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Returns an argument as an array. `what`: its name. Throws InvalidArgument where it is none.
Array to_numbers(py::handle source, const std::string& what, const char* allowed) {
  Array array = Array::ensure(source);
  if (!array) throw InvalidArgument(what + ": not an array of numbers: allowed are " + allowed);
  return array;
}

[[noreturn]] void refuse_shape(const Array& array, const std::string& what, const char* allowed) {
  throw InvalidArgument(what + ": of shape " + py::str(array.attr("shape")).cast<std::string>() +
                        ": allowed are " + allowed);
}

/// Throws ValueError for numbers that are not finite.
void require_finite(const double* numbers, std::size_t count) {
  if (!std::all_of(numbers, numbers + count, [](double x) { return std::isfinite(x); }))
    throw py::value_error("not finite: allowed are finite numbers");
}

/// Poses that an argument states: rows x y z qw qx qy qz, (n, 7), or matrices, (n, 4, 4); m.
class GivenPoses {
 public:
  /// `what`: name of the argument; `each`: what one of its poses is called. Throws InvalidArgument
  /// for another shape, and for the first that is no pose.
  GivenPoses(py::handle source, const std::string& what, const char* each)
      : numbers_(to_numbers(source, what, kAllowed)) {
    matrices_ = numbers_.ndim() == 3 && numbers_.shape(1) == 4 && numbers_.shape(2) == 4;
    if (!matrices_ && !(numbers_.ndim() == 2 && numbers_.shape(1) == 7))
      refuse_shape(numbers_, what, kAllowed);
    for (std::size_t k = 0; k < size(); ++k) {
      try {
        require_pose(k);
      } catch (const py::value_error& error) {
        throw InvalidArgument(what + ": " + each + " " + std::to_string(k) + ": " + error.what());
      }
    }
  }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(numbers_.shape(0)); }
  /// Returns the k-th pose as one of the tool on its path.
  [[nodiscard]] Waypoint waypoint(std::size_t k) const {
    const double* const v = numbers_of(k);
    if (!matrices_) return {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}};
    const Pose rigid = to_rigid(v);
    return {rigid.translation(), Quaterniond(rigid.linear())};
  }
  /// Returns all poses as poses of bodies.
  [[nodiscard]] std::vector<Pose> poses() const {
    std::vector<Pose> all;
    for (std::size_t k = 0; k < size(); ++k) all.push_back(body_pose(k));
    return all;
  }

 private:
  static constexpr const char* kAllowed = "(n, 7) and (n, 4, 4)";

  [[nodiscard]] std::size_t width() const { return matrices_ ? 16 : 7; }
  [[nodiscard]] const double* numbers_of(std::size_t k) const {
    return numbers_.data() + k * width();
  }
  /// Throws ValueError for numbers that are no pose.
  void require_pose(std::size_t k) const {
    require_finite(numbers_of(k), width());
    if (matrices_)
      static_cast<void>(to_rigid(numbers_of(k)));
    else
      require_unit(waypoint(k).orientation);
  }
  [[nodiscard]] Pose body_pose(std::size_t k) const {
    if (matrices_) return to_rigid(numbers_of(k));
    const Waypoint row = waypoint(k);
    Pose made = Pose::Identity();
    made.translation() = row.position;
    made.linear() = row.orientation.normalized().toRotationMatrix();
    return made;
  }

  Array numbers_;
  bool matrices_ = false;
};

/// Returns the waypoints of each path for a robot.
std::vector<std::vector<Waypoint>> to_paths(const py::object& source, const Robot& robot) {
  if (!py::isinstance<py::iterable>(source))
    throw InvalidArgument(
        "paths: not a sequence: allowed are (n, m, 7), (n, m, 4, 4), or a sequence of (m, 7) or "
        "(m, 4, 4)");
  std::vector<std::vector<Waypoint>> paths;
  for (const py::handle one : source) {
    const std::string what = "paths: row " + std::to_string(paths.size());
    const GivenPoses given(one, what, "waypoint");
    if (given.size() < 2)
      throw InvalidArgument(what + ": " + std::to_string(given.size()) +
                            " waypoint(s): allowed are at least two");
    std::vector<Waypoint>& path = paths.emplace_back();
    for (std::size_t k = 0; k < given.size(); ++k) path.push_back(given.waypoint(k));
    pass_half_turns(robot, path);
  }
  return paths;
}

std::vector<Config> to_postures(py::handle source, const std::string& what, std::size_t width) {
  const char* const allowed = width == kDof ? "(n, 7), rad" : "(n, 6), rad";
  const Array joints = to_numbers(source, what, allowed);
  if (joints.ndim() != 2 || joints.shape(1) != static_cast<py::ssize_t>(width))
    refuse_shape(joints, what, allowed);
  std::vector<Config> postures;
  for (py::ssize_t k = 0; k < joints.shape(0); ++k) {
    try {
      require_finite(joints.data(k, 0), width);
    } catch (const py::value_error& error) {
      throw InvalidArgument(what + ": row " + std::to_string(k) + ": " + error.what());
    }
    std::copy_n(joints.data(k, 0), width, postures.emplace_back().data());
  }
  return postures;
}

/// Returns the index of an object in a scene. Throws InvalidArgument for an unknown name.
std::uint64_t object_of(const swivel::Problem& problem, const std::string& name) {
  std::vector<std::string> known;
  for (const SceneObject& object : problem.scene) {
    if (object.name == name) return known.size();
    known.push_back(object.name);
  }
  throw InvalidArgument("poses: no object '" + name + "'" +
                        (known.empty() ? "" : ", nearest is '" + nearest_name(name, known) + "'") +
                        ": allowed are names of scene objects");
}

/// Throws InvalidArgument for an argument that the kind of the problem does not have. `kinds`:
/// those that have it.
void require_kind(bool has, const char* what, const swivel::Problem& problem, const char* kinds) {
  if (has) return;
  const char* const kind = problem.arms.size() == 2 ? "two arms"
                           : is_path(problem)       ? "one path"
                                                    : "strokes";
  throw InvalidArgument(std::string(what) + ": of a problem of " + kind + ": allowed with " +
                        kinds);
}

/// Throws InvalidArgument unless paths may replace that of a problem.
void require_takes_paths(const swivel::Problem& problem) {
  require_kind(is_path(problem), "paths", problem, "one path");
  for (const Waypoint& waypoint : problem.arm().path().waypoints)
    if (waypoint.roll)
      throw InvalidArgument(
          "paths: the problem has windows of the roll at its waypoints, which other paths would "
          "lack: allowed is a problem without");
}

/// The number of problems, which is that of the rows of every argument.
class Count {
 public:
  /// Throws InvalidArgument for no rows, and for another number than that of an argument before.
  void take(const std::string& what, std::size_t rows) {
    if (rows == 0) throw InvalidArgument(what + ": 0 rows: allowed are one or more");
    if (!count_) count_.emplace(what, rows);
    if (rows != count_->second)
      throw InvalidArgument(what + ": " + std::to_string(rows) + " rows, but " + count_->first +
                            " has " + std::to_string(count_->second) +
                            ": allowed are as many rows of each");
  }
  /// Throws InvalidArgument where no argument was given.
  [[nodiscard]] std::size_t get() const {
    if (!count_)
      throw InvalidArgument(
          "paths, poses, bases, starts, ends: none is given: allowed are one or more of them");
    return count_->second;
  }

 private:
  std::optional<std::pair<std::string, std::size_t>> count_;  // of the first argument
};

Varied to_varied(const Problem& of, const py::object& paths, const py::dict& poses,
                 const py::object& bases, const py::object& starts, const py::object& ends) {
  const swivel::Problem problem = to_core(of);
  Varied varied;
  Count count;
  if (!paths.is_none()) {
    require_takes_paths(problem);
    varied.paths = to_paths(paths, problem.arm());
    count.take("paths", varied.paths.size());
  }
  for (const auto& [key, given] : poses) {
    const std::string name = py::str(key);
    const std::uint64_t object = object_of(problem, name);
    const std::string what = "poses: '" + name + "'";
    varied.poses.emplace_back(object, GivenPoses(given, what, "row").poses());
    count.take(what, varied.poses.back().second.size());
  }
  if (!bases.is_none()) {
    require_kind(problem.arms.size() == 1, "bases", problem, "one path or strokes");
    varied.bases = GivenPoses(bases, "bases", "row").poses();
    // Rotations to the last digit, since the rotations of objects are multiplied by them.
    for (Pose& base : varied.bases)
      base.linear() = Quaterniond(base.linear()).normalized().toRotationMatrix();
    count.take("bases", varied.bases.size());
  }
  const auto take_postures = [&](const py::object& given, const char* what,
                                 std::vector<Config>& postures) {
    if (given.is_none()) return;
    require_kind(is_path(problem), what, problem, "one path");
    postures = to_postures(given, what, coordinates_of(problem));
    count.take(what, postures.size());
  };
  take_postures(starts, "starts", varied.starts);
  take_postures(ends, "ends", varied.ends);
  varied.numbers.resize(count.get());
  std::iota(varied.numbers.begin(), varied.numbers.end(), std::uint64_t{0});
  return varied;
}

/// Moves all that is stated in the base frame of a problem of one arm as it is seen from a base
/// that stands at this pose: scene objects, and paths that are not on one of them.
void move_base(const Pose& base, swivel::Problem& problem) {
  const Matrix3d back = base.linear().transpose();
  const Vector3d at = base.translation();
  for (SceneObject& object : problem.scene) {
    object.pose.translation() = Vector3d(back * (object.pose.translation() - at));
    object.pose.linear() = Matrix3d(back * object.pose.linear());
  }
  ArmTask& arm = problem.arm();
  for (swivel::Stroke& stroke : arm.strokes) {
    if (!stroke.path_frame.empty() && stroke.path_frame != arm.base_link) continue;
    for (Waypoint& waypoint : stroke.waypoints) {
      waypoint.position = Vector3d(back * (waypoint.position - at));
      waypoint.orientation = Quaterniond(back) * waypoint.orientation;
    }
  }
}

// --- plans

/// Returns the joints of all rows of an answer in the order in which they are run, those of two
/// arms side by side; none unless it is solved.
std::vector<double> joints_of(const swivel::Answer& answer) {
  std::vector<double> joints;
  if (answer.status != PlanStatus::kSolved) return joints;
  const auto add = [&](const TrajectoryRow& row, const ArmAnswer& arm) {
    joints.insert(joints.end(), row.q.data(), row.q.data() + named_joints(arm.joint_names));
  };
  if (answer.arms.size() == 1) {
    for (const swivel::Part& part : answer.arm().parts)
      for (const TrajectoryRow& row : part.rows) add(row, answer.arm());
    return joints;
  }
  for (std::size_t k = 0; k < answer.arm().rows().size(); ++k)
    for (const ArmAnswer& arm : answer.arms) add(arm.rows()[k], arm);
  return joints;
}

/// The joints of answers until their rows are told. Several threads may use it at a time.
class WaitingJoints {
 public:
  void keep(std::uint64_t number, const swivel::Answer& answer) {
    std::vector<double> joints = joints_of(answer);
    const std::lock_guard lock(mutex_);
    waiting_.emplace(number, std::move(joints));
  }
  /// Returns what was kept of a problem, and forgets it; nothing where nothing was.
  [[nodiscard]] std::vector<double> take(std::uint64_t number) {
    const std::lock_guard lock(mutex_);
    auto kept = waiting_.extract(number);
    return kept.empty() ? std::vector<double>() : std::move(kept.mapped());
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, std::vector<double>> waiting_;
};

/// Plans problems that differ from `base`.
class ManyPlanner {
 public:
  ManyPlanner(swivel::Problem base, const py::object& planner, int threads,
              std::optional<double> timeout, std::optional<double> timeout_each, bool prove,
              bool explain)
      : base_(std::move(base)) {
    if (timeout_each && !(*timeout_each > 0))
      throw py::value_error(
          "timeout_each: not a positive number: allowed are values above 0, or None");
    options_.plan = to_plan_options(planner, threads, timeout, prove);
    options_.timeout_each_s = timeout_each;
    options_.plan.evidence.cause = explain;
  }
  /// Calls each(plans) with the row of one problem after the other, in their order. Returns whether
  /// all of them have a row; else time was up.
  bool plan(const Varied& varied, const py::object& each) {
    return interruptible([&](const std::stop_token& stop) {
      std::size_t told = 0;
      WaitingJoints joints;
      ManyOptions options = options_;
      options.planned = [&](std::uint64_t k, const swivel::Answer& answer) {
        joints.keep(k, answer);
      };
      const auto row_done = [&](EpisodeRow row) {
        std::vector<double> own = joints.take(row.episode);
        row.episode = varied.numbers[row.episode];
        const Plans plans = one_plan(std::move(row), std::move(own), width());
        ++told;
        const py::gil_scoped_acquire gil;
        each(plans);
      };
      run(varied, options, Budget(options_.plan.timeout_s, nullptr, stop), stop, row_done);
      return told == varied.numbers.size();
    });
  }
  /// Returns a table without rows.
  [[nodiscard]] Plans nothing() const { return to_plans({}, {}, {0}, width()); }

 private:
  [[nodiscard]] int width() const {
    std::size_t joints = 0;
    for (const ArmTask& arm : base_.arms) joints += arm_of(arm).chain.coordinates();
    return static_cast<int>(joints);
  }
  void run(const Varied& varied, ManyOptions& options, const Budget& all,
           const std::stop_token& stop, const std::function<void(const EpisodeRow&)>& row_done) {
    try {
      if (!robot_) robot_ = prepare_robot(base_, all);
    } catch (const Stopped&) {
      return;
    }
    options.plan.timeout_s = all.seconds_left();
    options.plan.stop = stop;
    const auto problem_of = [&](std::uint64_t k) { return varied.problem(base_, k); };
    const std::uint64_t count = varied.numbers.size();
    if (robot_)
      plan_many(*robot_, base_, count, problem_of, options, row_done);
    else
      plan_many(base_, count, problem_of, options, row_done);
  }

  swivel::Problem base_;
  ManyOptions options_;
  std::shared_ptr<const PreparedRobot> robot_;  // null for two arms
};

}  // namespace

void Plans::save(const std::filesystem::path& file) const {
  std::string ending = file.extension().string();
  for (char& letter : ending)
    if (letter >= 'A' && letter <= 'Z') letter += 'a' - 'A';
  if (ending != ".npz" && ending != ".csv")
    throw InputError("file: '" + file.string() +
                     "': unknown format: allowed are names that end in .npz or .csv");
  io::write_file(file, ending == ".npz" ? to_npz(*this) : to_csv());
}

Plans Plans::joined(const std::vector<Plans>& parts) {
  std::vector<std::pair<const Plans*, std::size_t>> places;  // a table, and the number of its row
  std::size_t numbers_of_joints = 0;
  for (const Plans& part : parts) {
    for (std::size_t k = 0; k < part.rows->size(); ++k) places.emplace_back(&part, k);
    numbers_of_joints += part.joints->size();
  }
  const auto row_at = [](const auto& place) -> const EpisodeRow& {
    return (*place.first->rows)[place.second];
  };
  std::sort(places.begin(), places.end(), [&](const auto& a, const auto& b) {
    return number_of(row_at(a)) < number_of(row_at(b));
  });
  const int joints_of_row = parts.empty() ? kDof : parts.front().width;
  std::vector<EpisodeRow> all_rows;
  std::vector<double> all_joints;
  all_joints.reserve(numbers_of_joints);
  std::vector<std::int64_t> ends{0};
  for (const auto& place : places) {
    all_rows.push_back(row_at(place));
    const auto own = place.first->joints_of(place.second);
    all_joints.insert(all_joints.end(), own.begin(), own.end());
    ends.push_back(static_cast<std::int64_t>(all_joints.size()) / joints_of_row);
  }
  return to_plans(std::move(all_rows), std::move(all_joints), std::move(ends), joints_of_row);
}

swivel::Problem Varied::problem(const swivel::Problem& base, std::size_t k) const {
  swivel::Problem made = base;
  if (!paths.empty()) made.arm().path().waypoints = paths[k];
  for (const auto& [object, all] : poses) made.scene[object].pose = all[k];
  if (!bases.empty()) move_base(bases[k], made);
  if (!starts.empty()) made.arm().path().start = starts[k];
  if (!ends.empty()) made.arm().path().end = ends[k];
  return made;
}

Varied Varied::part(const std::vector<std::size_t>& places) const {
  const auto chosen = [&](const auto& all) {
    std::decay_t<decltype(all)> some;
    if (!all.empty())
      for (const std::size_t place : places) some.push_back(all.at(place));
    return some;
  };
  Varied made{chosen(numbers), chosen(paths), {}, chosen(bases), chosen(starts), chosen(ends)};
  for (const auto& [object, all] : poses) made.poses.emplace_back(object, chosen(all));
  return made;
}

namespace {

/// Returns what reads a member of the row of a Planned.
template <class Member>
auto of_row(Member EpisodeRow::*member) {
  return [member](const Planned& planned) { return planned.row.*member; };
}

void bind_planned(py::module_& m) {
  py::class_<Planned>(m, "Planned", "What became of one of many problems. None: does not apply.")
      .def(pickling<Planned>())
      .def_property_readonly("number", of_row(&EpisodeRow::episode), "Its number.")
      .def_property_readonly(
          "status", of_row(&EpisodeRow::status),
          "Status; 'timeout' where its own time was up, 'error' with the message "
          "as `reason`.")
      .def_property_readonly("solved",
                             [](const Planned& x) { return x.row.status == PlanStatus::kSolved; })
      .def_property_readonly("cost", of_row(&EpisodeRow::cost))
      .def_property_readonly("failed_s", of_row(&EpisodeRow::failed_s), "m, where every path ends.")
      .def_property_readonly("cause", of_row(&EpisodeRow::cause),
                             "What ends them: the cause's kind.")
      .def_property_readonly("by", of_row(&EpisodeRow::by), "The object or joint that ends them.")
      .def_property_readonly("reason", of_row(&EpisodeRow::reason), "What ends them, in words.")
      .def_property_readonly("checked", of_row(&EpisodeRow::checked),
                             "Whether the answer was proved; None unless solved.")
      .def_property_readonly("plan_ms", of_row(&EpisodeRow::plan_ms))
      .def_property_readonly(
          "joints", [](const Planned& x) { return view_of(x.joints, x.width); },
          "(n, 7), rad, base to tip: of a path its trajectory, of strokes the rows of all parts in "
          "the order in which they are run; of two arms (n, 14), side by side. Empty unless "
          "solved.")
      .def("__repr__", &planned_words);
}

void bind_plans(py::module_& m) {
  bind_table<Plans>(m, "Plans",
                    "What became of many problems in the order of their numbers: Planned by "
                    "Planned, or as arrays.")
      .def_property_readonly(
          "number", [](const Plans& t) { return plain(t, &EpisodeRow::episode); },
          "(n,) uint64, numbers.")
      .def_property_readonly(
          "plan_ms", [](const Plans& t) { return plain(t, &EpisodeRow::plan_ms); }, "(n,)")
      .def_property_readonly(
          "cause", [](const Plans& t) { return texts(t, &EpisodeRow::cause); },
          "Names of CauseKinds; 'transition' of strokes, 'conflict' and 'given_motion' of two "
          "arms.")
      .def_property_readonly(
          "by", [](const Plans& t) { return texts(t, &EpisodeRow::by); },
          "The object, joint or bodies in the way.")
      .def_property_readonly(
          "checked",
          [](const Plans& t) {
            return where(t, [](const EpisodeRow& row) { return row.checked.value_or(false); });
          },
          "(n,) bool, whether there is an answer that was proved.")
      .def_property_readonly(
          "joints", [](const Plans& t) { return view_of(t.joints, t.width); },
          "(R, 7), rad: the rows of all problems, as Planned has them, one after the other; of two "
          "arms (R, 14).")
      .def_property_readonly(
          "offsets", [](const Plans& t) { return column(t.offsets, t.offsets->data()); },
          "(n + 1,) int64: rows offsets[k] to offsets[k + 1] of `joints` are those of the k-th.")
      .def("padded", &padded,
           py::arg_v("fill", std::numeric_limits<double>::quiet_NaN(), "float('nan')"),
           "The joints of all problems as one array, (n, L, 7) or (n, L, 14), with `fill` behind "
           "the rows of those that have fewer than the most, L.");
}

}  // namespace

void bind_plan_many(py::module_& m) {
  bind_planned(m);
  bind_plans(m);
  py::class_<Varied>(m, "_Varied")
      .def(pickling<Varied>())
      .def(py::init(&to_varied))
      .def("__len__", [](const Varied& varied) { return varied.numbers.size(); })
      .def("part", &Varied::part);
  py::class_<ManyPlanner>(m, "_ManyPlanner")
      .def(py::init([](const Problem& problem, const py::object& planner, int threads,
                       std::optional<double> timeout, std::optional<double> timeout_each,
                       bool prove, bool explain) {
        return std::make_unique<ManyPlanner>(to_core(problem), planner, threads, timeout,
                                             timeout_each, prove, explain);
      }))
      .def("plan", &ManyPlanner::plan)
      .def("nothing", &ManyPlanner::nothing);
}

}  // namespace swivel::python
