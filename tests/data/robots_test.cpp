// SPDX-License-Identifier: BSD-3-Clause
// The robot models and problems of data/ that are not S-R-S arms.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/io/io.hpp"

namespace swivel {
namespace {

const std::filesystem::path kData = SWIVEL_DATA_DIR;

TEST(Robots, HaveOneCapsuleALink) {
  for (const std::string name :
       {"panda_like", "xarm7_like", "gen3_like", "fetch_like", "ur5e_like", "kr6_like"}) {
    const auto model =
        io::load_robot(kData / "robots" / (name + ".urdf"), kData / "robots" / (name + ".srdf"));
    const bool six = name == "ur5e_like" || name == "kr6_like";
    const auto roll = six ? std::optional(Roll{}) : std::nullopt;
    int links = 0;
    for (const Link& link : model->links) {
      if (link.name == "base_link" || link.name == "flange") continue;
      ++links;
      // The reader makes one capsule of a cylinder and two spheres, where they fit.
      const ArmModel arm = build_arm(*model, "base_link", "flange", {}, Pose::Identity(), roll);
      int shapes = 0;
      for (const RobotBody& body : robot_bodies(*model, arm, {})) {
        if (body.name != link.name) continue;
        ++shapes;
        EXPECT_TRUE(std::holds_alternative<Capsule>(body.shape)) << name << " " << link.name;
      }
      EXPECT_EQ(shapes, 1) << name << " " << link.name;
    }
    EXPECT_EQ(links, six ? 6 : 7);
  }
}

TEST(Robots, AreOfTheClassesTheyAreLike) {
  const std::map<std::string, std::string> words{
      {"panda_like", "closed form: axes 1, 2 and 3 meet in a point; locks joint 5 (or 4, 6, 7)"},
      {"xarm7_like", "closed form: axes 1, 2 and 3 meet in a point; locks joint 5 (or 4, 6, 7)"},
      {"gen3_like",
       "closed form: axes 5, 6 and 7 meet in a point within 0.18 mm; locks joint 3 (or 1, 2, 4)"},
      {"fetch_like", "closed form: axes 5, 6 and 7 meet in a point; locks joint 3 (or 1, 2, 4)"},
      {"ur5e_like", "closed form: axes 2, 3 and 4 are parallel; locks the roll (or joint 5, 6)"},
      {"kr6_like", "closed form: axes 4, 5 and 6 meet in a point; locks the roll"}};
  Pose torch = Pose::Identity();
  torch.translation() << 0.05, 0, 0.2;
  torch.rotate(Eigen::AngleAxisd(0.7, Vector3d::UnitY()));
  for (const auto& [name, expected] : words) {
    const auto model = io::load_robot(kData / "robots" / (name + ".urdf"));
    const bool six = name == "ur5e_like" || name == "kr6_like";
    const ArmModel arm =
        build_arm(*model, "base_link", "flange", {}, six ? torch : Pose::Identity(),
                  six ? std::optional(Roll{}) : std::nullopt);
    const ArmClass found = classify(arm.chain, name);
    EXPECT_EQ(found.kind, ArmKind::kArcs);
    EXPECT_EQ(found.lock.words(), expected) << name;
  }
}

TEST(Problems, OfArmsWithArcsHaveMotionsThatKeepTheLimits) {
  int rows = 0;
  for (const std::string name :
       {"panda_weld_seam", "xarm7_polish_raster", "gen3_glue_bead", "fetch_wipe_table",
        "kr6_weld_pipe", "ur5e_deburr_edge", "panda_polish_cover"}) {
    PathProblem problem = io::load_path_problem(kData / "problems" / (name + ".yaml"));
    problem.resolution.ds = 0.02;
    const ArmModel arm = build_arm(*problem.model, problem.base_link, problem.tip_link,
                                   problem.hold, problem.tool, problem.roll);
    EXPECT_TRUE(World(*problem.model, arm, problem).warnings().empty()) << name;
    const ArmClass found = classify(arm.chain, name);
    const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
    std::unique_ptr<Lattice> lattice =
        std::make_unique<ArcLattice>(arm.chain, found.lock, path, problem);
    std::vector<Config> unwrapped;
    for (int attempt = 0; attempt < 3; ++attempt) {
      const auto cost_to_go = make_cost_to_go(*lattice);
      cost_to_go->sweep(lattice->layers() - 1);
      std::int64_t expansions = 0;
      const SlotPath slots = best_path(*cost_to_go, expansions);
      ASSERT_EQ(slots.size(), static_cast<std::size_t>(lattice->layers())) << name;
      unwrapped = lattice->path_joints(slots);
      const Lattice::Joints off = lattice->off_limits(slots);
      if (off == Lattice::Joints{}) break;
      lattice = lattice->with_windings(off);
    }
    ASSERT_FALSE(unwrapped.empty()) << name;
    for (const Config& q : unwrapped) {
      ++rows;
      for (std::size_t j = 0; j < kDof; ++j) {
        const JointLimit& limit = arm.chain.limit[j];
        const double x = q[static_cast<Eigen::Index>(j)];
        EXPECT_TRUE(limit.continuous || (x >= limit.lower && x <= limit.upper)) << name;
      }
    }
  }
  EXPECT_GT(rows, 200);
}

}  // namespace
}  // namespace swivel
