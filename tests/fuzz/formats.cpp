// SPDX-License-Identifier: BSD-3-Clause
#include "formats.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <iterator>

#include "robots.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/io/motions/trajectory.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/io/results/given_answer.hpp"
#include "swivel/io/tables/placement.hpp"
#include "swivel/io/tables/shards.hpp"

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
limits: {clearance: 0.01, manipulability: 0.01, joint_margin: 0.02, joint_step: 0.6, arm_slope: 30,
         step_error: 0.3, tool_path_error: 0.01, tool_angle_error: 0.1, tool_speed: 0.1,
         tool_turn_speed: 1, edges: continuous, edge_clearance: 0.004, edge_tolerance: 0.002}
cost: {metric: l2, weights: [1, 1, 1, 1, 1, 1, 0.5]}
vary:
  - {object: ball, xyz: [0.1, 0.1, 0.1], rpy: [0, 0, 3]}
)";

/// A job about the iiwa with all keys of jobs.
const char* const kJob = R"(robot:
  urdf: ../robots/iiwa14.urdf
  base_link: base_link
  tip_link: tool0
home: {joints: [0, 0.5, 0, 1, 0, 0.5, 0]}
approach: 0.05
retract: {xyz: [0, 0, -0.04]}
order: best
process_speed: 0.05
rapid: 0.5
strokes:
  - name: left
    path:
      waypoints: &w [{xyz: [0.5, 0, 0.4], rpy: [0, 3, 0]}, {xyz: [0.5, 0.1, 0.4], rpy: [0, 3, 0]}]
    reversible: true
  - {name: right, path: {waypoints: *w, smooth: {position: 0.001}}, approach: 0, process_speed: 0.1,
     limits: {clearance: 0.001, tool_path_error: null}}
limits: {clearance: 0.01}
)";

std::string data(const std::string& name) {
  return TempFolder::read(data_dir() / name);
}

void prepare(const TempFolder& folder) {
  for (const char* name : {"robots", "meshes", "paths"})
    fs::create_directory_symlink(data_dir() / name, folder.path() / name);
  folder.write("problems/box.stl", io::test::box_stl());
  folder.write("problems/good.yaml", kProblem);
}

namespace {

std::string first_lines(std::string text, int lines) {
  std::size_t end = 0;
  while (lines-- > 0 && end < text.size())
    end = std::min(text.find('\n', end), text.size() - 1) + 1;
  return text.substr(0, end);
}

const char* const kDae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="mm" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="15">0 0 0 1 0 0 0 0 2 0 3 0 1 1 1</float_array>
<technique_common><accessor source="#pa" count="5" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 1 2 3</p></triangles>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="1"/>
<input semantic="NORMAL" source="#p" offset="0"/><vcount>3 4</vcount>
<p>0 0 0 1 0 2 0 0 0 1 0 4 0 3</p></polylist>
<polygons count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 4 2 3</p></polygons>
<tristrips count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3 4</p></tristrips>
<trifans count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3 4</p></trifans>
</mesh></geometry></library_geometries>
<library_controllers><controller id="c"><skin source="#g"/></controller></library_controllers>
<library_nodes><node id="m"><scale>1 2 3</scale><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="s"><node id="n">
<matrix>1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1</matrix><rotate>0 0 1 90</rotate>
<translate>1 2 3</translate>
<instance_geometry url="#g"/><instance_controller url="#c"/><instance_node url="#m"/><node>
<instance_geometry url="#g"/></node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";

/// A cut of an APT file between rapid moves, with all statements that are read.
const char* const kApt = R"($$ written by hand
PARTNO / part
UNITS/MM
MULTAX/ON
TLAXIS/0,0,1
LOADTL/1
SPINDL/2000,RPM,CLW
FROM/0,0,100
RAPID
GOTO/10,0,50,0,0,1
FEDRAT/300.0,MMPM
GOTO/10.0,0.0,5.0
GOTO/20.0,1.5E+00,5.25, $
0.1,0,0.9949874
FEDRAT/40,IPM
GOTO / -30.5 , +2. , .5 , 0.2, -0.1, 0.9746794
MULTAX/OFF
GOTO/40,2,1
RAPID
GOTO/40,2,90
GOHOME
FINI
)";
/// An APT file with notes in comments that go on in the next line.
const char* const kNotes =
    "$$* CL file\n$$-> CSYS / 1, 0, $\n0, 1, 0, $\n0\nUNITS / INCHES\nGOTO / 1, 2, $\n 3, 0, 0, "
    "1\nGOTO / 2, 2, 3, 0, 1, 1 $$ aside\nCUTCOM / OFF\nORIGIN / 0, 0, 0\n";

std::string bytes(const void* data, std::size_t size) {
  return {static_cast<const char*>(data), size};
}

std::string binary_stl() {
  std::string text(80, 'h');
  const std::uint32_t count = 4;
  text += bytes(&count, 4);
  const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, normal[3] = {0, 0, 0};
  for (const auto& face : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
    text += bytes(normal, 12);
    for (const int corner : face) text += bytes(corners[corner], 12);
    text += bytes("\0\0", 2);
  }
  return text;
}

const char* const kPly =
    "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float "
    "y\nproperty float z\nproperty uchar "
    "red\nelement face 3\n"
    "property list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nproperty int "
    "vertex2\nend_header\n"
    "0 0 0 1\n0.1 0 0 2\n0 0.1 0 3\n0 0 0.1 4\n3 0 2 1\n3 0 1 3\n4 1 2 3 0\n0 1\n";

std::string binary_ply(bool big) {
  std::string text = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                     "_endian 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty "
                     "short z\nelement face "
                     "2\nproperty list uchar int vertex_index\nend_header\n";
  const auto put = [&](auto value) {
    std::string raw = bytes(&value, sizeof value);
    if (big) std::reverse(raw.begin(), raw.end());
    text += raw;
  };
  for (int k = 0; k < 3; ++k) {
    put(static_cast<float>(k == 1));
    put(static_cast<double>(k == 2));
    put(static_cast<std::int16_t>(k));
  }
  for (int face = 0; face < 2; ++face) {
    put(static_cast<std::uint8_t>(3));
    for (std::int32_t k = 0; k < 3; ++k) put((k + face) % 3);
  }
  return text;
}

const char* const kObj =
    "# c\nmtllib m.mtl\no box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.4 0.5 0 1\nvt 0 0\nvn 0 0 "
    "1\nusemtl m\ns off\nf 1/1/1 2/1/1 "
    "3/1/1 4/1/1\n"
    "f -5 -4 \\\n -3 -1 -2\nf 1//1 2//1 3//1\nl 1 2\np 1\n";

/// Returns a reader's call: it writes a text into the file `name` of the folder, which it keeps a
/// reference to, and passes the file's path to `call`.
template <class Call>
std::function<void(const std::string&)> at(const TempFolder& folder, const char* name, Call call) {
  return [&folder, name, call](const std::string& text) { call(folder.write(name, text)); };
}

/// Returns the readers of problems, robots and tool paths.
std::vector<Reader> problem_readers(const TempFolder& folder) {
  std::vector<Reader> all;
  all.push_back(
      {"problem",
       {kProblem, data("problems/experiment_a_start.yaml"), data("problems/experiment_b.yaml"),
        kJob, data("problems/sda10f_plate_workcell.yaml")},
       kYamlWords,
       at(folder, "problems/p.yaml", [](const fs::path& file) { (void)io::load_problem(file); })});
  all.push_back(
      {"urdf",
       {io::test::arm_urdf(), data("robots/iiwa14.urdf")},
       kXmlWords,
       at(folder, "robot.urdf", [](const fs::path& file) { (void)io::load_robot(file); })});
  all.push_back({"srdf",
                 {data("robots/iiwa14.srdf"),
                  "<robot name='a'><disable_default_collisions link='link_1'/><enable_collisions "
                  "link1='link_1' link2='link_2'/></robot>"},
                 kXmlWords,
                 at(folder, "robot.srdf", [](const fs::path& file) {
                   const auto robot = io::load_robot(data_dir() / "robots" / "iiwa14.urdf", file);
                   (void)io::planning_groups(TempFolder::read(file), *robot);
                 })});
  all.push_back(
      {"path",
       {first_lines(data("paths/door_polish.csv"), 30),
        "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n1,0,0,1,0,0,0\n"},
       {",", ",,", "\n", "0,0,0,1,0,0,0\n", "\"", ";", "\t", " ", "\r", "0,5", "#", "sep=;",
        "x;y;z;nx;ny;nz\n", "x y z i j k\n", "tx,ty,tz", "feed [mm/min]", "X (mm)"},
       at(folder, "path.csv", [](const fs::path& file) { (void)io::load_path(file); })});
  all.push_back({"apt",
                 {kApt, kNotes},
                 {",", "/", "$", "$$", "$$->", "\n", "$\n", "GOTO/1,2,3\n", "GOTO/1,2,3,0,0,-1\n",
                  "RAPID\n", "FEDRAT/MMPM,1e300\n", "UNITS/INCHES\n", "MULTAX/OFF\n", "FINI\n",
                  "CIRCLE/0,0,0\n", "TLAXIS/0,0,0\n", "PPRINT ", "1e999", "FROM/"},
                 at(folder, "path.apt", [](const fs::path& file) { (void)io::load_path(file); })});
  return all;
}

/// Returns a plan of five rows for joints of these names.
PlanResult short_plan(const io::JointNames& joints) {
  PlanResult result;
  result.joint_names = joints;
  for (int k = 0; k < 5; ++k)
    result.trajectory.push_back({0.1 * k, 0.2, k, Config::Constant(0.1 * k)});
  return result;
}

/// Returns a motion along the rows of a plan, one row every 0.1 s.
TimedPath motion_along(const PlanResult& plan) {
  TimedPath motion;
  for (int k = 0; k < 5; ++k)
    motion.rows.push_back({0.1 * k, plan.trajectory[static_cast<std::size_t>(k)],
                           Config::Constant(1), Config::Constant(0.1 * k)});
  return motion;
}

/// Returns the readers of trajectories and motions in every format.
std::vector<Reader> motion_readers(const TempFolder& folder) {
  const io::JointNames joints{"a", "b", "c", "d", "e", "f", "g,\"h\""};
  const auto at_motion = [&](const char* file) {
    return at(folder, file,
              [joints](const fs::path& path) { (void)io::load_trajectory_file(path, joints); });
  };
  const PlanResult result = short_plan(joints);
  io::write_trajectory(folder.path() / "good.csv", result);
  std::vector<Reader> all;
  all.push_back({"trajectory",
                 {TempFolder::read(folder.path() / "good.csv")},
                 {",", "\"", "\n", "1e9,"},
                 at_motion("trajectory.csv")});
  const TimedPath motion = motion_along(result);
  const std::string timed = io::to_timed_csv(motion, joints);
  all.push_back({"motion",
                 {timed, TempFolder::read(folder.path() / "good.csv")},
                 {",", "\"", "\n", "1e9,", first_lines(timed, 1)},
                 at_motion("motion.csv")});
  const auto message = [&](const char* name, const char* file, std::string seed,
                           std::vector<std::string> words) {
    all.push_back({name, {std::move(seed)}, std::move(words), at_motion(file)});
  };
  // What is changed in the frame's name is read as before.
  const std::string frame(2000, 'x');
  message("motion_json", "motion.json", io::to_trajectory_json(motion, joints, frame),
          {"0", "1e999", "[", "]", "{", "}", ",", "null", "-1", "\"positions\": [",
           "\"sec\": 2147483647", "\"nanosec\": 999999999"});
  std::vector<std::string> yaml_words = kYamlWords;
  yaml_words.insert(yaml_words.end(), {"positions: [", "- positions: [1, 2]\n", "sec: 2147483647",
                                       "nanosec: 999999999", ".nan"});
  message("motion_yaml", "motion.yaml", io::to_trajectory_yaml(motion, joints, frame), yaml_words);
  const auto little_endian = [](std::uint64_t value, std::size_t size) {
    return bytes(&value, size);
  };
  message("mcap", "motion.mcap", io::to_mcap(motion, joints, frame),
          {little_endian(0, 8), little_endian(1, 2), little_endian(7, 4),
           little_endian(~std::uint64_t{0}, 8), little_endian(0x7FFFFFFF, 4), "\x03", "\x04",
           "\x05", "\x06", "\x0F", "cdr", "zstd", "sensor_msgs/msg/JointState"});
  return all;
}

/// Returns the reader of the rows of a job of two strokes, with times and without.
Reader job_reader(const TempFolder& folder) {
  const io::JointNames joints{"a", "b", "c", "d", "e", "f", "g"};
  Problem job;
  job.arm().lift.emplace();
  ArmMotion motion;
  PlanResult rows = short_plan(joints);
  Answer result;
  result.arm().joint_names = joints;
  for (std::size_t part = 0; part < 3; ++part) {
    Part& made = result.arm().parts.emplace_back();
    made.rows = rows.trajectory;
    if (part % 2 == 0) {
      Stroke& stroke = job.arm().strokes.emplace_back();
      stroke.name = part == 0 ? "left" : "right";
      stroke.waypoints.resize(2);
      stroke.waypoints[1].position.x() = 0.4;
      made.run = StrokeRun{part / 2, false};
    }
    for (const TrajectoryRow& row : rows.trajectory) {
      motion.rows.push_back({0.1 * static_cast<double>(motion.rows.size()), row});
      motion.part.push_back(part);
    }
    const std::vector<TimedRow>& timed = motion.rows;
    if (part % 2 == 1) continue;
    motion.events.push_back({timed[timed.size() - 4].t, part / 2, 0.1, true});
    motion.events.push_back({timed[timed.size() - 2].t, part / 2, 0.3, false});
  }
  Motion all;
  all.arms.push_back(motion);
  const auto text = [&](const char* name) {
    return io::test::text_of_motion(all, job, {joints}, name);
  };
  return {
      "job_rows",
      {io::to_csv(result, job), text("m.csv"), text("m.json"), text("m.yaml"), text("m.mcap")},
      {",", "\"", "\n", "1e9,", ",left,1\n", ",right,0\n", ",left/1,1\n", ",left/2,1\n", ",,0\n",
       "\"run\": {", "\"left/1\"", "\"events\": [", "{", "}", "[", "]", "null", "\"off\""},
      at(folder, "job.csv",
         [joints, job](const fs::path& path) { (void)io::load_answer(path, job, {joints}); })};
}

/// Returns the reader of the rows of two arms.
Reader workcell_reader(const TempFolder& folder) {
  const std::array<std::string, 2> names{"left", "right"};
  const std::array<io::JointNames, 2> joints{io::JointNames{"a", "b", "c", "d", "e", "f", "g"},
                                             io::JointNames{"h", "i", "j", "k", "l", "m", "n"}};
  Answer result;
  result.arms.clear();
  Motion motion;
  for (std::size_t k = 0; k < 2; ++k) {
    motion.arms.emplace_back().name = names[k];
    result.arms.push_back(answer_of(short_plan(joints[k])).arm());
    result.arms[k].name = names[k];
    for (const TrajectoryRow& row : result.arms[k].rows()) {
      TimedRow& timed = motion.arms[k].rows.emplace_back();
      timed.t = 0.004 * static_cast<double>(motion.arms[k].rows.size() - 1);
      timed.row = row;
    }
  }
  Problem cell = two_arms();
  for (std::size_t k = 0; k < 2; ++k) cell.arms[k].name = names[k];
  const std::vector<io::JointNames> of_arms(joints.begin(), joints.end());
  const auto text = [&](const char* name) {
    return io::test::text_of_motion(motion, cell, of_arms, name);
  };
  return {"workcell_rows",
          {io::to_csv(result, cell), text("m.csv"), text("m.json"), text("m.yaml"), text("m.mcap")},
          {",", "\"", "\n", "1e9,", ",8,", ",0.5,", "branch_left", "t,", "0.004,"},
          at(folder, "cell.csv", [cell, of_arms](const fs::path& path) {
            (void)io::load_answer(path, cell, of_arms);
          })};
}

/// Returns the reader of MoveIt's limits of the joints of the iiwa.
Reader joint_limits_reader(const TempFolder& folder) {
  return {"joint_limits",
          {R"(default_velocity_scaling_factor: 0.1
joint_limits:
  joint_a1: {has_velocity_limits: true, max_velocity: 1.2, has_acceleration_limits: true,
             max_acceleration: 3, max_jerk: 40}
  joint_a2: {has_position_limits: true, min_position: -1, max_position: 1.5, max_deceleration: 2}
)"},
          kYamlWords,
          at(folder, "joint_limits.yaml", [](const fs::path& path) {
            io::RobotOptions options;
            options.joint_limits = path;
            (void)io::load_robot(data_dir() / "robots/iiwa14.urdf", {}, {}, options);
          })};
}

/// Returns the reader of a campaign that was broken off, of 100 episodes with these settings.
Reader campaign_reader(const TempFolder& folder, const io::RunSettings& settings) {
  {
    io::CampaignFile part(folder.path() / "good_results.csv", settings, {}, 100);
    EpisodeRow row;
    row.status = PlanStatus::kSolved;
    row.cost = 1.5;
    part.append(row);
    row = {};
    for (const char* reason : {"a \"b\", c", "joint step"}) {
      ++row.episode;
      row.failed_s = 0.25;
      row.reason = reason;
      part.append(row);
    }
  }
  return {"campaign",
          {TempFolder::read(folder.path() / "good_results.csv.part")},
          {",", "\"", "\n", "0,solved,", "{", "}", "# swivel campaign "},
          at(folder, "results.csv.part", [&folder, settings](const fs::path&) {
            (void)io::CampaignFile(folder.path() / "results.csv", settings, {}, 100);
          })};
}

/// Returns the reader of shards, of a campaign and of a table of places.
Reader shard_reader(const TempFolder& folder, const io::RunSettings& settings) {
  const auto shard = [&](const char* command, std::uint64_t total) {
    return io::to_line({command, settings, {}, total, "p.yaml", "swivel plan p.yaml"});
  };
  const std::string long_text(1000, 'x');  // what is changed in a text is read as before
  PlacementRow cell;
  cell.by = long_text;
  return {
      "shard",
      {shard("campaign", 2) +
           io::to_csv(std::vector{EpisodeRow(0, "a \"b\", c"), EpisodeRow(1, long_text)}, {}),
       shard("place", 1) + io::to_csv(std::vector{cell})},
      {",", "\"", "\n", "1,solved,", "{", "}", "# swivel place ", "1/2", "18446744073709551615"},
      at(folder, "shard.csv",
         [](const fs::path& file) { (void)io::join_shards({io::load_shard(file)}); })};
}

/// Returns the reader of certificates that a problem has no path.
Reader certificate_reader(const TempFolder& folder) {
  InfeasibilityCertificate certificate;
  certificate.layers = 99;
  certificate.first_layer = 3;
  certificate.windings = {{false, true}};
  certificate.witnesses.resize(2);
  certificate.witnesses[0].kind = Cause::Kind::kLimit;
  certificate.witnesses[0].joint = "a";
  certificate.witnesses[0].side = Cause::Side::kLower;
  certificate.witnesses[1].kind = Cause::Kind::kPair;
  certificate.witnesses[1].bodies = {"b", "c"};
  certificate.band = {{8, {{0, 3}}, {{{4, 7}, 0}}, {}},
                      {8, {}, {{{0, 5}, 1}}, {{{0, 3}, {6, 7}, 1, 8}}}};
  for (int k = 0; k < 60; ++k)
    certificate.band.insert(certificate.band.begin() + 1, {1008,
                                                           {{k, k + 20}, {700, 900}},
                                                           {{{100, 200 + k}, k % 2}},
                                                           {{{5, 7}, {300, 310 + k}, 1, k}}});
  std::string noted = io::to_json(certificate);  // what changes white space is read as before
  noted.insert(1, std::string(2 * noted.size(), ' '));
  return {"certificate",
          {io::to_json(certificate), noted},
          {"0", "1", "[", "]", "null", "-1", "1e999", "\"limit\"", "[0,1,2],", "\"layers\":["},
          at(folder, "certificate.json",
             [](const fs::path& file) { (void)io::load_certificate(file); })};
}

/// Returns the reader of certificates that a workcell has no plan.
Reader workcell_certificate_reader(const TempFolder& folder) {
  WorkcellCertificate certificate;
  certificate.layers = 9;
  certificate.windings[1] = {{false, true}};
  certificate.tree.resize(5);
  certificate.tree[0].region = {{2, {"a", "b"}, {{{{0, 3}, {5, 5}}, {{1, 2}}}}, {}}};
  certificate.tree[1].region = {{4, {}, {}, {{{{0, 3}}, {{7, 6}, {7, 7}}}}}};
  for (int k = 1; k < 5; ++k) {
    WorkcellCertificate::Branch& set = certificate.tree[static_cast<std::size_t>(k)];
    set.parent = k < 3 ? 0 : 1;
    set.arm = 1 - k % 2;
    if (k == 1) continue;
    set.arm_without_path = set.arm;
    set.cut.first_layer = 3;
    set.cut.witnesses.resize(1);
    set.cut.witnesses[0].kind = Cause::Kind::kReach;
    set.cut.band = {{8, {{0, 3}}, {{{4, 7}, 0}}, {}},
                    {8, {}, {{{0, 5}, 1}}, {{{0, 3}, {6, 7}, 1, 8}}}};
  }
  return {"workcell_certificate",
          {io::to_json(certificate)},
          {"0", "1", "[", "]", "null", "-1", "1e999", "[0,1],", "\"moves\":", "\"sets\":["},
          at(folder, "proof.json",
             [](const fs::path& file) { (void)io::load_workcell_certificate(file); })};
}

/// Returns the readers of meshes.
std::vector<Reader> mesh_readers(const TempFolder& folder) {
  const auto mesh = [](const fs::path& file) {
    io::MeshCache cache;
    (void)io::load_mesh(file, Vector3d::Ones(), cache);
  };
  std::vector<Reader> all;
  all.push_back({"stl",
                 {io::test::box_stl(), binary_stl(), "solid a\nendsolid a\n" + io::test::box_stl()},
                 {"solid x\n", "facet normal 0 0 0\n", "outer loop\n", "vertex 1 2 3\n",
                  "endloop\n", "endfacet\n", "endsolid\n"},
                 at(folder, "a.stl", mesh)});
  all.push_back({"obj",
                 {kObj},
                 {"f 1 2 3\n", "v 1 2 3\n", " 1", " -1", "/", "\\\n", "f"},
                 at(folder, "a.obj", mesh)});
  all.push_back(
      {"ply",
       {kPly, binary_ply(false), binary_ply(true)},
       {"element face 1000\n", "element vertex 1\n", "property list uchar int vertex_indices\n",
        "property double x\n", "end_header\n", "comment ", "3 0 1 2\n"},
       at(folder, "a.ply", mesh)});
  all.push_back({"dae", {kDae}, kXmlWords, at(folder, "a.dae", mesh)});
  return all;
}

}  // namespace

std::vector<Reader> readers(const TempFolder& folder) {
  std::vector<Reader> all = problem_readers(folder);
  std::ranges::move(motion_readers(folder), std::back_inserter(all));
  all.push_back(job_reader(folder));
  all.push_back(workcell_reader(folder));
  all.push_back(joint_limits_reader(folder));
  const io::RunSettings settings{{{"seed", "1"}, {"planner", "lazy"}},
                                 {{"arm.urdf", 0x0123456789abcdef}}};
  all.push_back(campaign_reader(folder, settings));
  all.push_back(shard_reader(folder, settings));
  all.push_back(certificate_reader(folder));
  all.push_back(workcell_certificate_reader(folder));
  std::ranges::move(mesh_readers(folder), std::back_inserter(all));
  return all;
}

}  // namespace swivel::test
