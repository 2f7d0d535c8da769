// SPDX-License-Identifier: BSD-3-Clause
#include "io_support.hpp"

namespace swivel::io::test {
namespace {

std::string robot(const std::string& body) {
  return "<?xml version='1.0'?>\n<robot name='r'>\n" + body + "</robot>\n";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& more = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
         "'/><child link='" + child + "'/>" + more + "</joint>\n";
}

std::string mesh_link(const std::string& name, const std::string& mesh) {
  return "<link name='" + name + "'><collision><geometry><mesh filename='" + mesh +
         "'/></geometry></collision></link>\n";
}

const char* const kLimit = "<limit lower='-1' upper='2' velocity='3' effort='4'/>";

TEST(Robot, RatesOfUrdf12WhateverVersionTheFileSays) {
  const TempFolder folder;
  for (const char* version : {"", " version='1.0'", " version='1.2'"}) {
    const std::string text =
        "<?xml version='1.0'?>\n<robot name='r'" + std::string(version) +
        "><link name='a'/><link name='b'/><link name='c'/><link name='d'/>" +
        joint("j", "revolute", "a", "b",
              "<limit lower='-1' upper='2' velocity='3' effort='4' acceleration='5' "
              "deceleration='2.5' jerk='60'/>") +
        joint("k", "continuous", "b", "c", "<limit velocity='3' deceleration='7'/>") +
        joint("l", "revolute", "c", "d", kLimit) + "</robot>\n";
    const auto model = load_robot(folder.write("r.urdf", text));
    EXPECT_EQ(model->joints[0].acceleration, 2.5) << version;
    EXPECT_EQ(model->joints[0].jerk, 60);
    EXPECT_EQ(model->joints[1].acceleration, 7);
    EXPECT_EQ(model->joints[1].jerk, 0);
    EXPECT_EQ(model->joints[2].acceleration, 0);
  }
}

TEST(Robot, LinksAndJointsInTheOrderOfTheFile) {
  const TempFolder folder;
  const fs::path file = folder.write(
      "r.urdf",
      robot("<link name='z'/><link name='b'/><link name='a'/><link name='c'/><link name='d'/>\n" +
            joint("jd", "prismatic", "c", "d",
                  std::string(kLimit) + "<mimic joint='jb' multiplier='-2' offset='0.5'/>") +
            joint("jb", "revolute", "z", "b",
                  std::string(kLimit) + "<axis xyz='0 0 -2'/><origin xyz='1 2 3' rpy='0 0 1.5'/>") +
            joint("ja", "continuous", "b", "a") +
            joint("jc", "fixed", "a", "c", "<axis xyz='0 0 0'/>")));
  const auto model = load_robot(file);
  EXPECT_EQ(model->name, "r");
  EXPECT_EQ(model->source, file.string());
  ASSERT_EQ(model->links.size(), 5u);
  ASSERT_EQ(model->joints.size(), 4u);
  EXPECT_EQ(model->links[0].name, "z");
  EXPECT_EQ(model->root_link, 0);
  EXPECT_EQ(model->links[0].parent_joint, -1);
  const Joint& d = model->joints[0];
  EXPECT_EQ(d.type, Joint::Type::kPrismatic);
  EXPECT_EQ(d.parent_link, model->find_link("c"));
  EXPECT_EQ(model->links[d.child_link].parent_joint, 0);
  ASSERT_TRUE(d.mimic);
  EXPECT_EQ(d.mimic->joint, 1);
  EXPECT_EQ(d.mimic->multiplier, -2);
  EXPECT_EQ(d.mimic->offset, 0.5);
  EXPECT_EQ(d.axis, Vector3d::UnitX());
  const Joint& b = model->joints[1];
  EXPECT_EQ(b.axis, -Vector3d::UnitZ());
  EXPECT_EQ(b.lower, -1);
  EXPECT_EQ(b.upper, 2);
  EXPECT_EQ(b.velocity, 3);
  EXPECT_EQ(b.origin.translation(), Vector3d(1, 2, 3));
  EXPECT_TRUE(b.origin.linear().isApprox(
      Eigen::AngleAxisd(1.5, Vector3d::UnitZ()).toRotationMatrix(), 1e-15));
  EXPECT_EQ(model->joints[2].type, Joint::Type::kContinuous);
  EXPECT_EQ(model->joints[2].axis, Vector3d::UnitX());
  EXPECT_EQ(model->joints[2].velocity, 0);
  EXPECT_EQ(model->joints[3].type, Joint::Type::kFixed);
  EXPECT_FALSE(model->has_srdf);
}

TEST(Robot, RpyIsRzRyRx) {
  const TempFolder folder;
  const auto model = load_robot(
      folder.write("r.urdf", robot("<link name='a'/><link name='b'/>" +
                                   joint("j", "fixed", "a", "b", "<origin rpy='0.1 0.2 0.3'/>"))));
  const Matrix3d expected =
      (Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.2, Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.1, Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_TRUE(model->joints[0].origin.linear().isApprox(expected, 1e-14));
}

TEST(Robot, SeveralCollisionsAndEveryPrimitive) {
  const TempFolder folder;
  folder.write("box.stl", box_stl());
  const auto model = load_robot(folder.write(
      "r.urdf",
      robot("<link name='a'><visual><geometry><mesh filename='absent.dae'/></geometry></visual>"
            "<collision><origin xyz='1 0 0'/><geometry><box size='1 2 3'/></geometry></collision>"
            "<collision><geometry><sphere radius='0.5'/></geometry></collision>"
            "<collision><geometry><cylinder radius='0.5' length='2'/></geometry></collision>"
            "<collision><geometry><mesh filename='box.stl' scale='1 -1 "
            "1'/></geometry></collision></link>"
            "<link name='b'><visual><geometry><sphere radius='1'/></geometry></visual></link>" +
            joint("j", "fixed", "a", "b"))));
  const auto& shapes = model->links[0].collision;
  ASSERT_EQ(shapes.size(), 4u);
  EXPECT_EQ(std::get<Box>(shapes[0].shape).size, Vector3d(1, 2, 3));
  EXPECT_EQ(shapes[0].pose.translation(), Vector3d(1, 0, 0));
  EXPECT_EQ(std::get<Sphere>(shapes[1].shape).radius, 0.5);
  EXPECT_EQ(std::get<Cylinder>(shapes[2].shape).length, 2);
  EXPECT_DOUBLE_EQ(volume(*std::get<MeshPtr>(shapes[3].shape)), 6);
  EXPECT_TRUE(model->links[1].collision.empty());
}

TEST(Robot, WhatAPlannerDoesNotReadMayBeWrong) {
  const TempFolder folder;
  const auto model = load_robot(
      folder.write("r.urdf",
                   "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>\n"
                   "<!-- twice the same material, no colour, an inertia without mass -->\n"
                   "<material name='green'><color rgba='0 1 0 1'/></material><material "
                   "name='green'><color rgba='0 2 0 1'/></material>"
                   "<material name='none'/><gazebo reference='a'/><transmission "
                   "name='t'><type>x</type></transmission>"
                   "<link name='a'><inertial/><inertial/><visual><origin ryp='0 0 "
                   "0'/></visual><collision><geometry><sphere "
                   "radius='1'/></geometry>"
                   "<material name='red'/></collision></link><link name='b'/>"
                   "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><dynamics "
                   "damping='x'/><safety_controller "
                   "k_velocity='5'/>"
                   "<calibration rising='x'/><limit lower='0' upper='1'/></joint></robot>"));
  EXPECT_EQ(model->links[0].collision.size(), 1u);
  EXPECT_EQ(model->joints[0].velocity, 0);
  EXPECT_EQ(model->joints[0].upper, 1);
  EXPECT_TRUE(model->warnings.empty());
}

std::shared_ptr<const RobotModel> one_joint(const std::string& type, const std::string& more,
                                            const RobotOptions& options = {}) {
  return parse_robot(robot("<link name='a'/><link name='b'/>\n" + joint("j", type, "a", "b", more)),
                     "", {}, options);
}

TEST(Robot, RotationsAndCapsulesOfUrdf11) {
  const Matrix3d expected =
      one_joint("fixed", "<origin xyz='1 2 3' rpy='0.1 -0.2 0.3'/>")->joints[0].origin.linear();
  const Quaterniond q(expected);
  std::ostringstream text;
  text.precision(17);
  text << "<origin xyz='1 2 3' quat_xyzw='" << 2 * q.x() << ' ' << 2 * q.y() << ' ' << 2 * q.z()
       << ' ' << 2 * q.w() << "'/>";
  const auto model = one_joint("fixed", text.str());
  EXPECT_TRUE(model->joints[0].origin.linear().isApprox(expected, 1e-14));
  EXPECT_EQ(model->joints[0].origin.translation(), Vector3d(1, 2, 3));
  const auto capsule = parse_robot(
      "<robot name='r' version='1.1'><link name='a'><collision><origin quat_xyzw='0 0 1 0'/>"
      "<geometry><capsule radius='0.1' length='0.3'/></geometry></collision></link></robot>");
  EXPECT_EQ(std::get<Capsule>(capsule->links[0].collision[0].shape).length, 0.3);
  EXPECT_TRUE(capsule->warnings.empty());
  const auto message = [](const char* origin) {
    return input_error([&] { (void)one_joint("fixed", origin); });
  };
  expect_message(message("<origin quat_xyzw='0 0 0 1' rpy='0 0 0'/>"),
                 {"URDF text:4", "'j'", "rpy", "quat_xyzw"});
  expect_message(message("<origin quat_xyzw='0 0 0 0'/>"), {"URDF text:4", "'j'", "no direction"});
  expect_message(message("<origin quat_xyzw='0 0 1'/>"), {"URDF text:4", "'j'", "4 numbers"});
}

TEST(Robot, WhiteSpaceOfXml) {
  const auto model =
      one_joint("revolute",
                "<origin xyz=' 1\t2\n\t3 '/><axis xyz='0\n0\t1'/><limit lower=' -1' upper='2\n'/>");
  EXPECT_EQ(model->joints[0].origin.translation(), Vector3d(1, 2, 3));
  EXPECT_EQ(model->joints[0].axis, Vector3d::UnitZ());
  EXPECT_EQ(model->joints[0].lower, -1);
}

/// What could change geometry, limits or which joints move is refused at its line, with the word
/// that was probably meant.
TEST(Robot, WordsThatAreNotKnownAreRefused) {
  const std::string limit = "<limit lower='0' upper='1'/>";
  const struct {
    const char* what;
    std::string more;
    std::vector<std::string> needles;
  } cases[] = {
      {"attribute of origin",
       limit + "\n<origin rpz='0 0 1'/>",
       {"URDF text:5", "'rpz'", "<origin>", "'rpy'"}},
      {"attribute of limit", "\n<limit lower='0' uper='1'/>", {"URDF text:5", "'uper'", "'upper'"}},
      {"attribute of axis", limit + "<axis xzy='0 0 1'/>", {"'xzy'", "'xyz'"}},
      {"axis in its text", limit + "<axis>0 0 1</axis>", {"URDF text:4", "text in <axis>"}},
      {"axis without xyz", limit + "<axis/>", {"URDF text:4", "'j'", "axis xyz is missing"}},
      {"an empty limit",
       "<limit lower='0' upper=''/>",
       {"URDF text:4", "'j'", "limit upper is empty: allowed is a number"}},
      {"an empty speed",
       "<limit lower='0' upper='1' velocity=''/>",
       {"limit velocity is empty: allowed is a number"}},
      {"an empty axis", limit + "<axis xyz=''/>", {"axis xyz is empty: allowed is 3 numbers"}},
      {"no axis", limit + "<axis/>", {"axis xyz is missing: allowed is 3 numbers"}},
      {"an empty rpy", limit + "<origin rpy=''/>", {"origin rpy is empty: allowed is 3 numbers"}},
      {"an empty leader", limit + "<mimic joint=''/>", {"mimic joint is empty: allowed is a name"}},
      {"an empty multiplier",
       limit + "<mimic joint='k' multiplier=''/>",
       {"mimic multiplier is empty: allowed is a number"}},
      {"element of joint", limit + "<orgin xyz='0 0 1'/>", {"<orgin>", "'origin'"}},
      {"two limits", limit + "\n" + limit, {"URDF text:5", "second <limit>", "line 4"}},
      {"two origins", limit + "<origin xyz='0 0 1'/><origin xyz='0 0 2'/>", {"second <origin>"}},
      {"an attribute twice", "<limit lower='0' upper='1' upper='2'/>", {"URDF text:4", "not XML"}},
      {"xacro", limit + "<xacro:origin xyz='0 0 1'/>", {"xacro"}},
      {"xacro in a number", "<limit lower='0' upper='${pi}'/>", {"'${pi}'", "xacro"}},
      {"soft limits crossed",
       limit + "<safety_controller soft_lower_limit='1' soft_upper_limit='0'/>",
       {"'j'", "soft_lower_limit"}},
      {"soft limits elsewhere",
       limit + "<safety_controller soft_lower_limit='2' soft_upper_limit='3'/>",
       {"'j'", "outside"}},
  };
  for (const auto& [what, more, needles] : cases) {
    SCOPED_TRACE(what);
    expect_message(input_error([&, &more = more] { (void)one_joint("revolute", more); }), needles);
  }
}

/// Unknown words of links, second shapes and second robots are refused at their line.
TEST(Robot, NamesThatXacroDidNotExpandAreRefused) {
  const auto message = [](const std::string& body) {
    return input_error([&] { (void)parse_robot(robot(body)); });
  };
  expect_message(message("<link name='$(arg prefix)a'/>"),
                 {"URDF text:3", "'$(arg prefix)a'", "xacro expanded"});
  const std::string links = "<link name='a'/><link name='b'/>";
  for (const char* const name : {"$(arg prefix)j1", "${prefix}j1"})
    expect_message(message(links + "<joint name='" + name +
                           "' type='fixed'><parent link='a'/><child link='b'/></joint>"),
                   {"URDF text:3", "<joint> has the name '" + std::string(name), "xacro expanded"});
  expect_message(message("<link name='a'><collision><geometry><mesh "
                         "filename='$(find robot)/a.stl'/></geometry></collision></link>"),
                 {"URDF text:3", "'$(find robot)/a.stl'", "xacro expanded"});
}

TEST(Robot, WordsThatAreNotKnownInLinksAreRefused) {
  const auto message = [](const std::string& body) {
    return input_error([&] { (void)parse_robot(robot(body)); });
  };
  const std::string ball = "<geometry><sphere radius='1'/></geometry>";
  expect_message(message("<link name='a'><collision><xacro:body/></collision></link>"),
                 {"URDF text:3", "<xacro:body>", "xacro did not run"});
  expect_message(message("<link name='a'><collision>" + ball + ball + "</collision></link>"),
                 {"second <geometry>"});
  expect_message(message("<link name='a'><collision><geometry><sphere radius='1'/>\n<box size='1 1 "
                         "1'/></geometry></collision></link>"),
                 {"URDF text:4", "'a'", "second shape <box>"});
  expect_message(message("<link name='a'><collision rpy='0 0 1'>" + ball + "</collision></link>"),
                 {"'rpy'", "<collision>"});
  expect_message(input_error([] {
                   (void)parse_robot("<robot name='r'><link name='a'/></robot>\n<robot name='s'/>");
                 }),
                 {"URDF text:2", "second element <robot>"});
}

/// What other programs keep in a file is not read, and that is said once for each kind.
TEST(Robot, WordsThatAreNotKnownElsewhereAreWarnedOf) {
  const auto model = parse_robot(
      "<robot name='r' version='7' tesseract:make_convex='1' xmlns:tesseract='x'>\n<link "
      "name='a'>\n<colision/>\n<colision/></link>"
      "<loop_joint/><xacro:gripper/>words<joint name='j' type='fixed'><parent link='a'/><child "
      "link='b'/><drake:damper/></joint><link "
      "name='b'/></robot>");
  const std::vector<std::string> expected{
      "URDF text:1: unknown attribute 'tesseract:make_convex' in <robot>: it is not read",
      "URDF text:3: unknown element <colision> in <link>, nearest known is 'collision': it is not "
      "read (and 1 more of these)",
      "URDF text:4: unknown element <loop_joint> in <robot>, nearest known is 'joint': it is not "
      "read",
      "URDF text:4: element <xacro:gripper> in <robot> stands where xacro did not run: it is not "
      "read",
      "URDF text:4: text in <robot>: it is not read",
      "URDF text:4: unknown element <drake:damper> in <joint>: it is not read",
      "URDF text:1: version '7' of URDF is read as 1.2 is"};
  EXPECT_EQ(model->warnings, expected);
  std::string many;
  for (int k = 0; k < 1000; ++k) many += "<x" + std::to_string(k) + "/>";
  const auto of_many = parse_robot(robot("<link name='a'>" + many + "</link>"))->warnings;
  EXPECT_EQ(of_many.size(), 51u);
  EXPECT_EQ(of_many.back(), "and 950 more that are not known");
}

TEST(Robot, SoftLimits) {
  const auto soft = [](const char* type, const std::string& attributes, bool honoured = true) {
    return one_joint(type, "<limit lower='-1' upper='2'/><safety_controller " + attributes + "/>",
                     {{}, honoured});
  };
  const std::string narrower =
      "soft_lower_limit='-0.5' soft_upper_limit='3' k_position='10' k_velocity='10'";
  const Joint kept = soft("revolute", narrower)->joints[0];
  EXPECT_EQ(kept.lower, -0.5);
  EXPECT_EQ(kept.upper, 2);
  ASSERT_TRUE(kept.hard);
  EXPECT_EQ(kept.hard->lower, -1);
  EXPECT_EQ(kept.hard->upper, 2);
  const Joint left_out = soft("revolute", narrower, false)->joints[0];
  EXPECT_EQ(left_out.lower, -1);
  EXPECT_FALSE(left_out.hard);
  EXPECT_EQ(soft("revolute", "soft_upper_limit='1'")->joints[0].lower,
            0);  // as URDF has it where one is absent
  EXPECT_FALSE(soft("revolute", "soft_lower_limit='-1' soft_upper_limit='2'")->joints[0].hard);
  EXPECT_FALSE(soft("revolute", "k_velocity='10'")->joints[0].hard);
  const auto continuous = soft("continuous", narrower);
  ASSERT_EQ(continuous->warnings.size(), 2u);  // its limits as well
  EXPECT_NE(continuous->warnings[1].find("joint 'j': is continuous: its soft limits are not kept"),
            std::string::npos);
}

TEST(Robot, FreeJointsAreHeldAndSaid) {
  for (const char* type : {"floating", "planar"}) {
    const auto model = one_joint(type, "<origin xyz='0 0 1'/>");
    EXPECT_EQ(model->joints[0].type, Joint::Type::kFree);
    EXPECT_FALSE(model->joints[0].movable());
    EXPECT_EQ(model->joints[0].origin.translation().z(), 1);
    EXPECT_EQ(model->warnings,
              std::vector<std::string>{"URDF text:4: joint 'j': is " + std::string(type) +
                                       ": it is held at its origin"});
  }
}

TEST(Robot, LinksLeftOut) {
  const TempFolder folder;
  const std::string text = robot(
      "<link name='z'/>" + joint("to_hand", "revolute", "arm", "hand", kLimit) +
      "<link name='arm'/>" + mesh_link("hand", "absent.stl") +
      joint("to_arm", "revolute", "z", "arm", kLimit) + "<link name='finger'/><link name='eye'/>" +
      joint("to_finger", "prismatic", "hand", "finger", kLimit) +
      joint("to_eye", "fixed", "arm", "eye"));
  const auto load = [&](std::vector<std::string> without, const std::string& srdf = "") {
    return parse_robot(text, srdf, {}, {std::move(without), true});
  };
  const auto model =
      load({"hand"}, robot("<disable_collisions link1='hand' link2='arm'/><disable_collisions "
                           "link1='eye' link2='arm'/>"
                           "<passive_joint name='to_finger'/>"));
  std::vector<std::string> names;
  for (const Link& link : model->links) names.push_back(link.name);
  EXPECT_EQ(names, (std::vector<std::string>{"z", "arm", "eye"}));
  ASSERT_EQ(model->joints.size(), 2u);
  EXPECT_EQ(model->joints[0].name, "to_arm");
  EXPECT_EQ(model->joints[1].child_link, 2);
  EXPECT_EQ(model->links[2].parent_joint, 1);
  EXPECT_TRUE(model->warnings.empty());
  EXPECT_EQ(load({"hand", "eye", "finger"})->links.size(), 2u);
  expect_message(input_error([&] { (void)load({}); }), {"absent.stl"});
  expect_message(input_error([&] { (void)load({"hnad"}); }), {"robot.without", "'hnad'", "'hand'"});
  expect_message(input_error([&] { (void)load({"z"}); }), {"robot.without", "'z'"});
  const std::string mimics =
      robot("<link name='a'/><link name='b'/><link name='c'/>" +
            joint("j", "revolute", "a", "b", kLimit) +
            joint("k", "revolute", "a", "c", std::string(kLimit) + "<mimic joint='j'/>"));
  expect_message(input_error([&] {
                   (void)parse_robot(mimics, "", {}, {{"b"}, true});
                 }),
                 {"'k'", "'j'", "robot.without"});
}

TEST(Robot, NothingIsPrinted) {
  const TempFolder folder;
  const fs::path file = folder.write("r.urdf", robot("<link name='a'/><link name='b'/>"));
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  expect_message(input_error([&] { (void)load_robot(file); }), {"r.urdf"});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(Robot, PackagesAreFoundByWalkingUp) {
  const TempFolder folder;
  folder.write("ws/pkg/meshes/box.stl", box_stl());
  folder.write("ws/other_pkg/box.stl", box_stl());
  const std::string text = robot(mesh_link("a", "package://pkg/meshes/box.stl"));
  EXPECT_EQ(load_robot(folder.write("ws/pkg/urdf/deep/r.urdf", text))->links.size(),
            1u);  // the package holds the URDF
  EXPECT_EQ(load_robot(folder.write("ws/third/urdf/r.urdf", text))->links.size(),
            1u);                                                             // it lies beside
  EXPECT_EQ(load_robot(folder.write("ws/r.urdf", text))->links.size(), 1u);  // or below
  EXPECT_EQ(load_robot(folder.write("ws/pkg/r2.urdf",
                                    robot(mesh_link("a", "package://other_pkg/box.stl"))))
                ->links.size(),
            1u);
}

TEST(Robot, PackagesInFoldersOfOtherNames) {
  const TempFolder folder;
  const std::string text = robot(mesh_link("a", "package://pkg/meshes/box.stl"));
  const auto load = [&] { return load_robot(folder.write("ws/download-1.2/urdf/r.urdf", text)); };
  folder.write("ws/download-1.2/meshes/box.stl", box_stl(9, 9, 9));
  const auto size = [&] {
    return std::cbrt(volume(*std::get<MeshPtr>(load()->links[0].collision[0].shape)));
  };
  EXPECT_NEAR(size(), 9, 1e-6);
  folder.write("ws/download-1.2/package.xml", "<package format='2'><name>pkg</name></package>");
  EXPECT_NEAR(size(), 9, 1e-6);
  folder.write("ws/download-1.2/package.xml", "<package><name>another</name></package>");
  expect_message(input_error([&] { (void)load(); }),
                 {"package://pkg/meshes/box.stl", "robot.packages: {pkg: "});
  folder.write("ws/meshes/box.stl", box_stl(7, 7, 7));  // further up
  EXPECT_NEAR(size(), 7, 1e-6);
  folder.write("pkg/meshes/box.stl", box_stl(5, 5, 5));  // the right name goes first
  EXPECT_NEAR(size(), 5, 1e-6);
}

TEST(Robot, KinematicsNeedNoMeshes) {
  const TempFolder folder;
  const std::string ball =
      "<link name='b'><visual><geometry><mesh filename='x.stl'/></geometry></visual>"
      "<collision><geometry><sphere radius='1'/></geometry></collision></link>";
  ShapeSurvey shapes;
  const auto model =
      load_kinematics(folder.write("r.urdf", robot(mesh_link("a", "package://pkg/box.stl") + ball +
                                                   joint("j", "fixed", "a", "b"))),
                      {}, {}, {}, shapes);
  EXPECT_EQ(model->links.at(0).name, "a");
  EXPECT_TRUE(model->links.at(0).collision.empty());
  EXPECT_EQ(shapes.collision, 2u);
  EXPECT_EQ(shapes.visual_meshes, 1u);
  ASSERT_EQ(shapes.missing_meshes.size(), 1u);
  expect_message(shapes.missing_meshes.front(), {"link 'a'", "package://pkg/box.stl"});
}

TEST(Robot, PackagesFromTheMapGoFirst) {
  const TempFolder folder;
  folder.write("pkg/box.stl", box_stl());
  folder.write("elsewhere/v2/box.stl", box_stl(7, 7, 7));
  folder.write("shelf/pkg/box.stl", box_stl(9, 9, 9));
  const fs::path urdf = folder.write("r.urdf", robot(mesh_link("a", "package://pkg/box.stl")));
  const auto size = [&](const std::map<std::string, fs::path>& packages) {
    return std::cbrt(
        volume(*std::get<MeshPtr>(load_robot(urdf, {}, packages)->links[0].collision[0].shape)));
  };
  EXPECT_NEAR(size({{"pkg", folder.path() / "elsewhere/v2"}}), 7,
              1e-6);                                               // the folder is the package
  EXPECT_NEAR(size({{"pkg", folder.path() / "shelf"}}), 9, 1e-6);  // the folder holds the package
  EXPECT_NEAR(size({{"unused", folder.path() / "shelf"}}), std::cbrt(6), 1e-6);
  expect_message(input_error([&] {
                   (void)size({{"pkg", folder.path() / "nowhere"}});
                 }),
                 {"r.urdf:3", "link 'a'", "package://pkg/box.stl"});
}

TEST(Robot, RelativeUrdfNameWalksUpToo) {
  const TempFolder folder;
  folder.write("pkg/box.stl", box_stl());
  folder.write("pkg/urdf/r.urdf", robot(mesh_link("a", "package://pkg/box.stl")));
  const fs::path before = fs::current_path();
  fs::current_path(folder.path() / "pkg/urdf");
  std::shared_ptr<const RobotModel> model;
  EXPECT_NO_THROW(model = load_robot("r.urdf"));
  fs::current_path(before);
}

TEST(Robot, FileNames) {
  const TempFolder folder;
  const fs::path box = folder.write("meshes/box.stl", box_stl());
  for (const std::string& name :
       {"file://" + box.string(), box.string(), std::string("../meshes/box.stl"),
        std::string("file://../meshes/box.stl")})
    EXPECT_EQ(load_robot(folder.write("urdf/r.urdf", robot(mesh_link("a", name))))
                  ->links[0]
                  .collision.size(),
              1u)
        << name;
}

TEST(Robot, OneMeshServesManyLinks) {
  const TempFolder folder;
  folder.write("box.stl", box_stl());
  const auto model = load_robot(
      folder.write("r.urdf", robot(mesh_link("a", "box.stl") + mesh_link("b", "box.stl") +
                                   joint("j", "fixed", "a", "b"))));
  EXPECT_EQ(std::get<MeshPtr>(model->links[0].collision[0].shape),
            std::get<MeshPtr>(model->links[1].collision[0].shape));
}

TEST(Robot, Srdf) {
  const TempFolder folder;
  const fs::path urdf = folder.write("r.urdf", arm_urdf());
  const auto model = load_robot(
      urdf,
      folder.write("r.srdf",
                   robot("<group name='g'><joint name='x'/></group>\n"
                         "<disable_collisions link1='link_2' link2='link_1' reason='Adjacent'/>"
                         "<disable_collisions link1='link_1' link2='link_2'/>"
                         "<disable_collisions link1='absent' link2='link_1'/>")));
  EXPECT_TRUE(model->has_srdf);
  const std::vector<std::pair<std::string, std::string>> expected{{"absent", "link_1"},
                                                                  {"link_1", "link_2"}};
  EXPECT_EQ(model->disabled_pairs, expected);
}

TEST(Robot, PlanningGroups) {
  const auto model = parse_robot(
      robot("<link name='world'/><link name='a'/><link name='b'/><link name='c'/>"
            "<link name='tip'/><link name='finger'/>\n" +
            joint("rail", "prismatic", "world", "a", kLimit) + joint("fixed", "fixed", "c", "tip") +
            joint("j2", "revolute", "b", "c", kLimit) + joint("j1", "revolute", "a", "b", kLimit) +
            joint("grip", "prismatic", "c", "finger", kLimit)));
  using Names = std::vector<std::string>;
  struct Case {
    std::string what;
    Names joints;
    std::string base, tip;
  };
  const Case cases[] = {
      {"<chain base_link='a' tip_link='tip'/>", {"j1", "j2"}, "a", "tip"},
      {"<chain base_link='world' tip_link='c'/>", {"rail", "j1", "j2"}, "world", "c"},
      {"<joint name='j2'/><joint name='j1'/>", {"j1", "j2"}, "a", "c"},
      {"<link name='c'/><link name='tip'/>", {"j2"}, "b", "tip"},
      {"<group name='g0'/><joint name='fixed'/>", {"j1", "j2"}, "a", "tip"},
      {"<group name='g2'/><joint name='grip'/>", {"j1", "j2", "grip"}, "a", "finger"},
      {"<group name='g2'/><joint name='grip'/><joint name='fixed'/>", {"j2", "j1", "grip"}, "", ""},
      {"<chain base_link='tip' tip_link='b'/>", {}, "", ""},
      {"<chain base_link='nowhere' tip_link='b'/><joint name='no'/>", {}, "", ""},
      {"<group name='g9'/>", {}, "", ""},  // itself
  };
  std::string srdf;
  for (std::size_t k = 0; k < std::size(cases); ++k)
    srdf += "<group name='g" + std::to_string(k) + "'>" + cases[k].what + "</group>\n";
  // A group may name one that comes later.
  srdf = "<group name='first'><group name='g1'/></group>" + srdf;
  const std::vector<PlanningGroup> groups = planning_groups(robot(srdf), *model);
  ASSERT_EQ(groups.size(), std::size(cases) + 1);
  EXPECT_EQ(groups[0].joints, cases[1].joints);
  for (std::size_t k = 0; k < std::size(cases); ++k) {
    const PlanningGroup& group = groups[k + 1];
    EXPECT_EQ(group.name, "g" + std::to_string(k));
    EXPECT_EQ(group.joints, cases[k].joints) << k;
    EXPECT_EQ(group.base_link, cases[k].base) << k;
    EXPECT_EQ(group.tip_link, cases[k].tip) << k;
  }
  EXPECT_TRUE(planning_groups("", *model).empty());
  std::string deep;
  for (int k = 0; k < 200; ++k)
    deep += "<group name='" + std::to_string(k) + "'><group name='" + std::to_string(k + 1) +
            "'/></group>";
  expect_message(input_error([&] { (void)planning_groups(robot(deep), *model); }), {"100 levels"});
}

TEST(Robot, TextsAreReadAsFilesAre) {
  const TempFolder folder;
  const std::string urdf = arm_urdf(),
                    srdf = robot("<disable_collisions link1='link_2' link2='link_1'/>");
  const auto read = load_robot(folder.write("r.urdf", urdf), folder.write("r.srdf", srdf)),
             parsed = parse_robot(urdf, srdf);
  ASSERT_EQ(parsed->joints.size(), read->joints.size());
  for (std::size_t k = 0; k < read->joints.size(); ++k) {
    EXPECT_EQ(parsed->joints[k].name, read->joints[k].name);
    EXPECT_EQ(parsed->joints[k].origin.matrix(), read->joints[k].origin.matrix());
    EXPECT_EQ(parsed->joints[k].upper, read->joints[k].upper);
  }
  EXPECT_EQ(parsed->disabled_pairs, read->disabled_pairs);
  expect_message(input_error([] { (void)parse_robot("<robot name='r'>\n<link/></robot>"); }),
                 {"URDF text:2", "no name"});
  expect_message(input_error([&] { (void)parse_robot(urdf, "<robot"); }), {"SRDF text:1"});
  const fs::path box = folder.write("pkg/box.stl", box_stl());
  const std::string with_mesh = robot(mesh_link("a", "package://pkg/box.stl"));
  EXPECT_EQ(parse_robot(with_mesh, {}, {{"pkg", box.parent_path()}})->links[0].collision.size(),
            1u);
}

TEST(Robot, SrdfNamesThatTheRobotDoesNotHave) {
  const std::string srdf = robot(
      "<group name='g'><joint name='fixed_base'/><joint name='joint_1'/><joint "
      "name='jiont_2'/>\n<chain base_link='base_link' "
      "tip_link='tip'/>"
      "</group><virtual_joint name='fixed_base' type='fixed' parent_frame='world' "
      "child_link='base_link'/>\n"
      "<disable_collisions link1='hand' link2='link_1'/>\n<disable_collisions link1='hand' "
      "link2='link_2'/>"
      "<end_effector name='e' parent_link='hand' group='h'/>"
      "<group_state name='s' group='g'><joint name='joint_9' "
      "value='0'/></group_state><joint_property joint_name='joint_8' "
      "property_name='a' value='b'/><planning_pipeline/><passive_joint name='joint_3'/>");
  const auto model = parse_robot(arm_urdf(), srdf);
  const auto names = [](int line, const std::string& what) {
    return "SRDF text:" + std::to_string(line) + ": names " + what +
           ", which the robot does not have";
  };
  const std::vector<std::string> expected{
      "SRDF text:2: is of robot 'r', and the URDF of 'arm': are they of one robot?",
      "SRDF text:6: unknown element <planning_pipeline> in <robot>, nearest known is "
      "'passive_joint': it is not read",
      names(3, "joint 'jiont_2'"),
      names(4, "link 'tip'"),
      names(5, "link 'hand'") + " (and 2 more of these)",
      names(6, "joint 'joint_9'"),
      names(6, "joint 'joint_8'")};
  EXPECT_EQ(model->warnings, expected);
  EXPECT_TRUE(model->joints[2].passive);
  EXPECT_FALSE(model->joints[1].passive);
}

/// MoveIt refuses such a pair of files; users who rename a robot in one of them are warned, once.
TEST(Robot, SrdfOfAnotherRobot) {
  const auto warnings = [](const std::string& name) {
    return parse_robot(arm_urdf(),
                       "<!-- a note -->\n<robot" + name +
                           "><disable_collisions link1='link_1' link2='link_2'/></robot>")
        ->warnings;
  };
  const std::vector<std::string> expected{
      "SRDF text:2: is of robot 'leg', and the URDF of 'arm': are they of one robot?"};
  EXPECT_EQ(warnings(" name='leg'"), expected);
  EXPECT_TRUE(warnings(" name='arm'").empty());
  EXPECT_TRUE(warnings("").empty());
}

TEST(Robot, SrdfDefaults) {
  const TempFolder folder;
  const fs::path urdf =
      folder.write("r.urdf", robot("<link name='a'/><link name='b'/><link name='c'/>" +
                                   joint("j", "fixed", "a", "b") + joint("k", "fixed", "a", "c")));
  const auto model = load_robot(
      urdf,
      folder.write(
          "r.srdf",
          robot("<disable_default_collisions link='a'/><enable_collisions link1='c' link2='a'/>")));
  const std::vector<std::pair<std::string, std::string>> expected{{"a", "b"}};
  EXPECT_EQ(model->disabled_pairs, expected);
}

/// A bad URDF file and what the message about it has to name.
struct BadFile {
  const char* name;
  std::string text;
  std::vector<std::string> needles;
};

/// Expects each of the files to be refused with a message that names the file and has the needles.
/// The files may name the mesh box.stl beside them.
void expect_refused(const std::vector<BadFile>& files) {
  const TempFolder folder;
  folder.write("box.stl", box_stl());
  for (const auto& [name, text, needles] : files) {
    SCOPED_TRACE(name);
    const fs::path file = folder.write("r.urdf", text);
    const std::string message = input_error([&] { (void)load_robot(file); });
    expect_message(message, needles);
    expect_message(message, {file.string()});
  }
}

/// Two links and three links of a URDF file.
const std::string kAb = "<link name='a'/>\n<link name='b'/>\n", kAbc = kAb + "<link name='c'/>\n";

TEST(Robot, BadUrdf) {
  expect_refused({
      {"empty", "", {"not XML"}},
      {"not XML", "<robot>\n<link></robot>", {"r.urdf:2", "not XML"}},
      {"not a robot", "<sdf/>", {"r.urdf:1", "robot"}},
      {"no links", robot(""), {}},
      {"two roots", robot(kAb), {"root"}},
      {"no root",
       robot(kAb + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a")),
       {"r.urdf:6", "'k'", "loop"}},
      {"link twice", robot("<link name='a'/>\n<link name='a'/>"), {"r.urdf:4", "'a'"}},
      {"joint twice",
       robot(kAbc + joint("j", "fixed", "a", "b") + joint("j", "fixed", "a", "c")),
       {"'j'"}},
      {"unnamed link", robot("<link/>"), {"r.urdf:3", "<link> has no name"}},
      {"unnamed joint",
       robot(kAb + "<joint type='fixed'><parent link='a'/><child link='b'/></joint>"),
       {}},
      {"unknown parent", robot(kAb + joint("j", "fixed", "x", "b")), {"x"}},
      {"two parents",
       robot(kAbc + joint("j", "fixed", "a", "b") + joint("k", "fixed", "a", "c") +
             joint("l", "fixed", "b", "c")),
       {"r.urdf:8", "'l'", "'c'"}},
      {"loop beside the root",
       robot(kAbc + joint("j", "fixed", "b", "c") + joint("k", "fixed", "c", "b")),
       {"r.urdf:7", "'k'", "loop"}},
  });
  const TempFolder folder;
  expect_message(input_error([&] { (void)load_robot(folder.path() / "absent.urdf"); }),
                 {"absent.urdf"});
  expect_message(input_error([&] { (void)load_robot(folder.path()); }), {folder.path().string()});
}

TEST(Robot, BadJointsOfUrdf) {
  expect_refused({
      {"no limit", robot(kAb + joint("j", "revolute", "a", "b")), {"j"}},
      {"no prismatic limit", robot(kAb + joint("j", "prismatic", "a", "b")), {"j"}},
      {"limits crossed",
       robot(kAb + joint("j", "revolute", "a", "b", "<limit lower='1' upper='-1'/>")),
       {"r.urdf:5", "'j'", "lower"}},
      {"limit not a number",
       robot(kAb + joint("j", "revolute", "a", "b", "<limit lower='1x' upper='2'/>")),
       {"j"}},
      {"limit NaN",
       robot(kAb + joint("j", "revolute", "a", "b", "<limit lower='nan' upper='2'/>")),
       {"j"}},
      {"velocity negative",
       robot(kAb + joint("j", "continuous", "a", "b", "<limit velocity='-1'/>")),
       {"r.urdf:5", "'j'", "velocity"}},
      {"acceleration negative",
       robot(kAb + joint("j", "continuous", "a", "b", "<limit velocity='1' acceleration='-1'/>")),
       {"r.urdf:5", "'j'", "acceleration"}},
      {"jerk no number",
       robot(kAb + joint("j", "continuous", "a", "b", "<limit velocity='1' jerk='1x'/>")),
       {"r.urdf:5", "'j'", "jerk"}},
      {"zero axis",
       robot(kAb + joint("j", "revolute", "a", "b", std::string(kLimit) + "<axis xyz='0 0 0'/>")),
       {"r.urdf:5", "'j'", "axis"}},
      {"short axis",
       robot(kAb + joint("j", "revolute", "a", "b", std::string(kLimit) + "<axis xyz='0 1'/>")),
       {"j"}},
      {"no type",
       robot(kAb + "<joint name='j'><parent link='a'/><child link='b'/></joint>"),
       {"r.urdf:5", "'j'", "no joint type"}},
      {"unknown type", robot(kAb + joint("j", "hinge", "a", "b")), {"j", "hinge"}},
      {"mimic of nothing",
       robot(kAb + joint("j", "continuous", "a", "b", "<mimic joint='x'/>")),
       {"r.urdf:5", "'j'", "'x'"}},
      {"mimic of itself",
       robot(kAb + joint("j", "continuous", "a", "b", "<mimic joint='j'/>")),
       {"r.urdf:5", "'j'", "itself"}},
      {"mimic in a circle",
       robot(kAbc + joint("j", "continuous", "a", "b", "<mimic joint='k'/>") +
             joint("k", "continuous", "b", "c", "<mimic joint='j'/>")),
       {"'k'", "itself"}},
  });
}

TEST(Robot, BadShapesOfUrdf) {
  const auto shape = [](const std::string& geometry) {
    return robot("<link name='a'><collision><geometry>" + geometry +
                 "</geometry></collision></link>");
  };
  expect_refused({
      {"no geometry", shape(""), {"a"}},
      {"unknown geometry", shape("<torus/>"), {"a", "torus"}},
      {"sphere without radius", shape("<sphere/>"), {"a"}},
      {"negative radius", shape("<sphere radius='-1'/>"), {"r.urdf:3", "'a'", "radius"}},
      {"zero box", shape("<box size='1 0 1'/>"), {"r.urdf:3", "'a'", "box size"}},
      {"zero cylinder", shape("<cylinder radius='1' length='0'/>"), {"r.urdf:3", "'a'", "length"}},
      {"origin not a number",
       robot("<link name='a'><collision><origin xyz='0 0 x'/><geometry><sphere "
             "radius='1'/></geometry></collision></link>"),
       {"a"}},
      {"xacro not expanded", shape("<sphere radius='${r}'/>"), {"a", "xacro"}},
      {"mesh absent", shape("<mesh filename='absent.stl'/>"), {"r.urdf:3", "'a'", "absent.stl"}},
      {"mesh without name", shape("<mesh/>"), {"a"}},
      {"package absent",
       shape("<mesh filename='package://nowhere/box.stl'/>"),
       {"r.urdf:3", "'a'", "nowhere"}},
      {"package without file",
       shape("<mesh filename='package://nowhere'/>"),
       {"r.urdf:3", "'a'", "package://nowhere"}},
      {"scheme", shape("<mesh filename='https://x/box.stl'/>"), {"r.urdf:3", "'a'", "https"}},
      {"mesh scale zero",
       shape("<mesh filename='box.stl' scale='1 0 1'/>"),
       {"r.urdf:3", "'a'", "scale"}},
  });
}

TEST(Robot, BadSrdf) {
  const TempFolder folder;
  const fs::path urdf = folder.write("r.urdf", arm_urdf());
  const struct {
    const char* text;
    std::vector<std::string> needles;
  } cases[] = {
      {"<robot>\n<disable_collisions link1='a'/></robot>", {"r.srdf:2", "link2"}},
      {"<robot>\n<disable_collisions link1='' link2='b'/></robot>", {"r.srdf:2", "link1"}},
      {"<robot>\n<disable_collisions link1='a' link2='b' link3='c'/></robot>",
       {"r.srdf:2", "'link3'"}},
      {"<semantic/>", {"r.srdf:1", "robot"}},
      {"<robot", {"r.srdf", "not XML"}},
  };
  for (const auto& [text, needles] : cases) {
    const fs::path srdf = folder.write("r.srdf", text);
    expect_message(input_error([&] { (void)load_robot(urdf, srdf); }), needles);
  }
  expect_message(input_error([&] { (void)load_robot(urdf, folder.path() / "absent.srdf"); }),
                 {"absent.srdf"});
}

}  // namespace
}  // namespace swivel::io::test
