// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <set>

#include "problems/problem_reader.hpp"
#include "schema/schema.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostStrokes = 1000;
constexpr std::size_t kMostWaypoints = 1'000'000;  // of all strokes, as of one path

/// Reads a problem file as a job.
class JobReader : ProblemReader {
 public:
  JobReader(const fs::path& file, YamlSection root) : ProblemReader(file, std::move(root)) {
    feeds_.emplace();
  }

  Problem read() {
    for (const char* const key : {"start", "start_at", "start_tolerance"})
      if (const auto value = root_.find_filled(key))
        value->fail("is of problems with one path", "`home`, of a job");
    read_surroundings();
    list_strokes();
    for (Place& place : places_) read_path_of(place);
    problem_.roll = shared_roll();
    read_shared_task();
    for (std::size_t k = 0; k < places_.size(); ++k) complete(places_[k], job_.arm().strokes[k]);
    read_motion_between();
    read_vary();
    static_cast<Robot&>(job_.arm()) = problem_;
    job_.arm().transition_limits = shared_.limits;
    job_.source = problem_.source;
    job_.scene = std::move(problem_.scene);
    job_.vary = std::move(problem_.vary);
    return std::move(job_);
  }

 private:
  /// Where the file describes a stroke.
  struct Place {
    std::optional<YamlSection> section;  ///< none of the stroke that `path` alone makes
    YamlValue path;
    std::optional<Roll> roll = {};  ///< path.roll as the file has it
    std::optional<Roll> used = {};  ///< that range as narrowed by the windows of the waypoints
    [[nodiscard]] std::optional<YamlValue> find(const char* key) const {
      return section ? section->find(key) : std::nullopt;
    }
  };

  /// Finds the strokes of the file, in `places_`, and names them in `job_`.
  void list_strokes() {
    if (!root_.find_filled("strokes")) {
      places_.push_back({std::nullopt, root_.require("path")});
      job_.arm().strokes.emplace_back().name = "path";
      return;
    }
    const auto [key, value] = *root_.chosen("path");  // throws where there is a path as well
    const std::vector<YamlValue> items = value.items();
    if (items.empty() || items.size() > kMostStrokes)
      value.fail("has " + std::to_string(items.size()) + " strokes",
                 "from 1 to " + std::to_string(kMostStrokes));
    std::set<std::string> names;
    for (const YamlValue& item : items) {
      const YamlSection section = item.section();
      const YamlValue name = section.require("name");
      Stroke& stroke = job_.arm().strokes.emplace_back();
      stroke.name = name_of_stroke(name);
      if (!names.insert(stroke.name).second)
        name.fail("'" + stroke.name + "' is the name of another stroke", "a name of its own");
      places_.push_back({section, section.require("path")});
    }
  }

  /// Returns a name that a column of a CSV file can have as it is.
  static std::string name_of_stroke(const YamlValue& value) {
    std::string name = value.name();
    if (name.find_first_of(",\"'\n\r") != std::string::npos || name.front() == ' ' ||
        name.back() == ' ')
      value.fail("is '" + name + "'",
                 "a name without commas, quotes, line breaks and outer spaces");
    return name;
  }

  /// Reads frame, waypoints, smoothing and feeds of a stroke into `job_`, and its roll into
  /// `place`.
  void read_path_of(Place& place) {
    static_cast<Task&>(problem_) = Task();
    problem_.roll.reset();
    read_path(place.path);
    place.roll = path_roll_;
    place.used = problem_.roll;
    Stroke& stroke = job_.arm().strokes[static_cast<std::size_t>(&place - places_.data())];
    static_cast<Task&>(stroke) = problem_;
    stroke.feed = *feeds_;
    waypoints_ += stroke.waypoints.size();
    if (waypoints_ > kMostWaypoints)
      place.path.fail(
          "the strokes up to this one have " + std::to_string(waypoints_) + " waypoints",
          "at most " + std::to_string(kMostWaypoints) + " in a job");
  }

  /// Returns the range of the roll that all strokes share. Throws InputError if `path.roll` differs
  /// from stroke to stroke, or if the windows of the waypoints leave it open or cover a turn.
  [[nodiscard]] std::optional<Roll> shared_roll() const {
    const std::optional<Roll> roll = places_.front().roll;
    std::size_t with_windows = 0;
    Roll used{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < places_.size(); ++k) {
      if (places_[k].roll != roll)
        places_[k].path.fail("has another roll than " + places_.front().path.key(),
                             "the same `roll` in the paths of all strokes");
      if (!job_.arm().strokes[k].waypoints.front().roll) continue;
      ++with_windows;
      used = {std::min(used.lower, places_[k].used->lower),
              std::max(used.upper, places_[k].used->upper)};
    }
    if (with_windows == 0) return roll;
    if (with_windows == places_.size() && !used.circle()) return used;
    if (roll->circle())
      root_.self().fail(
          "the windows of the roll at waypoints of the strokes leave a whole turn",
          "less than a turn in all: windows in every stroke, or a range in path.roll");
    return roll;
  }

  /// Reads into `problem_` what holds for every stroke.
  void read_shared_task() {
    static_cast<Task&>(problem_) = Task();
    read_task();
    read_cost();
    shared_ = problem_;
    model_ = suitable_arm();
    require_free_axis(*model_);
    unused_ = unused_keys_of(*model_);
    require_used(unused_);
  }

  /// Reads what a stroke has of its own besides its path, and sets the rest as all strokes have it.
  void complete(const Place& place, Stroke& stroke) {
    static_cast<Task&>(problem_) = shared_;
    problem_.path_frame = stroke.path_frame;
    problem_.waypoints = std::move(stroke.waypoints);
    problem_.smooth = stroke.smooth;
    std::vector<YamlValue> limits;
    if (const auto value = root_.find_filled("limits")) limits.push_back(*value);
    if (const auto value = place.find("limits"); value && !value->is_null()) {
      read_limits(*value);
      require_used(unused_, *value, "limits");
      limits.push_back(*value);
    }
    require_in_scale(*model_, place.path, limits);
    read_end(place.path, model_->chain);
    read_closed(place.path, model_->chain);
    static_cast<Task&>(stroke) = std::move(static_cast<Task&>(problem_));
    if (const auto value = place.find("reversible")) stroke.reversible = value->boolean();
    if (const auto end = place.path.section().find_filled("end"); end && stroke.reversible)
      end->fail("is given of a stroke that may be reversed, and would begin there then",
                "`end` in strokes that are not `reversible`");
    stroke.approach = offset(place, "approach");
    stroke.retract = offset(place, "retract");
    require_one_line(place, stroke);
    if (const auto value = place.find("process_speed")) stroke.process_speed = speed(*value);
    if (const auto value = place.find("approach_speed")) stroke.approach_speed = speed(*value);
    for (const double feed : stroke.feed) require_speed(feed, place.path);
  }

  /// Throws InputError for a closed stroke whose run would end elsewhere than it begins.
  static void require_one_line(const Place& place, const Stroke& stroke) {
    if (stroke.closed && stroke.approach != stroke.retract)
      place.path.section().find("closed")->fail(
          "is of the whole run, and the stroke's `approach` and `retract` differ",
          "the same value for both");
  }

  /// Returns where the tool stands before a stroke or after it, m in the tool frame: as the stroke
  /// says, else as the job does.
  [[nodiscard]] Vector3d offset(const Place& place, const char* key) const {
    auto value = place.find(key);
    if (!value) value = root_.find(key);
    if (!value) return Vector3d::Zero();
    const Vector3d offset = value->is_map() ? value->section().require("xyz").vector3()
                                            : Vector3d(0, 0, -value->number());
    const double reach = most_reach(model_->chain);
    if (offset.norm() > reach)
      value->fail(formatted("is %.4g m", offset.norm()) + suspicion(reach),
                  formatted("at most %.3g", reach));
    // A length of 0 has no sign, so that no line is none whatever way it was written.
    return offset.isZero(0) ? Vector3d::Zero() : offset;
  }

  [[nodiscard]] static std::string suspicion(double reach) {
    return formatted(", and the arm reaches %.3g m: are these millimetres?", reach);
  }

  [[nodiscard]] double speed(const YamlValue& value) const {
    const double speed = value.number();
    require_speed(speed, value);
    return speed;
  }

  /// Throws InputError for a speed of the tool that is out of all proportion to the arm.
  void require_speed(double speed, const YamlValue& value) const {
    const double reach = most_reach(model_->chain), most = 10 * reach;
    if (speed > most)
      value.fail(formatted("a speed is %.4g m/s", speed) + suspicion(reach),
                 formatted("at most %.3g m/s", most));
  }

  /// Returns the configuration of `home`. Of an arm of six joints six numbers are enough: the roll
  /// of the tool means nothing there.
  [[nodiscard]] Config home_of(const YamlValue& joints) const {
    return leaves_out_roll(joints, model_->chain) ? without_roll(joints)
                                                  : Config::of(joint_numbers(joints).data());
  }

  /// Reads the keys of the job that are of no single stroke.
  void read_motion_between() {
    if (const auto home = root_.find_filled("home")) {
      job_.arm().home = home_of(home->section().require("joints"));
    }
    if (const auto order = root_.find("order"))
      job_.arm().order = word(*order, {StrokeOrder::kGiven, StrokeOrder::kBest});
    if (const auto value = root_.find("process_speed")) job_.arm().process_speed = speed(*value);
    if (const auto value = root_.find("approach_speed")) job_.arm().approach_speed = speed(*value);
    if (const auto rapid = root_.find("rapid")) job_.arm().rapid = rapid->number();
    read_lift();
  }

  void read_lift() {
    const auto lift = root_.find_filled("lift");
    job_.arm().lift = lift_offs_of(root_);
    if (!job_.arm().lift) return;
    if (job_.arm().order != StrokeOrder::kGiven)
      lift->fail("is given with `order: best`, and strokes in several runs are ordered as given",
                 "`order: given`, or no lift-offs");
    for (const Stroke& stroke : job_.arm().strokes) {
      if (stroke.name.find('/') != std::string::npos)
        lift->fail("is given with a stroke named '" + stroke.name +
                       "', and runs of strokes are named by a slash and a number",
                   "names without a slash");
      if (stroke.closed)
        lift->fail("is given with stroke '" + stroke.name +
                       "', whose path is closed and is done in one run",
                   "paths that are not closed, or no lift-offs");
    }
  }

  Problem job_;
  std::vector<Place> places_;
  std::size_t waypoints_ = 0;
  Task shared_;
  std::optional<ArmModel> model_;
  std::vector<UnusedKey> unused_;
};

YamlSection load_root(const fs::path& yaml) {
  return load_yaml(yaml, problem_schema()).section();
}

}  // namespace

Problem read_job(const fs::path& file, YamlSection root) {
  return JobReader(file, std::move(root)).read();
}

std::optional<LiftOffs> lift_offs_of(const YamlSection& root) {
  const auto lift = root.find_filled("lift");
  if (!lift) return std::nullopt;
  LiftOffs read;
  const YamlSection section = lift->section();
  const bool allowed = section.require("allowed").boolean();
  if (const auto cost = section.find("cost")) read.cost = cost->number();
  if (const auto overlap = section.find("overlap")) read.overlap = overlap->number();
  return allowed ? std::optional(read) : std::nullopt;
}

Problem load_job(const fs::path& yaml) {
  return read_job(yaml, load_root(yaml));
}

}  // namespace swivel::io
