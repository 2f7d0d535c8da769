// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "options/commands.hpp"
#include "options/known_name.hpp"
#include "options/packages_option.hpp"
#include "options/search_options.hpp"
#include "output/first_problem.hpp"
#include "output/pairs_report.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/arm_guess.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/robot_key_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/study/first_path.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// The command line of `swivel info`.
struct InfoArguments {
  std::string urdf, srdf, base, tip;
  std::vector<std::string> hold, packages, without;
  std::filesystem::path write;
  bool pairs = false, roll = false;
};

/// Returns the positions of --hold by joint, in rad or m. Throws InputError.
std::map<std::string, double> parse_hold(const std::vector<std::string>& items) {
  std::map<std::string, double> hold;
  for (const std::string& item : items) {
    const std::size_t equals = std::min(item.find('='), item.size());
    const char* const end = item.data() + item.size();
    double value = std::numeric_limits<double>::quiet_NaN();
    const auto read = std::from_chars(std::min(item.data() + equals + 1, end), end, value);
    if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value))
      throw InputError("--hold: '" + item +
                       "': allowed is JOINT=POSITION with a number of radians or metres");
    hold[item.substr(0, equals)] = value;
  }
  return hold;
}

/// Returns true if a link is another, or lies on the way from the root to it.
bool is_above(const RobotModel& robot, const std::string& upper, const std::string& lower) {
  int link = robot.find_link(lower);
  while (link >= 0 && robot.links[static_cast<std::size_t>(link)].name != upper) {
    const int joint = robot.links[static_cast<std::size_t>(link)].parent_joint;
    link = joint < 0 ? -1 : robot.joints[static_cast<std::size_t>(joint)].parent_link;
  }
  return link >= 0;
}

/// The joints that move on their own on the way between two links, down the tree from one and up to
/// the other, without those that are held.
struct JointsBetween {
  int turning = 0, sliding = 0;
  [[nodiscard]] int all() const { return turning + sliding; }
};
JointsBetween joints_between(const RobotModel& robot, const std::string& base,
                             const std::string& tip, const std::map<std::string, double>& hold) {
  std::set<int> between;  // those on the way from one of the links to the root alone
  for (const std::string& end : {base, tip})
    for (int link = robot.find_link(end); link >= 0;) {
      const int joint = robot.links[static_cast<std::size_t>(link)].parent_joint;
      if (joint < 0) break;
      if (!between.insert(joint).second) between.erase(joint);
      link = robot.joints[static_cast<std::size_t>(joint)].parent_link;
    }
  JointsBetween count;
  for (const int number : between) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(number)];
    if (!joint.movable() || joint.mimic || hold.contains(joint.name)) continue;
    ++(joint.type == Joint::Type::kPrismatic ? count.sliding : count.turning);
  }
  return count;
}

/// Returns base and tip as the command line names them; guesses what it does not name. Sets
/// `others` to the guessed arms that were not chosen. Throws InputError.
ArmGuess choose_arm(const RobotModel& robot, const InfoArguments& arguments,
                    const std::map<std::string, double>& hold, std::vector<ArmGuess>& others) {
  const std::string &base = arguments.base, &tip = arguments.tip;
  if (!base.empty()) require_known("--base", base, robot.links, "link", robot.source);
  if (!tip.empty()) {
    require_known("--tip", tip, robot.links, "link", robot.source);
    ArmGuess named{base.empty() ? robot.links[robot.root_link].name : base, tip};
    if (arguments.roll || joints_between(robot, named.base, tip, hold).all() == 6) named.joints = 6;
    return named;
  }
  ArmGuesses guesses = guess_arms(robot);
  if (arguments.roll)
    std::erase_if(guesses.arms, [](const ArmGuess& arm) { return arm.joints != 6; });
  if (!base.empty()) {
    // Arms below the base; where there are none, those that stand beside it, as a table does.
    const bool below = std::ranges::any_of(
        guesses.arms, [&](const ArmGuess& arm) { return is_above(robot, base, arm.tip); });
    std::erase_if(guesses.arms, [&](const ArmGuess& arm) {
      return is_above(robot, base, arm.tip) != below ||
             joints_between(robot, base, arm.tip, hold).all() < arm.joints;
    });
    for (ArmGuess& arm : guesses.arms) {
      arm.base = base;
      // A rail or a torso under the arm, or a table under the part, is a seventh joint.
      const JointsBetween between = joints_between(robot, base, arm.tip, hold);
      if (!arguments.roll && between.all() == kDof && between.sliding <= 1) arm.joints = kDof;
    }
  }
  if (guesses.arms.empty()) {
    const auto& row = guesses.longest_row;
    throw InputError(robot.source,
                     std::string("no arm of ") + (arguments.roll ? "six" : "seven or six") +
                         " joints" + (base.empty() ? "" : " above '" + base + "'") +
                         (row.empty() ? ": no joint turns"
                                      : ": the longest row of joints that turn has " +
                                            std::to_string(row.size()) + ", from '" + row.front() +
                                            "' to '" + row.back() + "'") +
                         ": allowed are so many joints in a row, or --base and --tip");
  }
  others.assign(guesses.arms.begin() + 1, guesses.arms.end());
  return guesses.arms.front();
}

/// Returns true if axes k, k + 1, k + 2 (from 0) meet in one point, within 1 mm.
bool meet(const Chain& chain, std::size_t k) {
  const auto line_distance = [&](const Vector3d& point, std::size_t j) {
    return (point - chain.point[j]).cross(chain.axis[j]).norm();
  };
  // The point of the middle axis that is nearest to the first.
  const Vector3d &a = chain.axis[k], &b = chain.axis[k + 1],
                 d = chain.point[k] - chain.point[k + 1];
  const double sine2 = a.cross(b).squaredNorm();
  if (sine2 < 1e-12) return false;
  const Vector3d point = chain.point[k + 1] + (d.dot(b) - d.dot(a) * a.dot(b)) / sine2 * b;
  constexpr double kMiss = 1e-3;
  return line_distance(point, k) < kMiss && line_distance(point, k + 2) < kMiss;
}

/// Prints dimensions, fit and reach of an S-R-S arm.
void print_srs(const SrsArm& srs) {
  const bool offset = std::abs((srs.E - srs.S).normalized().dot(srs.axis[2])) < 1 - 1e-6 ||
                      std::abs((srs.W - srs.E).normalized().dot(srs.axis[4])) < 1 - 1e-6;
  say("class      S-R-S%s\n", offset ? ", in-plane elbow offset" : "");
  if (srs.exact)
    say("fit        exact\n");
  else
    say("fit        axes within %.3f mm and %.3f mrad of the ideal arm\n",
        1e3 * srs.deviation.offset, 1e3 * srs.deviation.angle);
  if (!srs.exact)
    say("misfit     joints within %.3g rad of the ideal arm's away from singular poses\n",
        srs.fit_error.maxCoeff());
  say("shoulder   %.6f %.6f %.6f m\n", srs.S.x(), srs.S.y(), srs.S.z());
  say("lengths    shoulder-elbow %.6f m, elbow-wrist %.6f m, wrist-tip %.6f m\n", srs.upper,
      srs.fore, srs.wrist_in_tool.norm());
  say("reach      shoulder-wrist %.6f to %.6f m before joint limits\n",
      std::abs(srs.upper - srs.fore), srs.upper + srs.fore);
  say("straight   at joint 4 = %.6f rad (%.3f deg)\n", std::remainder(-srs.elbow_shift, kTwoPi),
      std::remainder(-srs.elbow_shift, kTwoPi) * 180 / kPi);
}

/// Prints what an arm that is not S-R-S looks like.
void print_other(const Chain& chain, const ArmClass& arm) {
  if (const int slide = chain.slide(); slide >= 0) {
    say("class      6R and a slide, joint %d\n", slide + 1);
    return;
  }
  const bool wrist = meet(chain, chain.roll ? 3 : 4);
  say("class      %s with %s shoulder and %s wrist\n", chain.roll ? "6R" : "7R",
      meet(chain, 0) ? "a spherical" : "no spherical", wrist ? "a spherical" : "no spherical");
  if (!chain.roll) say("not S-R-S  %s\n", arm.not_srs.c_str());
  if (chain.roll)
    say("roll       with `path.roll: free` the tool may turn about its own z axis; without, it "
        "stands as the waypoints have it\n");
}

/// Returns the joints that move on their own and are neither the arm's nor between base and tip,
/// such as those of a gripper or of another arm, with the positions at which they are held.
std::vector<HeldJoint> held_beside(const RobotModel& robot, const ArmModel& arm,
                                   const std::map<std::string, double>& hold) {
  std::vector<HeldJoint> beside;
  for (const Joint& joint : robot.joints) {
    const auto is_named = [&](const HeldJoint& held) { return held.name == joint.name; };
    const auto& own = arm.chain.joint_names;
    if (!joint.movable() || joint.mimic ||
        std::find(own.begin(), own.end(), joint.name) != own.end() ||
        std::any_of(arm.held.begin(), arm.held.end(), is_named))
      continue;
    const auto given = hold.find(joint.name);
    const double nearest =
        joint.type == Joint::Type::kContinuous ? 0 : std::clamp(0.0, joint.lower, joint.upper);
    beside.push_back({joint.name, given == hold.end() ? nearest : given->second,
                      joint.type == Joint::Type::kPrismatic, given != hold.end(), ""});
  }
  return beside;
}

/// Returns whether a joint may turn or shift a table: it alone moves between the root and the
/// plate, and at most one more joint moves on it, as of a table on a table. A leg has more.
bool moves_a_table(const RobotModel& robot, const Joint& table) {
  const auto plate_of = [&](const Joint& joint) -> const std::string& {
    return robot.links[static_cast<std::size_t>(joint.child_link)].name;
  };
  int on_it = 0;
  for (const Joint& joint : robot.joints) {
    if (&joint == &table || !joint.movable()) continue;
    if (is_above(robot, plate_of(joint), plate_of(table))) return false;
    on_it += is_above(robot, plate_of(table), plate_of(joint));
  }
  return on_it <= 1;
}

/// Prints which joints beside an arm of six joints may be its seventh: rails and torsos, whose
/// parent is then the base, and tables, whose plate is. Where others lie between base and tip as
/// well, they are to be held.
void print_more_axes(const RobotModel& robot, const ArmGuess& chosen, const Chain& six) {
  for (const Joint& joint : robot.joints) {
    if (joint.mimic || !joint.movable()) continue;
    const auto name = [&](int link) -> const std::string& {
      return robot.links[static_cast<std::size_t>(link)].name;
    };
    std::map<std::string, double> others;
    for (const Joint& other : robot.joints)
      if (other.movable() && !other.mimic && &other != &joint &&
          std::find(six.joint_names.begin(), six.joint_names.end(), other.name) ==
              six.joint_names.end())
        others[other.name] =
            other.type == Joint::Type::kContinuous ? 0 : std::clamp(0.0, other.lower, other.upper);
    const bool slides = joint.type == Joint::Type::kPrismatic;
    const auto print_where_first = [&](const char* what, const std::string& base) {
      try {
        const ArmModel with_it = build_arm(robot, base, chosen.tip, others, Pose::Identity());
        if (with_it.chain.roll || with_it.chain.joint_names[0] != joint.name) return;
        std::string hold;
        for (const HeldJoint& held : with_it.held)
          if (held.leader.empty())
            hold += " --hold " + quoted(held.name) + "=" + shortest(held.position);
        say("%-11s%s %s %s: --base %s%s makes it the first of seven joints\n", what,
            joint.name.c_str(), slides ? "shifts" : "turns", name(joint.child_link).c_str(),
            base.c_str(), hold.c_str());
      } catch (const InputError&) {
        // not a row of seven joints
      }
    };
    if (is_above(robot, name(joint.child_link), chosen.tip))
      print_where_first(slides ? "rail" : "torso", name(joint.parent_link));
    else if (moves_a_table(robot, joint))
      print_where_first("table", name(joint.child_link));
  }
}

/// Calls `work` and returns its result. Throws InputError in the name of the option that stands for
/// a key of `robot` if `work` finds the key wrong.
template <class Work>
auto in_the_options_names(const Work& work) {
  try {
    return work();
  } catch (const RobotKeyError& error) {
    const std::string& key = error.key();
    const char* const option = key == "hold"       ? "--hold"
                               : key == "without"  ? "--without"
                               : key == "tip_link" ? "--tip"
                                                   : "--base";
    throw InputError(std::string(option) + ": " + error.fault());
  }
}

/// Throws InputError for the name of a problem file, which is not what this command describes.
void require_no_problem_file(const std::string& name) {
  const std::string end = std::filesystem::path(name).extension();
  if (end == ".yaml" || end == ".yml")
    throw InputError(
        name + ": is a problem file: allowed is a URDF file, or `swivel info --pairs " + name +
        "` for the pairs of bodies and `swivel plan " + name + "` for its path");
}

/// Prints the size of the robot, and what its collision shapes lack.
void print_robot(const RobotModel& robot, const io::ShapeSurvey& shapes) {
  say("robot      %s: %zu links, %zu joints\n", robot.name.c_str(), robot.links.size(),
      robot.joints.size());
  if (!shapes.missing_meshes.empty())
    say("meshes     %zu not found, which planning needs: %s\n", shapes.missing_meshes.size(),
        shapes.missing_meshes.front().c_str());
  if (shapes.collision == 0)
    say("shapes     none for collision: the robot is kept clear of nothing%s\n",
        shapes.visual_meshes == 0
            ? ""
            : "; `swivel fit --visual` fits capsules about its visual meshes");
}

/// Prints base and tip of the arm, the joints that stand still, the linkages, and the other arms of
/// the robot.
void print_arm(const RobotModel& robot, const ArmGuess& chosen, const ArmModel& arm,
               const std::map<std::string, double>& hold, const std::vector<ArmGuess>& others) {
  say("arm        %s to %s\n", chosen.base.c_str(), chosen.tip.c_str());
  for (const HeldJoint& held : arm.held) say("held       %s\n", words({held}).c_str());
  if (const auto beside = held_beside(robot, arm, hold); !beside.empty())
    say("beside     %s\n", words(beside).c_str());
  for (const Chain::Follower& follower : arm.chain.followers)
    say("linkage    %s moves by %.6g times joint %d\n", follower.name.c_str(), follower.multiplier,
        follower.leader + 1);
  for (const ArmGuess& other : others)
    say("other arm  %s to %s%s\n", other.base.c_str(), other.tip.c_str(),
        other.joints == 6 ? ", six joints" : "");
}

/// Prints the class of the arm, its dimensions, and how its inverse kinematics is solved.
void print_class(const Chain& chain, const ArmClass& kind) {
  kind.srs ? print_srs(*kind.srs) : print_other(chain, kind);
  say("solutions  %s: %s\n", kind.complete() ? "all" : "those that turn up", kind.method().c_str());
}

/// Prints the limits of each joint of the arm.
void print_joints(const Chain& chain) {
  for (std::size_t j = 0; j < kDof - (chain.roll ? 1 : 0); ++j) {
    const JointLimit& limit = chain.limit[j];
    if (limit.slides)
      say("joint %zu    %-24s %9.4f to %9.4f m", j + 1, chain.joint_names[j].c_str(), limit.lower,
          limit.upper);
    else if (limit.continuous)
      say("joint %zu    %-24s continuous", j + 1, chain.joint_names[j].c_str());
    else
      say("joint %zu    %-24s %9.4f to %9.4f rad (%7.2f to %7.2f deg)", j + 1,
          chain.joint_names[j].c_str(), limit.lower, limit.upper, limit.lower * 180 / kPi,
          limit.upper * 180 / kPi);
    limit.velocity > 0 ? say(", %.3f %s\n", limit.velocity, limit.slides ? "m/s" : "rad/s")
                       : say(", no speed limit\n");
  }
}

/// Prints what is doubtful about limits, held joints and the robot's files.
void print_warnings(const std::shared_ptr<const RobotModel>& model, const ArmModel& arm) {
  const RobotModel& robot = *model;
  Robot whole;
  whole.model = model;
  for (const std::string& warning : limit_warnings(arm.chain))
    say("warning    %s\n", warning.c_str());
  for (const std::string& warning : held_warnings(arm.held))
    say("warning    %s\n", warning.c_str());
  for (const std::string& warning : file_warnings(robot, arm.chain))
    say("warning    %s\n", warning.c_str());
  for (const std::string& warning : scale_warnings(arm.chain, whole))
    say("warning    %s\n", warning.c_str());
  if (const std::string rest = joints_at_rest(robot, arm.chain); !rest.empty())
    say("warning    %s\n", rest.c_str());
}

/// Writes the start of a problem file for an arm, with a path that it can follow. Throws InputError
/// if there is none among those tried.
void write_problem(const InfoArguments& arguments, const ArmGuess& chosen, const ArmModel& arm,
                   const std::map<std::string, double>& hold) {
  constexpr double kTime = 30;  // s, for all paths together
  const auto packages = parse_packages(arguments.packages);
  io::InputFiles inputs;
  Robot robot;
  robot.model = io::load_robot(arguments.urdf, arguments.srdf, packages, {arguments.without, true});
  robot.base_link = chosen.base, robot.tip_link = chosen.tip, robot.hold = hold;
  if (chosen.joints == 6) robot.roll = Roll{};
  io::OutputFiles outputs(inputs.files());
  outputs.add("--write", arguments.write);
  PlanOptions options;
  options.timeout_s = kTime;
  const FirstPath found = find_first_path(robot, options);
  if (found.waypoints.empty())
    throw InputError("--write",
                     "none of " + std::to_string(found.tried) +
                         " straight paths tried can be followed" +
                         (found.tried == 0 ? ""
                          : found.plan.status == PlanStatus::kInfeasible
                              ? "; of the last one: " + words(found.plan.diagnosis->cause)
                              : " in time") +
                         ": allowed is an arm that can move");
  outputs.write("--write",
                first_problem({arguments.urdf, arguments.srdf, packages, arguments.without}, robot,
                              arm, found.waypoints, arguments.write));
  outputs.stage();
  if (!outputs.takes_standard_output())
    say("written    %s: a path of %.3f m, planned with cost %.4f; next: swivel plan %s\n",
        arguments.write.string().c_str(),
        (found.waypoints[1].position - found.waypoints[0].position).norm(), found.plan.cost,
        arguments.write.string().c_str());
  flush_standard_output();
  static_cast<void>(outputs.commit());
}

/// Describes the arm of the command line, or with --pairs the pairs of bodies of a problem. Returns
/// the exit code. Throws InputError.
int run(const InfoArguments& arguments) {
  if (arguments.pairs) {
    print_pairs(arguments.urdf);
    return kOk;
  }
  require_no_problem_file(arguments.urdf);
  io::ShapeSurvey shapes;
  const auto robot = in_the_options_names([&] {
    return io::load_kinematics(arguments.urdf, arguments.srdf, parse_packages(arguments.packages),
                               {arguments.without, true}, shapes);
  });
  const std::map<std::string, double> hold = parse_hold(arguments.hold);
  for (const auto& [name, position] : hold)
    require_known("--hold", name, robot->joints, "joint", robot->source);
  std::vector<ArmGuess> others;
  const ArmGuess chosen = choose_arm(*robot, arguments, hold, others);
  const ArmModel arm = in_the_options_names([&] {
    return build_arm(*robot, chosen.base, chosen.tip, hold, Pose::Identity(),
                     chosen.joints == 6 ? std::optional(Roll{}) : std::nullopt);
  });
  const ArmClass kind = classify(arm.chain, robot->source);
  if (arguments.write != "-") {
    print_robot(*robot, shapes);
    print_arm(*robot, chosen, arm, hold, others);
    if (arm.chain.roll) print_more_axes(*robot, chosen, arm.chain);
    print_class(arm.chain, kind);
    print_joints(arm.chain);
    print_warnings(robot, arm);
  }
  if (!arguments.write.empty()) write_problem(arguments, chosen, arm, hold);
  return kOk;
}

}  // namespace

void add_info(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("info", "Describe an arm: class, dimensions, limits, what was fitted");
  // The callback shares the arguments, which must live as long as it does.
  auto arguments = std::make_shared<InfoArguments>();
  command->add_option("robot", arguments->urdf, "URDF file; with --pairs a problem file")
      ->required();
  command->add_option("--srdf", arguments->srdf,
                      "SRDF file: which joints are passive, and whether its names are the robot's");
  command->add_option("--packages", arguments->packages, kPackagesHelp);
  command->add_option("--without", arguments->without,
                      "links left out, with all that they carry, as robot.without does");
  command->add_option(
      "--base", arguments->base,
      "base link (default: the nearest called base_link or the like, else the root)");
  command->add_option("--tip", arguments->tip,
                      "tip link (default: the end of the first arm of seven joints, else of six)");
  command->add_option("--hold", arguments->hold, "JOINT=POSITION of joints outside the arm");
  command->add_flag("--roll", arguments->roll,
                    "an arm of six joints, for paths with path.roll, even where there are seven");
  command
      ->add_flag("--pairs", arguments->pairs,
                 "which bodies of the robot are kept apart, and how far")
      ->excludes("--srdf", "--packages", "--without", "--base", "--tip", "--hold");
  command
      ->add_option("--write", arguments->write,
                   "problem file to begin with: the arm, and a first path that it can follow")
      ->excludes("--pairs");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
