// SPDX-License-Identifier: BSD-3-Clause
// The robots and problems of the project, and real descriptions where they lie beside the source
// tree.
#include <cstdlib>

#include "io_support.hpp"

namespace swivel::io::test {
namespace {

std::size_t count_collisions(const RobotModel& robot) {
  std::size_t count = 0;
  for (const Link& link : robot.links) count += link.collision.size();
  return count;
}

TEST(Data, EveryProblemLoads) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(SWIVEL_DATA_DIR))) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path().string());
    ++count;
    try {
      const Problem problem = load_problem(entry.path());
      EXPECT_NO_THROW(validate(problem));
      if (is_path(problem)) EXPECT_GE(problem.arm().path().waypoints.size(), 2u);
    } catch (const InputError& error) {
      ADD_FAILURE() << error.what();
    }
  }
  EXPECT_GT(count, 0);
}

class SharedData : public testing::Test {
 protected:
  void SetUp() override {
    const char* const given = std::getenv("SWIVEL_SHARED");
    root_ = fs::path(given ? given : "") / "data";
    if (!given || !fs::is_directory(root_))
      GTEST_SKIP() << "SWIVEL_SHARED names no folder with data";
  }
  fs::path root_;
};

TEST_F(SharedData, Sda5fAsItsAuthorsCheckedItIn) {
  const fs::path folder = root_ / "motoman_sda5f";
  const auto robot = load_robot(folder / "motoman_sda5f_support/urdf/sda5f_checked_in.urdf",
                                folder / "motoman_sda5f.srdf");
  EXPECT_EQ(robot->links.size(), 19u);
  EXPECT_EQ(robot->joints.size(), 18u);
  EXPECT_EQ(robot->disabled_pairs.size(), 58u);
  ASSERT_EQ(robot->warnings.size(), 1u);  // a call of the macro that is expanded above it
  EXPECT_NE(robot->warnings[0].find("sda5f_checked_in.urdf:415: element <xacro:motoman_sda5f>"),
            std::string::npos);
  EXPECT_EQ(count_collisions(*robot), 17u);
  const Joint& mimic = robot->joints[robot->find_joint("torso_joint_b2")];
  ASSERT_TRUE(mimic.mimic);
  EXPECT_EQ(mimic.mimic->joint, robot->find_joint("torso_joint_b1"));
  EXPECT_EQ(robot->links[robot->root_link].name, "base_link");
}

TEST_F(SharedData, Sda5fExpanded) {
  const fs::path folder = root_ / "motoman_sda5f";
  const auto robot = load_robot(folder / "motoman_sda5f_support/urdf/sda5f_expanded.urdf");
  EXPECT_EQ(robot->links.size(), 19u);
  EXPECT_EQ(robot->joints.size(), 18u);
  EXPECT_FALSE(robot->has_srdf);
  EXPECT_EQ(count_collisions(*robot), 17u);
}

/// The Z_UP trap: the drawing file and the collision file of one link must agree about where the
/// link is.
TEST_F(SharedData, ZUpDaeAgreesWithItsStl) {
  const fs::path meshes = root_ / "motoman_sda5f/motoman_sda5f_support/meshes";
  MeshCache cache;
  const auto box = [&](const fs::path& file) {
    Eigen::AlignedBox3d result;
    for (const Vector3d& v : load_mesh(file, Vector3d::Ones(), cache)->vertices) result.extend(v);
    return result;
  };
  const Eigen::AlignedBox3d dae = box(meshes / "dae/arm_left_link_1_s.dae"),
                            stl = box(meshes / "collision/arm_left_link_1_s.STL");
  EXPECT_LT((dae.min() - stl.min()).norm(), 0.03);
  EXPECT_LT((dae.max() - stl.max()).norm(), 0.03);
}

TEST_F(SharedData, PuzzleCell) {
  const fs::path urdf = root_ / "puzzle_cell/tesseract/support/urdf";
  const auto robot =
      load_robot(urdf / "puzzle_piece_workcell.urdf", urdf / "puzzle_piece_workcell.srdf");
  EXPECT_EQ(robot->links.size(), 20u);
  EXPECT_EQ(robot->joints.size(), 19u);
  EXPECT_EQ(robot->disabled_pairs.size(), 48u);
}

TEST_F(SharedData, Paths) {
  EXPECT_EQ(load_path(root_ / "paths/puzzle_bent_iiwa14_base_to_part.csv").size(), 437u);
  EXPECT_EQ(load_path(root_ / "paths/paper_experiment_A_line.csv").size(), 501u);
}

}  // namespace
}  // namespace swivel::io::test
