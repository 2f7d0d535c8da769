// SPDX-License-Identifier: BSD-3-Clause
// For a program that has poses: the arm of a planning group follows straight lines from where it
// stands, as far as possible, and comes back as a motion in time.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <swivel/io/io.hpp>
#include <swivel/planner/refine/cartesian_path.hpp>

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : "data/robots";
  // As a ROS system has them in robot_description and robot_description_semantic.
  const std::string urdf = text_of(folder / "iiwa14.urdf"), srdf = text_of(folder / "iiwa14.srdf");

  const auto model = swivel::io::parse_robot(urdf, srdf);
  const swivel::io::PlanningGroup group = swivel::io::planning_groups(srdf, *model).front();
  swivel::Robot robot;
  robot.model = model, robot.base_link = group.base_link, robot.tip_link = group.tip_link;

  const swivel::Config start{0, 0.6, 0, -1.5, 0, 1.0, 0};  // rad
  swivel::SceneObject post{"post", swivel::Box{{0.1, 0.1, 0.6}}};
  post.pose.translation() = swivel::Vector3d(0.6, 0.4, 0.3);
  const swivel::Quaterniond down(0, 0, 1, 0);  // w, x, y, z
  swivel::CartesianPathOptions options;
  options.max_step = 0.005;
  options.timed = true;
  const swivel::CartesianPath path = swivel::compute_cartesian_path(
      robot, {post}, {{{0.6, 0, 0.4}, down}, {{0.6, 0.5, 0.4}, down}}, start, options);

  std::cout << "fraction " << path.fraction << ", " << path.rows.size() << " rows";
  if (path.motion) std::cout << ", " << path.motion->duration << " s";
  std::cout << '\n' << path.cause << '\n';
}
