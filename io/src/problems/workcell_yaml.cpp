// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "files/csv.hpp"
#include "motions/given_rows.hpp"
#include "problems/problem_reader.hpp"
#include "robots/joints_to.hpp"
#include "schema/schema.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

namespace {

/// Reads a problem file with `arms`.
class WorkcellReader : ProblemReader {
 public:
  WorkcellReader(const std::filesystem::path& file, YamlSection root)
      : ProblemReader(file, std::move(root)) {}

  Problem read() {
    const auto [key, arms] = *root_.chosen("path");  // throws where there is another as well
    require_keys_beside();
    for (const char* const other : {"start", "start_at", "start_tolerance"})
      if (const auto value = root_.find_filled(other))
        value->fail("is of problems with one path", "`start`, in one of the `arms`");
    if (const auto lift = root_.find_filled("lift"))
      lift->fail("is of jobs, and not supported for two arms", "a workcell without `lift`");
    sections_ = arms.items();
    if (sections_.size() != 2)
      arms.fail("has " + std::to_string(sections_.size()) + " arms", "a list of two");
    cell_ = two_arms();
    read_robot_of_both();
    list_arms();
    require_scene_in_base();
    read_scene();
    for (std::size_t k = 0; k < 2; ++k)
      if (!is_given(k)) read_arm(k);
    for (std::size_t k = 0; k < 2; ++k)
      if (is_given(k)) read_given_arm(k);
    for (std::size_t k = 0; k < 2; ++k)
      if (cell_.leader_of(k) >= 0 && !is_given(1 - k)) refuse_rolling_leader(1 - k);
    if (const auto given = cell_.given_arm())
      read_steps(*given);
    else
      require_equal_lengths();
    require_used_by_one();
    read_may_touch();
    read_vary();
    cell_.source = problem_.source;
    cell_.scene = std::move(problem_.scene);
    cell_.vary = std::move(problem_.vary);
    return std::move(cell_);
  }

 private:
  void require_scene_in_base() const {
    const auto scene = root_.find_filled("scene");
    if (!scene) return;
    for (const YamlValue& item : scene->items())
      if (const auto frame = item.section().find_filled("frame");
          frame && frame->text() != root_.require("robot").section().require("base_link").text())
        frame->fail("is another link than `base_link`, in a workcell, which is not supported yet",
                    "bodies in the frame of `base_link`, or `attached` of an arm");
  }

  void read_robot_of_both() {
    problem_.source = file_.string();
    const YamlValue robot = root_.require("robot");
    for (const char* const key : {"tip_link", "tool", "attached"})
      if (const auto value = robot.section().find_filled(key))
        value->fail("is of one arm, and this file has two", "this key in each of the `arms`");
    read_model(robot);
  }

  /// Reads names and hands of both arms. `problem_` has the attached bodies of both then, which the
  /// scene may allow to touch.
  void list_arms() {
    for (std::size_t k = 0; k < 2; ++k) {
      const YamlSection section = sections_[k].section();
      ArmTask& arm = cell_.arms[k];
      const YamlValue name = section.require("name");
      arm.name = name.name();
      if (arm.name.find_first_of(",\"'\n\r ") != std::string::npos)
        name.fail("is '" + arm.name + "'", "a name without commas, quotes, spaces and line breaks");
      if (k == 1 && arm.name == cell_.arms[0].name)
        name.fail("'" + arm.name + "' is the name of the other arm", "a name of its own");
      if (arm.name == problem_.base_link)
        name.fail("'" + arm.name + "' is the base link", "a name of its own");
      const std::size_t attached = problem_.attached.size();
      problem_.tool = Pose::Identity();
      read_hand(sections_[k]);
      static_cast<Robot&>(arm) = problem_;
      arm.attached.erase(arm.attached.begin(),
                         arm.attached.begin() + static_cast<std::ptrdiff_t>(attached));
    }
  }

  void read_arm(std::size_t k) {
    ArmTask& arm = cell_.arms[k];
    const YamlSection section = sections_[k].section();
    static_cast<Robot&>(problem_) = arm;
    static_cast<Task&>(problem_) = Task();
    problem_.roll.reset();
    more_frames_ = {cell_.arms[1 - k].name};
    more_joints_ = joints_before(cell_.arms[1 - k].tip_link);
    const YamlValue path = section.require("path");
    free_axis_.reset();
    read_path(path);
    if (!problem_.waypoints.empty() && problem_.waypoints.front().roll)
      path.fail("has windows of the roll at waypoints, in a workcell",
                "a roll of the whole path, or none");
    read_task();
    std::vector<YamlValue> limits;
    if (const auto value = root_.find_filled("limits")) limits.push_back(*value);
    if (const auto value = section.find_filled("limits")) {
      read_limits(*value);
      limits.push_back(*value);
    }
    read_cost();
    const ArmModel model = suitable_arm();
    if (free_axis_ && model.chain.free_roll)
      free_axis_->fail("has the tool's axis alone, and the arm has seven joints",
                       "quaternions or tangents in it: in a workcell the roll of arms of six "
                       "joints alone may be free");
    require_in_scale(model, path, limits);
    unused_[k] = unused_keys_of(model);
    if (const auto value = section.find_filled("limits"))
      require_used(unused_[k], *value, "limits");
    if (const auto start = section.find_filled("start")) read_start(*start);
    if (const auto end = path.section().find_filled("end");
        end && model.chain.roll && problem_.path_frame == cell_.arms[1 - k].name)
      end->fail("is given for a follower of six joints, which is not supported yet",
                "no such key here");
    read_end(path, model.chain);
    refuse_closed(path, "one of two arms");
    if (const auto smooth = path.section().find("smooth");
        smooth && !smooth->is_null() && problem_.path_frame == cell_.arms[1 - k].name)
      smooth->fail("is given for a follower, which is not supported yet",
                   "no such key here: the follower keeps to the leader's curve");
    static_cast<Robot&>(arm) = problem_;
    static_cast<Task&>(arm.path()) = problem_;
    if (cell_.leader_of(k) >= 0 && k == 1 && cell_.leader_of(0) >= 0)
      path.fail("leads the arm that leads it", "one arm in the frame of the other");
  }

  /// Throws InputError for a key of the file that no lattice of either arm reads. Lattices refuse
  /// some that are of the other arm alone.
  void require_used_by_one() const {
    const auto given = cell_.given_arm();
    require_used(given ? unused_[1 - *given] : unused_by_both(unused_[0], unused_[1]));
    const auto limits = root_.find_filled("limits");
    for (const std::vector<UnusedKey>& keys : unused_)
      for (const UnusedKey& key : keys)
        if (limits && (key.key == "arm_slope" || key.key == "step_error"))
          require_used({key}, *limits, "limits");
  }

  /// Returns the names of the joints between the root of the robot and a link, and that of a roll.
  [[nodiscard]] std::vector<std::string> joints_before(const std::string& link) const {
    std::vector<std::string> names{"roll"};
    const RobotModel& robot = *problem_.model;
    for (const int joint : joints_to(robot, robot.find_link(link)))
      names.push_back(robot.joints[static_cast<std::size_t>(joint)].name);
    return names;
  }

  /// Refuses the roll of an arm that leads: the follower's path turns with the leader's tool, and
  /// must be known before the leader's roll is chosen.
  void refuse_rolling_leader(std::size_t leader) const {
    if (!cell_.arms[leader].roll) return;
    const YamlValue path = sections_[leader].section().require("path");
    path.section().find("roll").value_or(path).fail(
        "lets the tool turn that carries the path of '" + cell_.arms[1 - leader].name +
            "', which would turn with it",
        "no roll of an arm that leads, or its motion as `trajectory`, which says how the tool "
        "stands turned");
  }

  [[nodiscard]] bool is_given(std::size_t k) const {
    return sections_[k].section().find_filled("trajectory").has_value();
  }

  /// Reads an arm whose motion is given. The other arm has been read.
  void read_given_arm(std::size_t k) {
    ArmTask& arm = cell_.arms[k];
    const YamlSection section = sections_[k].section();
    const YamlValue file = section.require("trajectory");
    if (sections_[1 - k].section().find_filled("trajectory"))
      file.fail("is given, as is that of the other arm", "one arm with a `path`");
    for (const char* const key : {"path", "start", "at_rows"})
      if (const auto value = section.find_filled(key))
        value->fail("is given for an arm whose motion is given", "no such key here");
    static_cast<Robot&>(problem_) = arm;
    static_cast<Task&>(problem_) = Task();
    problem_.roll = Roll{};  // of an arm of six joints, whose rows say how its tool stands turned
    const bool six_joints = suitable_arm().chain.roll;
    if (!six_joints) problem_.roll.reset();
    arm.roll = problem_.roll;
    more_joints_ = joints_before(cell_.arms[1 - k].tip_link);
    read_task();
    if (const auto value = section.find_filled("limits")) read_limits(*value);
    read_cost();
    std::array<JointNames, 2> joints;
    for (std::size_t each = 0; each < 2; ++each) {
      static_cast<Robot&>(problem_) = cell_.arms[each];
      joints[each] = suitable_arm().chain.joint_names;
    }
    arm.given = with_key(file, resolve(file), [&](const std::filesystem::path& path) {
      return load_given_rows(path, k, six_joints, {cell_.arms[0].name, cell_.arms[1].name}, joints);
    });
    static_cast<Task&>(arm.path()) = problem_;
  }

  /// Reads at which rows of the given motion the waypoints of the other arm are.
  void read_steps(std::size_t given) {
    const YamlSection section = sections_[1 - given].section();
    ArmTask& arm = cell_.arms[1 - given];
    const std::size_t rows = cell_.arms[given].given.size(),
                      waypoints = arm.path().waypoints.size();
    const auto at_rows = section.find_filled("at_rows");
    if (!at_rows) {
      if (waypoints != 2 && waypoints != rows)
        section.require("path").fail(
            "has " + std::to_string(waypoints) + " waypoints, and the given motion of '" +
                cell_.arms[given].name + "' " + std::to_string(rows) + " rows",
            "two waypoints, one for each row, or `at_rows` beside the path");
      return;
    }
    std::vector<int> at;
    for (const YamlValue& row : at_rows->items()) {
      if (row.number() != std::floor(row.number()) || row.number() >= static_cast<double>(rows))
        row.fail("is " + csv_number(row.number()),
                 "a whole number from 0 to " + std::to_string(rows - 1) + ", the last row");
      at.push_back(static_cast<int>(row.number()));
      if (at.size() > 1 && at.back() <= at[at.size() - 2])
        row.fail("is " + std::to_string(at.back()) + ", after " + std::to_string(at[at.size() - 2]),
                 "a row after that of the waypoint before");
    }
    if (at.size() != waypoints || at.front() != 0 || at.back() + 1 != static_cast<int>(rows))
      at_rows->fail("has " + std::to_string(at.size()) + " rows" +
                        (at.empty() ? ""
                                    : " from " + std::to_string(at.front()) + " to " +
                                          std::to_string(at.back())),
                    "one for each of the " + std::to_string(waypoints) +
                        " waypoints, from 0 to the last, " + std::to_string(rows - 1));
    for (std::size_t k = 1; k < at.size(); ++k) arm.path().steps.push_back(at[k] - at[k - 1]);
  }

  void require_equal_lengths() const {
    for (const YamlValue& section : sections_)
      if (const auto at_rows = section.section().find_filled("at_rows"))
        at_rows->fail("is given, and no arm has a `trajectory`", "no such key here");
    const std::size_t first = cell_.arms[0].path().waypoints.size(),
                      second = cell_.arms[1].path().waypoints.size();
    if (first != second)
      sections_[1].section().require("path").fail(
          "has " + std::to_string(second) + " waypoints, and that of '" + cell_.arms[0].name +
              "' " + std::to_string(first),
          "as many waypoints in both, since both arms are at theirs at one time");
  }

  void read_may_touch() {
    for (std::size_t k = 0; k < 2; ++k) {
      const auto attached = sections_[k].section().find_filled("attached");
      if (!attached) continue;
      for (const YamlValue& item : attached->items()) {
        const YamlSection body = item.section();
        const auto allow = body.find_filled("allow");
        if (!allow) continue;
        for (const YamlValue& other : allow->items()) {
          require_body_of(cell_.arms[1 - k], other);
          cell_.may_touch.push_back({body.require("name").name(), other.text()});
        }
      }
    }
  }
  static void require_body_of(const ArmTask& arm, const YamlValue& value) {
    const std::string name = value.text();
    const bool is_attached =
        std::any_of(arm.attached.begin(), arm.attached.end(),
                    [&](const AttachedBody& body) { return body.name == name; });
    if (!is_attached && arm.model->find_link(name) < 0)
      value.fail("unknown body '" + name + "'",
                 "a link of arm '" + arm.name + "' or the name of a body attached to it");
  }

  Problem cell_;
  std::vector<YamlValue> sections_;               // of the arms
  std::array<std::vector<UnusedKey>, 2> unused_;  // of the arms that are planned
};

}  // namespace

Problem read_workcell(const std::filesystem::path& file, YamlSection root) {
  return WorkcellReader(file, std::move(root)).read();
}

Problem load_workcell(const std::filesystem::path& yaml) {
  YamlSection root = load_yaml(yaml, problem_schema()).section();
  static_cast<void>(root.chosen("path"));
  if (!root.find_filled("arms"))
    root.self().fail("has no `arms`", "a file with `arms`; io::load_problem() takes any");
  return read_workcell(yaml, std::move(root));
}

}  // namespace swivel::io
