// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <map>
#include <memory>

#include "commands.hpp"
#include "swivel/core/arm.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/core/srs.hpp"
#include "swivel/io/io.hpp"

namespace swivel::cli {

namespace {

struct InfoArguments {
  std::string urdf, srdf, base, tip;
  std::vector<std::string> hold;
};

std::map<std::string, double> parse_hold(const std::vector<std::string>& items) {
  std::map<std::string, double> hold;
  for (const std::string& item : items) {
    const std::size_t equals = item.find('=');
    std::size_t used = 0;
    double value = 0;
    try {
      if (equals != std::string::npos) value = std::stod(item.substr(equals + 1), &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (equals == std::string::npos || used == 0 || used != item.size() - equals - 1)
      throw InputError("--hold: '" + item + "': allowed is JOINT=POSITION with a number of radians or metres");
    hold[item.substr(0, equals)] = value;
  }
  return hold;
}

/// Without --tip: the deepest link, the first in the file among equals.
std::string deepest_link(const RobotModel& robot) {
  std::string deepest;
  int most = -1;
  for (const Link& link : robot.links) {
    int joints = 0;
    for (int j = link.parent_joint; j >= 0;
         j = robot.links[static_cast<std::size_t>(robot.joints[static_cast<std::size_t>(j)].parent_link)].parent_joint)
      joints += robot.joints[static_cast<std::size_t>(j)].movable();
    if (joints > most) {
      most = joints;
      deepest = link.name;
    }
  }
  return deepest;
}

int run(const InfoArguments& arguments) {
  const auto robot = io::load_robot(arguments.urdf, arguments.srdf);
  const std::string base = arguments.base.empty() ? robot->links[static_cast<std::size_t>(robot->root_link)].name : arguments.base;
  const std::string tip = arguments.tip.empty() ? deepest_link(*robot) : arguments.tip;
  const ArmModel arm = build_arm(*robot, base, tip, parse_hold(arguments.hold), Pose::Identity());
  const SrsArm srs = fit_srs(arm.chain, robot->source);
  std::printf("robot      %s: %zu links, %zu joints\n", robot->name.c_str(), robot->links.size(), robot->joints.size());
  std::printf("arm        %s to %s\n", base.c_str(), tip.c_str());
  const bool offset = std::abs((srs.E - srs.S).normalized().dot(srs.axis[2])) < 1 - 1e-6 ||
                      std::abs((srs.W - srs.E).normalized().dot(srs.axis[4])) < 1 - 1e-6;
  std::printf("class      S-R-S%s\n", offset ? ", in-plane elbow offset" : "");
  if (srs.exact)
    std::printf("fit        exact: closed form\n");
  else
    std::printf("fit        axes within %.3f mm and %.3f mrad of the ideal arm: closed form, then Newton on the exact chain\n",
                1e3 * srs.deviation.offset, 1e3 * srs.deviation.angle);
  const auto print_point = [](const char* name, const Vector3d& p) {
    std::printf("%-10s %.6f %.6f %.6f m\n", name, p.x(), p.y(), p.z());
  };
  print_point("shoulder", srs.S);
  std::printf("lengths    shoulder-elbow %.6f m, elbow-wrist %.6f m, wrist-tip %.6f m\n", srs.upper, srs.fore,
              srs.wrist_in_tool.norm());
  std::printf("reach      shoulder-wrist %.6f to %.6f m before joint limits\n", std::abs(srs.upper - srs.fore),
              srs.upper + srs.fore);
  std::printf("straight   at joint 4 = %.6f rad (%.3f deg)\n", std::remainder(-srs.elbow_shift, kTwoPi),
              std::remainder(-srs.elbow_shift, kTwoPi) * 180 / kPi);
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = arm.chain.limit[j];
    if (limit.continuous)
      std::printf("joint %zu    %-24s continuous", j + 1, arm.chain.joint_names[j].c_str());
    else
      std::printf("joint %zu    %-24s %9.4f to %9.4f rad (%7.2f to %7.2f deg)", j + 1, arm.chain.joint_names[j].c_str(),
                  limit.lower, limit.upper, limit.lower * 180 / kPi, limit.upper * 180 / kPi);
    limit.velocity > 0 ? std::printf(", %.3f rad/s\n", limit.velocity) : std::printf(", no speed limit\n");
  }
  for (const std::string& warning : limit_warnings(arm.chain)) std::printf("warning    %s\n", warning.c_str());
  return kOk;
}

}  // namespace

void add_info(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("info", "Describe an arm: class, dimensions, limits, what was fitted");
  auto arguments = std::make_shared<InfoArguments>();  // shared: lives as long as the callback that reads it
  command->add_option("robot", arguments->urdf, "URDF file")->required();
  command->add_option("--srdf", arguments->srdf, "SRDF file");
  command->add_option("--base", arguments->base, "base link (default: the root)");
  command->add_option("--tip", arguments->tip, "tip link (default: the deepest)");
  command->add_option("--hold", arguments->hold, "JOINT=POSITION of joints outside the arm");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
