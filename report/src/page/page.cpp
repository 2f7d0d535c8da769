// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/page.hpp"

#include <filesystem>

#include "page/page_parts.hpp"
#include "page/page_template.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

using namespace detail;

bool page_available() {
  return !page_template().empty();
}

std::string to_page(const PlanView& view, const LatticeMap& map, const std::string& result_json,
                    const PageMotion& motion, const Budget& budget, const PageWords& words) {
  const PathProblem& problem = view.problem;
  const World& world = view.world;
  const Lattice& lattice = view.lattice;
  Json result = Json::parse(result_json);
  const Json& diagnosis = result["diagnosis"];
  Bodies bodies(world, problem.scene);
  if (words.visual != nullptr)
    bodies.add_visual(*words.visual, *problem.model, {{view.robot.arm()}});
  const std::vector<PageRow> found = placed(lattice, map, rows_of(lattice, view.path), view.path);
  std::vector<TrajectoryRow> shown = motion.refined ? *motion.refined : rows_of(lattice, view.path);
  Json moved = nullptr;
  if (motion.motion) {
    const std::vector<TimedRow>& samples = motion.motion->rows;
    const std::vector<double> places = places_of(samples, shown, &lattice.path_of_rows());
    moved = motion_json(samples, motion.motion->rate,
                        joint_rates(lattice.chain(), problem.limits, problem.source),
                        lattice.chain(), places);
    shown = passed_rows(std::move(shown), samples, places);
  }
  const std::vector<PageRow> rows = placed(lattice, map, shown, view.path);
  Json data = {
      {"result", result},
      {"settings", settings_json(problem, lattice)},
      {"chain", chain_json(lattice.chain())},
      {"ground", ground_json(*problem.model, view.robot.arm())},
      {"bodies", std::move(bodies.bodies)},
      {"visual", std::move(bodies.visual)},
      {"meshes", std::move(bodies.meshes)},
      {"tool_path", tool_path_json(lattice.path_of_rows())},
      {"rows", rows_json(world, lattice, rows, budget)},
      {"near", near_json(world, rows, budget)},
      {"beside", beside_json(found, rows)},
      {"motion", std::move(moved)},
      {"cut", diagnosis.is_object() ? cut_json(map, lattice, world, view.path, rows, diagnosis)
                                    : Json(nullptr)},
      {"map", map_json(map, lattice, world, view.path, rows, kMostCells, budget)}};
  return filled_page(problem.source, words, std::move(data), to_svg(map));
}

std::string detail::filled_page(const std::string& source, const PageWords& words, Json data,
                                const std::string& maps) {
  const std::string name = std::filesystem::path(source).filename().string();
  const std::string title = words.which.empty() ? name : name + ", " + words.which;
  data["problem"] = name;
  data["which"] = words.which;
  data["answer"] = words.answer;
  data["unread"] = words.unread;
  return fill(page_template(), std::move(data),
              {{"@@ANSWER@@", escaped_lines(title + "\n\n" + words.answer)}, {"@@MAP@@", maps}});
}

}  // namespace swivel
