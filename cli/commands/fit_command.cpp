// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <variant>

#include "options/commands.hpp"
#include "options/known_name.hpp"
#include "options/packages_option.hpp"
#include "swivel/core/fit/capsule_fit.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

struct FitArguments {
  std::string urdf;
  std::filesystem::path out;
  std::vector<std::string> packages, links;
  int capsules = 3;
  bool visual = false;
};

/// Returns the volume inside a closed mesh, m^3; nothing for an open one.
std::optional<double> volume_inside(const TriangleMesh& mesh) {
  if (!mesh.closed) return std::nullopt;
  double volume = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t k) {
      return mesh.vertices[static_cast<std::size_t>(triangle[k])];
    };
    volume += corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  return std::abs(volume);
}

/// Returns a mesh at `pose`, in the frame of the link that carries it.
TriangleMesh placed(const TriangleMesh& mesh, const Pose& pose) {
  TriangleMesh result = mesh;
  for (Vector3d& vertex : result.vertices) vertex = pose * vertex;
  return result;
}

[[noreturn]] void refuse(const RobotModel& robot, const FitArguments& arguments,
                         const std::map<std::string, std::filesystem::path>& packages) {
  const char* const of_links = arguments.links.empty() ? "" : " of --link";
  if (arguments.visual)
    throw InputError(robot.source,
                     std::string("no visual meshes") + of_links +
                         " on links without collision shapes: allowed is a robot that has some");
  io::ShapeSurvey shapes;
  static_cast<void>(io::load_kinematics(arguments.urdf, {}, packages, {}, shapes));
  throw InputError(robot.source,
                   std::string("no collision meshes") + of_links +
                       ": allowed is a robot that has some" +
                       (shapes.visual_meshes == 0
                            ? ""
                            : ", or --visual, which fits capsules about its visual meshes"));
}

int run(const FitArguments& arguments) {
  io::InputFiles inputs;
  const auto packages = parse_packages(arguments.packages);
  const auto robot = arguments.visual ? io::load_visual_shapes(arguments.urdf, packages)
                                      : io::load_robot(arguments.urdf, {}, packages);
  for (const std::string& name : arguments.links)
    require_known("--link", name, robot->links, "link", robot->source);
  io::OutputFiles outputs(inputs.files());
  outputs.add("--out", arguments.out);

  io::ShapesInstead instead;
  int meshes = 0, shapes = 0;
  std::string text;
  for (const Link& link : robot->links) {
    if (!arguments.links.empty() && std::find(arguments.links.begin(), arguments.links.end(),
                                              link.name) == arguments.links.end())
      continue;
    for (std::size_t k = 0; k < link.collision.size(); ++k) {
      const auto* mesh = std::get_if<MeshPtr>(&link.collision[k].shape);
      if (mesh == nullptr && !arguments.visual) continue;
      auto& of_link = instead[link.name];
      of_link.resize(link.collision.size());
      if (mesh == nullptr) continue;
      const CapsuleFit fit =
          fit_capsules(placed(**mesh, link.collision[k].pose), arguments.capsules);
      of_link[k] = fit.capsules;
      ++meshes;
      shapes += static_cast<int>(fit.capsules.size());
      char line[200];
      std::snprintf(line, sizeof line, "%-24s %7zu triangles -> %zu, %.3g l", link.name.c_str(),
                    (*mesh)->triangles.size(), fit.capsules.size(), 1e3 * fit.volume);
      text += line;
      if (const auto inside = volume_inside(**mesh)) {
        std::snprintf(line, sizeof line, " for %.3g", 1e3 * *inside);
        text += line;
      }
      std::snprintf(line, sizeof line, ", reaching up to %.1f mm further\n", 1e3 * fit.excess);
      text += line;
    }
  }
  if (meshes == 0) refuse(*robot, arguments, packages);
  char line[200];
  std::snprintf(line, sizeof line, "%d meshes: %d spheres and capsules that contain them\n", meshes,
                shapes);
  text += line;
  outputs.write("--out", io::urdf_with_shapes(
                             arguments.urdf, instead, arguments.out.parent_path(),
                             arguments.visual ? io::ShapesOf::kVisual : io::ShapesOf::kCollision));
  outputs.stage();
  if (!outputs.takes_standard_output()) say_text(text);
  flush_standard_output();
  static_cast<void>(outputs.commit());
  return kOk;
}

}  // namespace

void add_fit(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "fit", "Fit capsules about the collision meshes of a robot, a URDF that plans sooner");
  // shared, so that it lives as long as the callback that reads it
  auto arguments = std::make_shared<FitArguments>();
  command->add_option("robot", arguments->urdf, "URDF file")->required();
  command->add_option(
      "--out", arguments->out,
      "URDF file with capsules in place of meshes (as a cylinder and two spheres each)");
  command->add_option("--capsules", arguments->capsules, "at most so many for a mesh")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("--link", arguments->links, "fit these links alone");
  command->add_flag("--visual", arguments->visual,
                    "of links without collision shapes: about the visual meshes; other visual "
                    "shapes are taken as they are");
  command->add_option("--packages", arguments->packages, kPackagesHelp);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
