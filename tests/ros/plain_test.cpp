// SPDX-License-Identifier: BSD-3-Clause
// The mapping of compute_cartesian_path with plain structs, and what the service does with scenes.
#include <thread>

#include "rows.hpp"

namespace swivel {

namespace {

TEST(Convert, RowsOfPlainStructs) {
  test::expect_rows<test::plain::Messages>();
}

TEST(Convert, MembersThatOlderRequestsLack) {
  const ros::Query old = ros::to_query(test::plain::OldRequest());
  EXPECT_EQ(old.speed_scale, 0);
  EXPECT_EQ(old.tool_speed, 0);
  test::plain::NewRequest request;
  request.max_velocity_scaling_factor = 0.25;
  request.max_acceleration_scaling_factor = 0.5;
  request.max_cartesian_speed = 0.1;
  request.cartesian_speed_limited_link = "tool0";
  const ros::Query query = ros::to_query(request);
  EXPECT_EQ(query.speed_scale, 0.25);
  EXPECT_EQ(query.acceleration_scale, 0.5);
  EXPECT_EQ(query.tool_speed, 0.1);
  EXPECT_EQ(query.speed_link, "tool0");
}

ros::Query line() {
  return ros::to_query(test::line_request<test::plain::Request>());
}

double seconds(const ros::Answer& answer) {
  return answer.points.empty() ? 0 : answer.points.back().time;
}

TEST(Convert, SpeedsAndScales) {
  const auto service = test::iiwa_service();
  const ros::Answer fast = service->answer(line(), {});
  ASSERT_EQ(fast.fraction, 1) << fast.words;
  ros::Query query = line();
  query.tool_speed = 0.05;
  const ros::Answer slow = service->answer(query, {});
  EXPECT_GT(seconds(slow), 0.2 / 0.05);
  query.speed_link = "link_4";
  EXPECT_EQ(service->answer(query, {}).code, ros::kFailure);
  query = line();
  query.speed_scale = 0.1;
  EXPECT_GT(seconds(service->answer(query, {})), 2 * seconds(fast));
  query.speed_scale = 7;  // as MoveIt has it, no scale at all
  EXPECT_EQ(seconds(service->answer(query, {})), seconds(fast));
  double before = -1;
  for (const ros::Point& point : fast.points) {
    EXPECT_GT(point.time, before);
    before = point.time;
  }
  for (const double v : fast.points.back().velocities) EXPECT_NEAR(v, 0, 1e-6);
}

TEST(Convert, WaypointsInTheLinksFrameFollowEachOther) {
  const auto service = test::iiwa_service();
  ros::Query steps = line();
  steps.frame = "tool0";
  steps.waypoints = {{0.05, 0, 0, 1, 0, 0, 0}, {0.05, 0, 0, 1, 0, 0, 0}};
  ros::Query one = steps;
  one.waypoints = {{0.1, 0, 0, 1, 0, 0, 0}};
  const ros::Answer a = service->answer(steps, {}), b = service->answer(one, {});
  ASSERT_EQ(a.fraction, 1) << a.words;
  ASSERT_EQ(b.fraction, 1) << b.words;
  for (std::size_t j = 0; j < 7; ++j)
    EXPECT_NEAR(a.points.back().positions[j], b.points.back().positions[j], 1e-6);
}

TEST(Convert, PlacesPosesByTransforms) {
  struct {
    test::plain::Vector translation{1, 2, 3};
    test::plain::Quaternion rotation{0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  } quarter_turn_about_z;
  ros::Pose7 pose{0.5, 0, 0.25, 0.9, 0.1, 0, 0};
  ros::place(quarter_turn_about_z, pose);
  EXPECT_NEAR(pose.x, 1, 1e-12);
  EXPECT_NEAR(pose.y, 2.5, 1e-12);
  EXPECT_NEAR(pose.z, 3.25, 1e-12);
  const double half = std::sqrt(0.5);
  EXPECT_NEAR(pose.qw, half * 0.9, 1e-12);
  EXPECT_NEAR(pose.qx, half * 0.1, 1e-12);
  EXPECT_NEAR(pose.qy, half * 0.1, 1e-12);
  EXPECT_NEAR(pose.qz, half * 0.9, 1e-12);
}

TEST(Convert, WhereTheRobotIsMustBeKnown) {
  ros::PathService service(test::data_text("iiwa14.urdf"), test::data_text("iiwa14.srdf"), {});
  EXPECT_EQ(service.answer(line(), {}).code, ros::kRobotStateStale);
  service.state({{"joint_a1", "gripper"}, {0, 0}});
  const ros::Answer answer = service.answer(line(), {});
  EXPECT_EQ(answer.code, ros::kRobotStateStale);
  EXPECT_NE(answer.words.find("joint_a2"), std::string::npos) << answer.words;
}

/// A scene message with one box.
test::plain::PlanningScene box_scene(double y, int operation) {
  test::plain::PlanningScene scene;
  scene.is_diff = true;
  auto& object = scene.world.collision_objects.emplace_back();
  object.id = "box";
  test::set_shift(object.pose, 0.6, y, 0.4);
  object.primitives.resize(1);
  object.primitives[0].type = 1;
  object.primitives[0].dimensions = {0.1, 0.02, 0.1};
  object.operation = static_cast<std::uint8_t>(operation);
  return scene;
}

void send(ros::PathService& service, const test::plain::PlanningScene& scene) {
  const ros::SceneChange change = ros::to_scene(scene);
  EXPECT_TRUE(service.world(change.bodies, change.diff, change.allowed, {}).empty());
  if (change.says_unchecked) service.unchecked(change.unchecked);
}

TEST(Convert, ObjectsComeMoveAndGo) {
  const auto service = test::iiwa_service();
  const auto fraction = [&] { return service->answer(line(), {}).fraction; };
  EXPECT_EQ(fraction(), 1);
  send(*service, box_scene(0.15, ros::Body::kAdd));
  const double blocked = fraction();
  EXPECT_LT(blocked, 1);
  auto move = box_scene(0.1, ros::Body::kMove);
  move.world.collision_objects[0].primitives.clear();
  send(*service, move);
  EXPECT_LT(fraction(), blocked);
  auto more = box_scene(0.5, ros::Body::kAppend);
  send(*service, more);
  EXPECT_LT(fraction(), blocked);
  send(*service, box_scene(0, ros::Body::kRemove));
  EXPECT_EQ(fraction(), 1);
  send(*service, box_scene(0.1, ros::Body::kAdd));
  test::plain::PlanningScene empty;  // not a diff: nothing is there any more
  send(*service, empty);
  EXPECT_EQ(fraction(), 1);
}

TEST(Convert, ShapesOfObjects) {
  const auto service = test::iiwa_service();
  for (const int kind : {1, 2, 3, 4}) {
    auto scene = box_scene(0.12, ros::Body::kAdd);
    scene.world.collision_objects[0].primitives[0].type = static_cast<std::uint8_t>(kind);
    scene.world.collision_objects[0].primitives[0].dimensions = {0.05, 0.05, 0.05};
    send(*service, scene);
    EXPECT_LT(service->answer(line(), {}).fraction, 1) << kind;
  }
  auto scene = box_scene(0.12, ros::Body::kAdd);
  auto& object = scene.world.collision_objects[0];
  object.primitives.clear();
  object.meshes.resize(1);
  object.meshes[0].vertices = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  object.meshes[0].triangles = {{{0, 2, 1}}, {{0, 1, 3}}, {{0, 3, 2}}, {{1, 2, 3}}};
  send(*service, scene);
  EXPECT_LT(service->answer(line(), {}).fraction, 1);
  const auto fault = [&](const test::plain::PlanningScene& wrong) {
    const ros::SceneChange change = ros::to_scene(wrong);
    const auto faults = service->world(change.bodies, true, {}, {});
    return faults.empty() ? std::string() : faults.front();
  };
  object.meshes[0].triangles[0].vertex_indices[0] = 4;
  EXPECT_NE(fault(scene).find("makes no sense"), std::string::npos);
  object.meshes.clear();
  object.planes.resize(1);
  EXPECT_NE(fault(scene).find("planes"), std::string::npos);
  object.planes.clear();
  object.primitives.resize(2);
  EXPECT_NE(fault(scene).find("2 primitives and 0 poses"), std::string::npos);
  scene = box_scene(0.12, ros::Body::kAdd);
  scene.world.collision_objects[0].header.frame_id = "nowhere";
  EXPECT_NE(fault(scene).find("unknown frame"), std::string::npos);
  scene = box_scene(0.12, ros::Body::kAdd);
  scene.world.collision_objects[0].id = "link_3";
  EXPECT_NE(fault(scene).find("name of its own"), std::string::npos);
}

TEST(Convert, AllowedCollisions) {
  const auto service = test::iiwa_service();
  auto scene = box_scene(0.1, ros::Body::kAdd);
  send(*service, scene);
  EXPECT_LT(service->answer(line(), {}).fraction, 1);
  auto& matrix = scene.allowed_collision_matrix;
  matrix.entry_names = {"base_link", "link_1", "link_2", "link_3", "link_4",
                        "link_5",    "link_6", "link_7", "tool0",  "box"};
  const std::size_t count = matrix.entry_names.size();
  matrix.entry_values.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    matrix.entry_values[i].enabled.assign(count, false);
    for (std::size_t j = 0; j < count; ++j)  // neighbours, and the box with everything
      if (i + 1 == j || j + 1 == i || i + 1 == count || j + 1 == count)
        matrix.entry_values[i].enabled[j] = true;
  }
  send(*service, scene);
  EXPECT_EQ(service->answer(line(), {}).fraction, 1);
  matrix = {};
  matrix.default_entry_names = {"box"};
  matrix.default_entry_values = {true};
  send(*service, scene);
  EXPECT_EQ(service->answer(line(), {}).fraction, 1);
  matrix.entry_names = {"box", "link_6"};  // what is said of a pair counts more than defaults
  matrix.entry_values.resize(2);
  for (auto& entry : matrix.entry_values) entry.enabled.assign(2, false);
  send(*service, scene);
  EXPECT_LT(service->answer(line(), {}).fraction, 1);
}

TEST(Convert, AttachedObjectsOfTheScene) {
  const auto service = test::iiwa_service();
  send(*service, box_scene(0.15, ros::Body::kAdd));
  test::plain::PlanningScene scene;
  scene.is_diff = true;
  auto& attached = scene.robot_state.attached_collision_objects.emplace_back();
  attached.link_name = "link_7";
  attached.touch_links = {"link_7", "link_6", "link_5"};
  attached.object.id = "box";  // what stood in the world is taken up
  send(*service, scene);
  const ros::Answer taken = service->answer(line(), {});
  EXPECT_EQ(taken.fraction, 1) << taken.words;
  attached.object.operation = ros::Body::kRemove;  // and put down where it was
  send(*service, scene);
  EXPECT_LT(service->answer(line(), {}).fraction, 1);
}

TEST(Convert, WhatIsNotChecked) {
  const auto service = test::iiwa_service();
  test::plain::PlanningScene scene;
  scene.is_diff = true;
  scene.world.octomap.octomap.data = {1};
  scene.link_padding.push_back({"link_3", 0.01});
  EXPECT_EQ(ros::to_scene(scene).warnings.size(), 1u);
  send(*service, scene);
  EXPECT_EQ(service->answer(line(), {}).code, ros::kCollisionCheckingUnavailable);
  ros::Query query = line();
  query.avoid_collisions = false;
  EXPECT_EQ(service->answer(query, {}).code, ros::kSuccess);
}

TEST(Convert, SixJointsKeepThePoseOrTurnTheTool) {
  const std::string urdf = test::data_text("ur5e_like.urdf"),
                    srdf = test::data_text("ur5e_like.srdf");
  const ros::JointValues state{{"joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6"},
                               {0.3, -1.2, 1.8, -2.1, -1.5, 0.2}};
  ros::Query query = line();
  query.frame = "flange";
  query.waypoints = {{0, 0, -0.05, 1, 0, 0, 0}};
  ros::Settings settings;
  for (const double roll : {0.0, 0.5}) {
    settings.roll = roll;
    ros::PathService service(urdf, srdf, settings);
    service.state(state);
    const ros::Answer answer = service.answer(query, {});
    EXPECT_EQ(answer.fraction, 1) << answer.words;
    ASSERT_FALSE(answer.points.empty());
    EXPECT_EQ(answer.points[0].positions.size(), 6u);
    EXPECT_FALSE(answer.points[0].velocities.empty());
    for (std::size_t j = 0; j < 6; ++j)
      EXPECT_NEAR(answer.points[0].positions[j], state.positions[j], 1e-9);
  }
}

TEST(Convert, FurtherJointsOfTheGroupAreHeldWhereTheyAre) {
  std::string urdf = test::data_text("iiwa14.urdf"), srdf = test::data_text("iiwa14.srdf");
  urdf.insert(urdf.rfind("</robot>"),
              "<link name='world'/><joint name='rail' type='prismatic'><parent link='world'/>"
              "<child link='base_link'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' "
              "velocity='1' effort='0'/></joint>");
  srdf.replace(srdf.find("base_link=\"base_link\""), 21, "base_link=\"world\"");
  ros::PathService service(urdf, srdf, {});
  EXPECT_EQ(service.frame(), "world");
  service.state(
      {{"rail", "joint_a1", "joint_a2", "joint_a3", "joint_a4", "joint_a5", "joint_a6", "joint_a7"},
       {0.5, 0, 0.6, 0, -1.5, 0, 1.0, 0}});
  ros::Query query = line();  // whose poses are in base_link, which stands on the rail
  const ros::Answer moved = service.answer(query, {}),
                    fixed = test::iiwa_service()->answer(query, {});
  ASSERT_EQ(moved.fraction, 1) << moved.words;
  EXPECT_EQ(moved.frame, "world");
  ASSERT_EQ(moved.joints.size(), 8u);
  EXPECT_EQ(moved.joints[0], "rail");
  for (const ros::Point& point : moved.points) EXPECT_EQ(point.positions[0], 0.5);
  for (std::size_t j = 0; j < 7; ++j)
    EXPECT_NEAR(moved.points.back().positions[j + 1], fixed.points.back().positions[j], 1e-3);
  query.frame = "world";  // half a metre away
  const ros::Answer other = service.answer(query, {});
  ASSERT_EQ(other.fraction, 1) << other.words;
  EXPECT_LT(other.points.back().positions[1], moved.points.back().positions[1] - 0.3);
}

TEST(Convert, BandsOfJointsThatTurnForEver) {
  ros::PathService service(test::data_text("fetch_like.urdf"), test::data_text("fetch_like.srdf"),
                           {});
  const double turns = 4 * 3.14159265358979323846;
  service.state({{"joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6", "joint_7"},
                 {0.1, 0.3, 0.2 + turns, 1.0, 0.1, 1.0, 0.3}});
  ros::Query query = line();
  query.frame = "flange";
  query.waypoints = {{0, 0, -0.05, 1, 0, 0, 0}};
  query.bands = {{"joint_3", 0.2, 0.3, 0.3}};
  const ros::Answer answer = service.answer(query, {});
  ASSERT_EQ(answer.fraction, 1) << answer.words;
  for (const ros::Point& point : answer.points) {
    EXPECT_GE(point.positions[2], turns - 0.1 - 1e-9);
    EXPECT_LE(point.positions[2], turns + 0.5 + 1e-9);
  }
  query.bands = {{"joint_3", 1.2, 0.3, 0.3}};
  EXPECT_EQ(service.answer(query, {}).fraction, 0);
  EXPECT_EQ(service.answer(query, {}).code, ros::kSuccess);
}

TEST(Convert, StoppedServicesAnswerAtOnce) {
  const auto service = test::iiwa_service();
  service->stop();
  const ros::Answer answer = service->answer(line(), {});
  EXPECT_EQ(answer.fraction, 0);
  EXPECT_NE(answer.words.find("cancelled"), std::string::npos) << answer.words;
}

TEST(Convert, ManyThreadsAtOnce) {
  const auto service = test::iiwa_service();
  const ros::Answer alone = service->answer(line(), {});
  std::vector<std::thread> threads;
  std::vector<int> equal(4);
  for (int& count : equal)
    threads.emplace_back([&] {
      for (int k = 0; k < 10; ++k) {
        const ros::Answer answer = service->answer(line(), {});
        bool same = answer.points.size() == alone.points.size();
        for (std::size_t i = 0; same && i < alone.points.size(); ++i)
          same = answer.points[i].positions == alone.points[i].positions;
        count += same ? 1 : 0;
      }
    });
  for (int k = 0; k < 100; ++k) {  // meanwhile, far away
    send(*service, box_scene(3 + 0.01 * k, ros::Body::kAdd));
    service->state({{"joint_a1"}, {0}});
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : equal) EXPECT_EQ(count, 10);
}

TEST(Convert, BadTexts) {
  EXPECT_THROW(ros::PathService("<robot", "", {}), std::runtime_error);
  ros::Settings settings;
  settings.rate = 0;
  EXPECT_THROW(ros::PathService(test::data_text("iiwa14.urdf"), "", settings), std::runtime_error);
}

}  // namespace

}  // namespace swivel
