// SPDX-License-Identifier: BSD-3-Clause
// Reads the sections of problem files, for problems and for jobs.
#pragma once
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "problems/path_file.hpp"
#include "robots/urdf.hpp"
#include "schema/yaml_value.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/kinds/unused_keys.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/robot_key_error.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/io/meshes/mesh.hpp"

namespace swivel::io {

/// Calls `read` with another file. An InputError about that file is thrown again with the place of
/// `key`, which names the file.
template <class Read>
auto with_key(const YamlValue& key, const std::filesystem::path& file, const Read& read) {
  try {
    return read(file);
  } catch (const RobotKeyError&) {  // already tells the key that is wrong
    throw;
  } catch (const InputError& error) {
    throw InputError(key.where() + ": " + error.what());
  }
}

/// Reads a problem file section by section into one problem. Every function throws InputError at
/// the line of the key that is wrong.
class ProblemReader {
 public:
  ProblemReader(std::filesystem::path file, YamlSection root)
      : file_(std::move(file)), root_(std::move(root)) {}

  /// Reads the file as a problem, which has one path. Throws InputError for a job.
  PathProblem read();

 protected:
  /// Reads the robot and the bodies about it into `problem_`: `robot`, `scene`.
  void read_surroundings();
  /// Reads the robot's files, `base_link` and `hold` of the section `robot`.
  void read_model(const YamlValue& value);
  /// Reads `tip_link`, `tool` and `attached` of the robot or of one arm.
  void read_hand(const YamlValue& value);
  void read_scene();
  /// Reads `start`, of the file or of one arm.
  void read_start(const YamlValue& value);
  /// Throws InputError for a key of the file that only stands beside another one that is missing.
  void require_keys_beside() const;
  /// Throws InputError for such a key of a section.
  static void require_keys_beside(const YamlSection& section, const Schema& schema);
  /// Reads `path` into `problem_`: frame, waypoints, smoothing, roll, and feeds where `feeds_` is
  /// set.
  void read_path(const YamlValue& value);
  /// Reads `resolution`, `limits` and `refine` of the file into `problem_`.
  void read_task();
  /// Replaces the limits of `problem_` that the section `limits` has.
  void read_limits(const YamlValue& value);
  /// Reads `cost` of the file into `problem_`. The roll must be known.
  void read_cost();
  /// Reads `vary` of the file into `problem_`.
  void read_vary();
  /// Reads `end` of a path, if it is there, into `problem_`, which must have the path's waypoints.
  /// Of an arm of six joints six numbers are enough: the roll is that of the last waypoint.
  void read_end(const YamlValue& path, const Chain& chain);
  /// Reads `closed` of a path, if it is there, into `problem_`, which must have the path's
  /// waypoints, start and end.
  void read_closed(const YamlValue& path, const Chain& chain);
  /// Throws InputError where a path is closed; `what` says of what paths are not.
  static void refuse_closed(const YamlValue& path, const std::string& what);

  /// Returns the path of a file that a key names, from the folder of the problem file.
  [[nodiscard]] std::filesystem::path resolve(const YamlValue& name) const;
  [[nodiscard]] std::string link_name(const YamlValue& value) const;
  /// Returns one number for each joint of the arm, base to tip. An arm of six joints whose tool may
  /// turn has a seventh number, for the roll; one whose tool may not has six, and 0 is added.
  [[nodiscard]] std::vector<double> joint_numbers(const YamlValue& value) const;
  /// Returns whether a list of joints leaves out the roll of an arm of six joints.
  [[nodiscard]] static bool leaves_out_roll(const YamlValue& joints, const Chain& chain) {
    return chain.tool_may_turn() && chain.roll && joints.is_sequence() &&
           joints.items().size() == kDof - 1;
  }
  /// Returns the joints of such a list, with roll 0.
  [[nodiscard]] static Config without_roll(const YamlValue& joints);

  /// Returns the arm. Throws InputError, at the key in the problem file, for values of `robot` that
  /// do not suit the robot's file.
  [[nodiscard]] ArmModel suitable_arm() const;
  /// Throws InputError for lengths of `problem_` that are out of all proportion to the arm, at
  /// their key: in the `path` that they were read from, or in the last of the sections `limits`
  /// that has the key.
  void require_in_scale(const ArmModel& model, const YamlValue& path,
                        const std::vector<YamlValue>& limits) const;
  /// Throws InputError, at its key, for a value that no lattice of the arm reads: of a section
  /// `resolution` or `limits`, whose name is given.
  static void require_used(const std::vector<UnusedKey>& unused, const YamlValue& value,
                           const std::string& section);
  /// Calls require_used() for both sections of the file.
  void require_used(const std::vector<UnusedKey>& unused) const;
  /// Returns the keys of those sections that no lattice of the arm reads.
  [[nodiscard]] std::vector<UnusedKey> unused_keys_of(const ArmModel& model) const;
  /// Throws InputError if the file of a path has the tool's axis alone, and the arm has seven
  /// joints but no arm angle: no lattice turns its tool then.
  void require_free_axis(const ArmModel& model) const;

  /// Returns what a word stands for. `values` are in the order of the schema's words.
  template <class Enum>
  static Enum word(const YamlValue& value, std::initializer_list<Enum> values) {
    return std::vector<Enum>(values).at(value.word());
  }

  std::filesystem::path file_;
  YamlSection root_;
  PathProblem problem_;
  /// `path.roll` of the path that was read last, as the file has it; in `problem_` it is narrowed
  /// to what the windows of the waypoints allow.
  std::optional<Roll> path_roll_;
  /// Where a path's CSV file may have feeds: those of the path that was read last, m/s.
  std::optional<std::vector<double>> feeds_;
  /// The name of the first path file that has the tool's axis alone.
  std::optional<YamlValue> free_axis_;
  /// Names of frames that a path may be in besides `base_link` and those of scene objects.
  std::vector<std::string> more_frames_;
  /// Names of joints that `cost.weights` may have besides those of the arm.
  std::vector<std::string> more_joints_;

 private:
  [[nodiscard]] bool is_attached(const std::string& name) const;
  [[nodiscard]] bool is_object(const std::string& name) const;

  /// Calls `work`. A RobotKeyError is thrown again as an InputError at the line of that key of
  /// `robot`.
  template <class Work>
  auto at_their_keys(const Work& work) const {
    try {
      return work();
    } catch (const RobotKeyError& error) {
      std::optional<YamlValue> value = root_.require("robot").section().find(error.key());
      if (!value) throw;
      if (error.key() == "hold")
        for (const auto& [joint, position] : value->entries())
          if (joint == error.entry()) value = position;
      if (error.key() == "without")
        for (const YamlValue& link : value->items())
          if (link.text() == error.entry()) value = link;
      throw InputError(value->where(), error.fault());
    }
  }

  void read_robot(const YamlValue& value);
  [[nodiscard]] Packages read_packages(const YamlSection& section) const;
  /// Returns the links that the section `robot` leaves out.
  [[nodiscard]] static std::vector<std::string> read_without(const YamlSection& section);
  [[nodiscard]] std::vector<std::string> joint_names() const;
  /// Narrows the limits of the robot's joints as the section `limits` says.
  void read_robot_limits(const YamlValue& value, RobotModel& robot) const;
  void read_hold(const YamlValue& value);
  void read_attached(const YamlValue& value);
  Shape shape(const YamlSection& section);
  static Vector3d mesh_scale(const YamlValue& value);
  /// Attaches a body of the scene, whose pose is in the frame of a link, to that link.
  void fix_to_link(const YamlValue& frame, const std::optional<YamlValue>& allow,
                   SceneObject object);
  void read_allowed(const YamlValue& value, SceneObject& object) const;
  void read_waypoints(const YamlValue& value);
  /// Reads the file of a path, whose section and name are given.
  void read_path_file(const YamlSection& section, const YamlValue& name);
  /// Frees the roll for a path whose file has the tool's axis alone, and adds a warning if the
  /// section does not say so. Throws InputError for a range of the roll.
  void free_axis(const YamlSection& section, const YamlValue& name,
                 std::vector<std::string>& warnings);
  /// Adds warnings to those of the robot's files, which every answer has.
  void warn(const std::vector<std::string>& warnings);
  /// Limits the window of rolls of each waypoint to the range of path.roll, and that range to what
  /// all windows cover together. Throws InputError if a window becomes empty, if the roll is not
  /// free, or if the windows cover only one roll or a whole turn.
  void narrow_roll(const YamlValue& poses);
  void read_roll(const YamlValue& value);
  /// Reads path.smooth. null stands for the polyline itself, whatever the command smooths by
  /// default.
  void read_smooth(const YamlValue& value);
  void read_refine(const YamlValue& value);
  /// Reads `cost.weights`: one for each joint, or by name.
  void read_weights(const YamlValue& value);
  void read_resolution(const YamlValue& value);
  [[nodiscard]] ArmModel arm() const;
  void read_start_place();
  void require_one_path() const;

  /// Sets a number if its key is present; otherwise keeps the default.
  static void set(const YamlSection& section, const char* key, double& target);
  /// Sets a limit if its key is present; an explicit null means that there is no such limit.
  static void set(const YamlSection& section, const char* key, std::optional<double>& target);
  /// Sets a limit that is given as one number for all joints or as one for each.
  void set(const YamlSection& section, const char* key,
           std::optional<std::array<double, kDof>>& target) const;

  std::shared_ptr<RobotModel> model_file_;  ///< problem_.model
  AptFile apt_file_;
  MeshCache meshes_;
};

/// Returns what a problem file says of lift-offs, which makes it a job; none where it allows none.
[[nodiscard]] std::optional<LiftOffs> lift_offs_of(const YamlSection& root);
/// Reads the root of a job's file, which has `strokes` or a path. Throws InputError.
[[nodiscard]] Problem read_job(const std::filesystem::path& file, YamlSection root);
/// Reads the root of a file with `arms`. Throws InputError.
[[nodiscard]] Problem read_workcell(const std::filesystem::path& file, YamlSection root);

}  // namespace swivel::io
