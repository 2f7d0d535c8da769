// SPDX-License-Identifier: BSD-3-Clause
// Problems written as files: changes of the file that they come from, and whole ones.
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <functional>

#include "problem_support.hpp"
#include "seed.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/meshes/mesh.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io::test {
namespace {

using Change = std::function<void(PathProblem&)>;

const char* const kFile =
    "# A weld, häßlich.\n"
    "robot:\n"
    "  urdf: ../robots/arm.urdf   # the arm\n"
    "  base_link: base_link\n"
    "  tip_link: link_7\n"
    "path:\n"
    "  file: weld.csv  # in metres\n"
    "  units: m\n"
    "# what stands around\n"
    "scene:\n"
    "  - {name: post, sphere: 0.1, xyz: [0.1, 0.2, 0.3], allow: [link_7]}  # a post\n"
    "  # the part\n"
    "  - name: part     # of steel\n"
    "    box: [0.1, 0.2, 0.3]\n"
    "    quat: [0.5, 0.5, 0.5, 0.5]\n"
    "    xyz:\n"
    "      - 0.7  # across\n"
    "      - 0.2\n"
    "      - 0.9\n"
    "limits: {clearance: 0.005, joint_step: 0.4}  # m, rad\n"
    "resolution:\n"
    "  ds: 0.01  # m\n";

/// Returns a text with a part replaced that it has once.
std::string with(std::string text, const std::string& part, const std::string& now) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  EXPECT_EQ(text.find(part, at + 1), std::string::npos) << part;
  return at == std::string::npos ? text : text.replace(at, part.size(), now);
}

void expect_equal(const PathProblem& a, const PathProblem& b) {
  EXPECT_TRUE(static_cast<const Task&>(a) == static_cast<const Task&>(b));
  EXPECT_EQ(a.hold, b.hold);
  EXPECT_EQ(a.roll, b.roll);
  EXPECT_LE((a.tool.matrix() - b.tool.matrix()).cwiseAbs().maxCoeff(), 4e-15);
  ASSERT_EQ(a.scene.size(), b.scene.size());
  for (std::size_t k = 0; k < a.scene.size(); ++k) {
    EXPECT_EQ(a.scene[k].name, b.scene[k].name);
    EXPECT_EQ(a.scene[k].allow, b.scene[k].allow);
    EXPECT_EQ(a.scene[k].shape.index(), b.scene[k].shape.index());
    EXPECT_EQ(a.scene[k].pose.translation(), b.scene[k].pose.translation());
    EXPECT_LE((a.scene[k].pose.matrix() - b.scene[k].pose.matrix()).cwiseAbs().maxCoeff(), 4e-15);
  }
  ASSERT_EQ(a.attached.size(), b.attached.size());
}

/// Returns the text of a file after a change of the problem that it has, and expects it to be read
/// as that problem.
std::string changed(const ProblemFolder& folder, const std::string& text, const Change& change,
                    const std::string& target = "problems/saved.yaml") {
  const fs::path file = folder.folder().write("problems/problem.yaml", text),
                 saved = folder.folder().path() / target;
  fs::create_directories(saved.parent_path());
  PathProblem problem = load_path_problem(file);
  change(problem);
  save_problem(problem, saved);
  expect_equal(load_path_problem(saved), problem);
  return TempFolder::read(saved);
}

/// A change, and the part of the file that it turns into another.
struct Case {
  Change change;
  std::string part, now;
};

void expect_changes(const std::vector<Case>& cases) {
  const ProblemFolder folder;
  for (const Case& one : cases)
    EXPECT_EQ(changed(folder, kFile, one.change), with(kFile, one.part, one.now));
  std::printf("%zu changes\n", cases.size());
}

TEST(SavedProblems, ChangeOnlyWhatChangedOfTheTask) {
  expect_changes({
      {[](PathProblem&) {}, "# A weld", "# A weld"},
      {[](PathProblem& p) { p.limits.clearance = 0.01; }, "clearance: 0.005", "clearance: 0.01"},
      {[](PathProblem& p) { p.limits.edge_clearance = 0.001; }, "0.005, ",
       "0.005, edge_clearance: 0.001, "},
      {[](PathProblem& p) { p.limits.tool_path_error.reset(); }, "0.4}",
       "0.4, tool_path_error: null}"},
      {[](PathProblem& p) { p.resolution.dphi = 0.02; }, "# m\n", "# m\n  dphi: 0.02\n"},
      {[](PathProblem& p) { p.resolution.ds = 0.005; }, "ds: 0.01  #", "ds: 0.005  #"},
      {[](PathProblem& p) { p.cost.metric = CostMetric::kMax; }, "# m, rad\n",
       "# m, rad\ncost: {metric: max}\n"},
      {[](PathProblem& p) { p.start = Config::Constant(0.5); }, "# m, rad\n",
       "# m, rad\nstart: {joints: [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5]}\n"},
      {[](PathProblem& p) {
         p.smooth = PathSmoothing{0.001, 0.5};
       },
       "units: m\n", "units: m\n  smooth: {position: 0.001, angle: 0.5}\n"},
  });
}

TEST(SavedProblems, ChangeOnlyWhatChangedOfBodies) {
  expect_changes({
      {[](PathProblem& p) { p.tool.translation().z() = 0.25; }, "tip_link: link_7\n",
       "tip_link: link_7\n  tool: {xyz: [0, 0, 0.25]}\n"},
      {[](PathProblem& p) {
         p.attached.push_back({"nozzle", Sphere{0.01}, p.tool, "link_7"});
       },
       "tip_link: link_7\n",
       "tip_link: link_7\n  attached:\n    - {name: nozzle, sphere: 0.01, link: link_7}\n"},
      {[](PathProblem& p) { p.scene[1].pose.translation().y() = 0.25; }, "- 0.2\n", "- 0.25\n"},
      {[](PathProblem& p) {
         p.scene[1].pose.linear() = rotation_from_rpy({0, 0, 0.5});
       },
       "quat: [0.5, 0.5, 0.5, 0.5]", "rpy: [0, 0, 0.5]"},
      {[](PathProblem& p) { p.scene[1].pose.linear().setIdentity(); },
       "    quat: [0.5, 0.5, 0.5, 0.5]\n", ""},
      {[](PathProblem& p) {
         p.scene[0].shape = Cylinder{0.1, 0.5};
       },
       "sphere: 0.1", "cylinder: {radius: 0.1, length: 0.5}"},
      {[](PathProblem& p) {
         p.scene[0].allow = {{"link_6", 0.001}};
       },
       "[link_7]", "{link_6: 0.001}"},
      {[](PathProblem& p) { p.scene[0].allow.clear(); }, ", allow: [link_7]", ""},
      {[](PathProblem& p) { p.scene.erase(p.scene.begin()); },
       "  - {name: post, sphere: 0.1, xyz: [0.1, 0.2, 0.3], allow: [link_7]}  # a post\n", ""},
      {[](PathProblem& p) {
         p.scene.push_back({"cup", Box{{1, 1, 1}}, p.tool, {}});
       },
       "- 0.9\n", "- 0.9\n  - {name: cup, box: [1, 1, 1]}\n"},
      {[](PathProblem& p) {
         p.scene.insert(p.scene.begin(), {"cup", Sphere{1}, p.tool, {}});
       },
       "  - {name: post", "  - {name: cup, sphere: 1}\n  - {name: post"},
      {[](PathProblem& p) { p.waypoints[1].position.z() = 0.5; },
       "  file: weld.csv  # in metres\n  units: m\n",
       "  waypoints:\n    - {xyz: [0, 0, 0], quat: [1, 0, 0, 0]}\n    - {xyz: [1, 0, 0.5], quat: "
       "[1, 0, 0, 0]}  # in metres\n"},
  });
}

TEST(SavedProblems, KeepLineEndsAndByteOrderMarks) {
  const ProblemFolder folder;
  std::string text = "\xef\xbb\xbf";
  for (const char* c = kFile; *c != 0; ++c)
    text += *c == '\n' ? std::string("\r\n") : std::string(1, *c);
  EXPECT_EQ(changed(folder, text, [](PathProblem& p) { p.resolution.dphi = 0.02; }),
            with(text, "# m\r\n", "# m\r\n  dphi: 0.02\r\n"));
  EXPECT_EQ(changed(folder, text, [](PathProblem& p) { p.limits.joint_step = 0.3; }),
            with(text, "joint_step: 0.4", "joint_step: 0.3"));
}

TEST(SavedProblems, ItemsThatMoveToAnotherPlaceAreWrittenAnew) {
  const ProblemFolder folder;
  const std::string text = changed(folder, kFile, [](PathProblem& p) {
    std::rotate(p.scene.begin(), p.scene.begin() + 1, p.scene.end());
  });
  EXPECT_NE(
      text.find("- 0.9\n  - {name: post, sphere: 0.1, xyz: [0.1, 0.2, 0.3], allow: [link_7]}\n"),
      std::string::npos)
      << text;
  EXPECT_NE(text.find("# across"), std::string::npos);
}

TEST(SavedProblems, ABodyThatIsTakenUpStaysWhereTheFileHasIt) {
  const ProblemFolder folder;
  const std::string text = changed(folder, kFile, [](PathProblem& p) {
    p.scene.erase(p.scene.begin());
    p.attached.push_back({"post", Sphere{0.1}, Pose(Eigen::Translation3d(0, 0, 0.1)), "link_7"});
  });
  EXPECT_NE(text.find("{name: post, sphere: 0.1, xyz: [0, 0, 0.1], frame: link_7}  # a post"),
            std::string::npos)
      << text;
}

TEST(SavedProblems, NamesOfFilesFollowTheFile) {
  const ProblemFolder folder;
  const std::string text = changed(
      folder, kFile, [](PathProblem& p) { p.resolution.ds = 0.02; }, "a/b/saved.yaml");
  std::string expected = with(kFile, "../robots/arm.urdf ", "../../robots/arm.urdf ");
  expected = with(expected, "weld.csv", "../../problems/weld.csv");
  EXPECT_EQ(text, with(expected, "ds: 0.01", "ds: 0.02"));
  // Again, from there to the first folder.
  PathProblem problem = load_path_problem(folder.folder().path() / "a/b/saved.yaml");
  save_problem(problem, folder.folder().path() / "problems/back.yaml");
  EXPECT_EQ(TempFolder::read(folder.folder().path() / "problems/back.yaml"),
            with(kFile, "ds: 0.01", "ds: 0.02"));
}

TEST(SavedProblems, WholeOnesHaveNoDefaults) {
  const ProblemFolder folder;
  PathProblem problem = folder.load(
      {{"robot", robot_with("srdf: ../robots/arm.srdf, hold: {finger_joint: 0.01}")},
       {"path", "{waypoints: [{xyz: [0, 0, 1]}, {xyz: [0, 0.1, 1]}]}"},
       {"limits", "{joints: {joint_2: [-1, 1]}, joint_margin: {joint_1: 0.1}, soft_limits: false}"},
       {"scene", "[{name: part, mesh: box.stl, scale: [1, -2, 0.1], frame: link_1}]"}});
  problem.source.clear();
  const fs::path file = folder.folder().path() / "whole.yaml";
  save_problem(problem, file);
  EXPECT_EQ(TempFolder::read(file),
            "robot:\n  urdf: robots/arm.urdf\n  srdf: robots/arm.srdf\n  base_link: base_link\n"
            "  tip_link: link_7\n  hold: {finger_joint: 0.01}\n  attached:\n"
            "    - {name: part, mesh: problems/box.stl, scale: [1, -2, 0.1], link: link_1}\n"
            "path:\n  waypoints:\n    - {xyz: [0, 0, 1], quat: [1, 0, 0, 0]}\n"
            "    - {xyz: [0, 0.1, 1], quat: [1, 0, 0, 0]}\n"
            "limits: {joint_margin: {joint_1: 0.1}, joints: {joint_2: [-1, 1]}, soft_limits: "
            "false}\n");
  expect_equal(load_path_problem(file), problem);
}

TEST(SavedProblems, RefuseWhatNoFileCanSay) {
  const ProblemFolder folder;
  const fs::path target = folder.folder().path() / "problems/refused.yaml";
  int refusals = 0;
  const auto refused = [&](const std::string& text, const Change& change,
                           const std::vector<std::string>& words) {
    const fs::path file = folder.folder().write("problems/problem.yaml", text);
    PathProblem problem = load_path_problem(file);
    change(problem);
    expect_message(input_error([&] { save_problem(problem, target); }), words);
    EXPECT_FALSE(fs::exists(target));
    ++refusals;
  };
  refused(kFile, [](PathProblem& p) { p.source.clear(), p.model = parse_robot(arm_urdf()); },
          {"refused.yaml", "robot.urdf", "a text"});
  refused(kFile, [](PathProblem& p) { p.model = parse_robot(arm_urdf()); }, {"robot.urdf"});
  refused(kFile,
          [](PathProblem& p) {
            auto mesh = std::make_shared<TriangleMesh>();
            mesh->source = "mesh", mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
            mesh->triangles = {{0, 1, 2}};
            p.scene[0].shape = MeshPtr(mesh);
          },
          {"mesh of 'post'", "'mesh' is no file"});
  refused(kFile,
          [](PathProblem& p) {
            p.scene[0].allow = {{"link_6", 0.1}, {"link_7"}};
          },
          {"allow of 'post'", "some bodies have a depth"});
  refused(kFile, [](PathProblem& p) { p.source += "x"; }, {"problem.yamlx"});
  refused(kFile, [](PathProblem& p) { p.steps.assign(1, 3); }, {"path's layers"});
  PathProblem varied = load_path_problem(folder.folder().write(
      "problems/problem.yaml", std::string(kFile) + "vary: [{object: post, xyz: [1, 1, 1]}]\n"));
  varied.scene.erase(varied.scene.begin());
  EXPECT_THROW(save_problem(varied, target), InvalidArgument);
  EXPECT_FALSE(fs::exists(target));
  refused(with(kFile, "[0.1, 0.2, 0.3], allow", "&here [0.1, 0.2, 0.3], allow") +
              "vary: [{object: post, xyz: *here}]\n",
          [](PathProblem& p) { p.scene[0].pose.translation().x() = 0.2; }, {"vary"});
  refused(with(kFile, "clearance: 0.005", "clearance: &c 0.005"),
          [](PathProblem& p) { p.limits.clearance = 0.01; },
          {"problem.yaml:20", "clearance: cannot be changed in place"});
  refused(with(kFile, "joint_step: 0.4", "joint_margin: {joint_1: 0.1}"),
          [](PathProblem& p) { p.limits.joint_margin = 0.1; }, {"limits.joint_margin"});
  const auto robot = folder.folder().path() / "robots/arm.urdf";
  const std::string urdf = TempFolder::read(robot);
  expect_message(input_error([&] {
                   save_problem(load_path_problem(folder.folder().write("problems/p.yaml", kFile)),
                                robot);
                 }),
                 {"arm.urdf", "robot.urdf"});
  EXPECT_EQ(TempFolder::read(robot), urdf);
  std::printf("%d refusals\n", refusals + 1);
}

// --- random changes

Pose random_pose(swivel::test::Random& random) {
  Pose pose = Pose::Identity();
  for (double& x : pose.translation()) x = random.uniform(-1, 1);
  Vector3d rpy;
  for (double& angle : rpy) angle = random.uniform(-3, 3);
  if (random.coin()) pose.linear() = rotation_from_rpy(rpy);
  return pose;
}

void change_limits(PathProblem& p, swivel::test::Random& random) {
  const auto maybe = [&](std::optional<double>& limit) {
    limit = random.coin(0.3) ? std::nullopt : std::optional(random.uniform(0.001, 0.01));
  };
  if (random.coin()) p.limits.clearance = random.uniform(0.001, 0.01);
  if (random.coin()) maybe(p.limits.self_clearance);
  if (random.coin()) maybe(p.limits.edge_clearance);
  if (random.coin()) maybe(p.limits.tool_path_error);
  if (random.coin()) maybe(p.limits.tool_speed);
  if (random.coin()) p.limits.edges = EdgeMode::kNodes;
  if (random.coin()) p.limits.joint_step = random.uniform(0.1, 1);
  if (random.coin()) p.limits.joint_margin = random.uniform(0, 0.01);
  if (random.coin()) p.limits.joint_speed.emplace().fill(random.uniform(0.5, 1));
  if (random.coin())
    for (double& a : p.limits.joint_acceleration.emplace()) a = random.uniform(1, 5);
}

void change_scene(PathProblem& p, swivel::test::Random& random) {
  for (SceneObject& object : p.scene)
    if (random.coin(0.3)) object.pose = random_pose(random);
  for (SceneObject& object : p.scene)
    if (random.coin(0.2)) object.shape = Box{{0.1, random.uniform(0.1, 1), 0.3}};
  if (random.coin(0.5)) p.scene.push_back({"new", Capsule{0.1, 0.2}, random_pose(random), {}});
  const auto varies = [&](const SceneObject& object) {
    return object.name == p.path_frame ||
           std::any_of(p.vary.begin(), p.vary.end(),
                       [&](const Variation& one) { return one.object == object.name; });
  };
  if (random.coin(0.4))
    std::erase_if(p.scene, [&](const SceneObject& o) { return !varies(o) && random.coin(0.4); });
  if (random.coin(0.2)) std::reverse(p.scene.begin(), p.scene.end());
}

void change_path(PathProblem& p, swivel::test::Random& random) {
  const bool windows = p.waypoints.front().roll.has_value();
  if (!p.closed && random.coin(0.4)) p.waypoints[1].position.x() += random.uniform(0, 0.01);
  if (!p.closed && !windows && random.coin(0.3)) p.waypoints.push_back(p.waypoints[0]);
  if (!p.closed && p.waypoints.size() > 2 && random.coin(0.3)) p.waypoints.pop_back();
  if (random.coin(0.3)) p.smooth = PathSmoothing{random.uniform(0, 0.001), 0.01};
  if (random.coin(0.1)) p.smooth.reset();
  if (random.coin(0.3)) p.tool = random_pose(random);
  if (random.coin(0.3) && !p.closed) {
    p.start = Config::Constant(random.uniform(-0.1, 0.1));
    if (random.coin()) p.start_at = 0.01;
    if (random.coin()) p.start_tolerance = 0.01;
  } else if (random.coin(0.3)) {
    p.start.reset(), p.start_at.reset();
  }
}

void change_rest(PathProblem& p, swivel::test::Random& random) {
  if (random.coin(0.3)) p.resolution.ds = random.uniform(0.002, 0.02);
  if (random.coin(0.3)) p.resolution.dalpha = random.uniform(0.02, 0.2);
  if (random.coin(0.2)) p.resolution = Resolution();
  if (random.coin(0.3))
    p.cost.metric = random.one_of({CostMetric::kL1, CostMetric::kMax, CostMetric::kTime});
  if (random.coin(0.3)) p.cost.weights = {1, 1, random.uniform(1, 2), 1, 1, 1, 1};
  if (random.coin(0.3)) p.refinement.smoothing = random.uniform(0, 0.1);
  if (!p.roll && build_arm(*p.model, p.base_link, p.tip_link, p.hold, p.tool).chain.roll_fixed) {
    // A file has six numbers; the seventh is read as 0, or as the sixth of the rates.
    if (p.cost.weights) p.cost.weights->back() = 0;
    if (p.start) (*p.start)[kDof - 1] = 0;
    if (auto& rates = p.limits.joint_acceleration) rates->back() = (*rates)[kDof - 2];
  }
  if (random.coin(0.3))
    p.attached.push_back({"held", Cylinder{0.1, 0.2}, random_pose(random), p.tip_link});
  if (p.attached.empty()) return;
  const std::string& first = p.attached.front().name;
  const auto allows = [&](const SceneObject& object) {
    return std::any_of(object.allow.begin(), object.allow.end(),
                       [&](const Allowed& one) { return one.body == first; });
  };
  if (random.coin(0.2) && std::none_of(p.scene.begin(), p.scene.end(), allows))
    p.attached.erase(p.attached.begin());
}

/// Returns the comments of a text that stand on lines of their own.
std::vector<std::string> comments_of(const std::string& text) {
  std::istringstream lines(text);
  std::vector<std::string> comments;
  for (std::string line; std::getline(lines, line);)
    if (const std::size_t at = line.find_first_not_of(' '); at != line.npos && line[at] == '#')
      comments.push_back(line.substr(at));
  return comments;
}

void set_style(YAML::Node node, YAML::EmitterStyle::value style) {
  node.SetStyle(style);
  for (const auto& part : node) set_style(node.IsMap() ? part.second : part, style);
}
/// Returns a document with all of its maps and lists in one style, without its comments.
std::string laid_out(const std::string& text, YAML::EmitterStyle::value style) {
  YAML::Node root = YAML::Load(text);
  set_style(root, style);
  return YAML::Dump(root) + "\n";
}

TEST(SavedProblems, RandomChangesOfOtherLayoutsAreReadBack) {
  const std::uint64_t seed = swivel::test::seed("SavedProblems");
  const TempFolder folder;
  const fs::path file = folder.path() / "problem.yaml";
  int cases = 0;
  for (const char* const name :
       {"experiment_c", "kr6_turntable_pipe", "panda_weld_seam", "panda_polish_cover"})
    for (const auto style : {YAML::EmitterStyle::Block, YAML::EmitterStyle::Flow}) {
      const fs::path data = fs::path(SWIVEL_DATA_DIR) / "problems" / (name + std::string(".yaml"));
      const std::string text = laid_out(problem_text(load_path_problem(data), file), style);
      for (int k = 0; k < swivel::test::trials(10); ++k) {
        SCOPED_TRACE(data.string() + ", case " + std::to_string(cases));
        folder.write("problem.yaml", text);
        swivel::test::Random random(seed + static_cast<std::uint64_t>(cases++));
        PathProblem problem = load_path_problem(file);
        change_limits(problem, random);
        change_scene(problem, random);
        change_path(problem, random);
        change_rest(problem, random);
        save_problem(problem, file);
        if (!problem.start) problem.start_tolerance = Task().start_tolerance;
        expect_equal(load_path_problem(file), problem);
      }
    }
  std::printf("%d cases\n", cases);
  EXPECT_GE(cases, swivel::test::at_least(80));
}

TEST(SavedProblems, RandomChangesAreReadBack) {
  const std::uint64_t seed = swivel::test::seed("SavedProblems");
  const TempFolder folder;
  int cases = 0, kept = 0;
  const fs::directory_iterator entries(fs::path(SWIVEL_DATA_DIR) / "problems");
  std::vector<fs::path> sources;
  for (const auto& entry : entries) sources.push_back(entry.path());
  std::sort(sources.begin(), sources.end());
  for (const fs::path& source : sources) {
    std::optional<PathProblem> loaded;
    try {
      loaded = load_path_problem(source);
    } catch (const InputError&) {
      continue;  // a job or a workcell
    }
    if (source.stem() == "experiment_c_20k") continue;  // as experiment_c, with a large mesh
    for (int k = 0; k < swivel::test::trials(12); ++k) {
      swivel::test::Random random(seed + static_cast<std::uint64_t>(cases));
      PathProblem problem = *loaded;
      if (random.coin(0.1)) problem.source.clear();
      change_limits(problem, random);
      change_scene(problem, random);
      change_path(problem, random);
      change_rest(problem, random);
      const fs::path file = folder.path() / (std::to_string(cases) + ".yaml");
      SCOPED_TRACE(source.string() + ", case " + std::to_string(cases));
      ++cases;
      save_problem(problem, file);
      PathProblem expected = problem;
      if (!expected.start) expected.start_tolerance = Task().start_tolerance;
      expect_equal(load_path_problem(file), expected);
      // A list that is taken out takes the comments within it along.
      if (problem.source.empty() || problem.attached.empty()) continue;
      const std::string text = TempFolder::read(file);
      for (const std::string& comment : comments_of(TempFolder::read(source)))
        if (text.find(comment) != text.npos)
          ++kept;
        else if (comment.find("waypoint") == comment.npos)
          ADD_FAILURE() << "lost: " << comment;
    }
  }
  std::printf("%d cases, %d comments kept\n", cases, kept);
  EXPECT_GE(cases, swivel::test::at_least(150));
}

}  // namespace
}  // namespace swivel::io::test
