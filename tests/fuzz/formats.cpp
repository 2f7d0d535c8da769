// SPDX-License-Identifier: BSD-3-Clause
#include "formats.hpp"

#include <cstdlib>

#include "mutator.hpp"
#include "robots.hpp"

namespace swivel::test {

namespace fs = std::filesystem;

const std::vector<std::string> kXmlWords{"<a>",
                                         "</a>",
                                         "<link name='x'>",
                                         "<joint name='j' type='fixed'>",
                                         "<node>",
                                         "<node id='n'>",
                                         "<p>",
                                         "<!DOCTYPE x [",
                                         "<?xml ",
                                         "<collision>",
                                         "<origin xyz='1 2 3' rpy='0 0 0'/>",
                                         "<mimic joint='joint_2'/>",
                                         "<sphere radius='1'/>",
                                         "<mesh filename='x.stl'/>",
                                         "<limit lower='-1e16' upper='1e16'/>",
                                         " name=''",
                                         " a='b'",
                                         "<instance_node url='#n'/>",
                                         "<instance_geometry url='#g'/>",
                                         "<disable_default_collisions link='link_1'/>"};
const std::vector<std::string> kYamlWords{"[",
                                          "{",
                                          "{a: ",
                                          "[{",
                                          "- ",
                                          "? ",
                                          ": ",
                                          "&a ",
                                          "*a",
                                          "<<: *a",
                                          "!!binary ",
                                          "!t ",
                                          "|\n",
                                          ">\n",
                                          "---\n",
                                          "...\n",
                                          "\"",
                                          "#",
                                          "  ",
                                          "scene:\n",
                                          "limits: {joint_step: 0.001}\n",
                                          "- {name: x, sphere: 0.1}\n",
                                          "- {name: y, mesh: box.stl, scale: 1000}\n",
                                          "allow: [link_7]",
                                          "quat: [0, 0, 0, 1]"};

const char* const kProblem = R"(robot:
  urdf: ../robots/iiwa14.urdf
  srdf: ../robots/iiwa14.srdf
  base_link: base_link
  tip_link: tool0
  tool: {xyz: [0, 0, 0.05], rpy: [0, 0.1, 0]}
  attached:
    - {name: probe, capsule: {radius: 0.02, length: 0.1}, xyz: [0, 0, 0.06], link: tool0}
path:
  frame: table
  waypoints: &w
    - {xyz: [0.1, 0, 0.35], rpy: [0, 3.0, 0]}
    - {xyz: [0.1, 0.1, 0.35], quat: [0.0707, 0, 0.9975, 0]}
scene:
  - {name: table, box: [0.6, 0.6, 0.1], xyz: [0.5, 0, 0.2]}
  - {name: ball, sphere: {radius: 0.1}, xyz: [0.5, 0.5, 0.5], allow: [link_7, probe]}
  - {name: post, cylinder: {radius: 0.05, length: 1}, xyz: [0.2, -0.6, 0.5]}
  - {name: crate, mesh: box.stl, scale: [0.1, 0.1, 0.1], xyz: [0.9, 0, 0.2], rpy: [0, 0, 0.3]}
resolution: {ds: 0.02, dphi: 0.3, dalpha: 0.2}
limits: {clearance: 0.01, manipulability: 0.01, joint_margin: 0.02, joint_step: 0.6, arm_slope: 30, step_error: 0.3,
         tool_path_error: 0.01, tool_angle_error: 0.1, tool_speed: 0.1, tool_turn_speed: 1, edges: continuous, edge_clearance: 0.004, edge_tolerance: 0.002}
cost: {metric: l2, weights: [1, 1, 1, 1, 1, 1, 0.5]}
vary:
  - {object: ball, xyz: [0.1, 0.1, 0.1], rpy: [0, 0, 3]}
)";

std::string data(const std::string& name) {
  return TempFolder::read(data_dir() / name);
}

void prepare(const TempFolder& folder) {
  for (const char* name : {"robots", "meshes", "paths"}) fs::create_directory_symlink(data_dir() / name, folder.path() / name);
  folder.write("problems/box.stl", io::test::box_stl());
  folder.write("problems/good.yaml", kProblem);
}

void fuzz(const char* name, const std::vector<Reader>& readers, int inputs, bool mild) {
  const std::uint64_t first = seed(name);
  const char* const keep = std::getenv("SWIVEL_FUZZ_KEEP");
  for (const Reader& reader : readers) {
    for (const std::string& good : reader.seeds) EXPECT_NO_THROW(reader.read(good)) << reader.name << ": " << good;
    const Mutator mutator(reader.seeds, reader.words, mild);
    const auto input = [&](int k) { return mutator.input(first * 1'000'003 + static_cast<std::uint64_t>(k)); };
    const int count = inputs / static_cast<int>(readers.size());
    const Tally tally = watch(count, kAllowance, [&](int k) { reader.read(input(k)); });
    std::printf("%s: %d inputs, %d read, %d refused, %zu findings\n", reader.name, count, tally.accepted, tally.refused,
                tally.findings.size());
    EXPECT_GT(tally.accepted, count / 20);
    EXPECT_GT(tally.refused, count / 20);
    for (const Finding& finding : tally.findings) {
      ADD_FAILURE() << reader.name << ", input " << finding.input << ": " << finding.what;
      if (keep != nullptr)
        std::ofstream(fs::path(keep) / (reader.name + std::to_string(finding.input)), std::ios::binary) << input(finding.input);
    }
  }
}

}  // namespace swivel::test
