// SPDX-License-Identifier: BSD-3-Clause
// Bodies of the scene whose poses are in the frame of a link.
#include "problem_support.hpp"

namespace swivel::io::test {
namespace {

TEST(SceneFrames, FixABodyToItsLink) {
  const ProblemFolder folder;
  const PathProblem problem =
      folder.load({{"scene",
                    "[{name: post, box: [0.1, 0.1, 1], xyz: [0.5, 0, 0.5]},"
                    " {name: shelf, sphere: 0.1, xyz: [0.1, 0.2, 0.3], frame: link_2},"
                    " {name: floor, box: [3, 3, 0.1], xyz: [0, 0, -0.2], frame: base_link, allow: "
                    "[link_1]}]"}});
  ASSERT_EQ(2U, problem.scene.size());
  EXPECT_EQ("post", problem.scene[0].name);
  EXPECT_EQ("floor", problem.scene[1].name);
  EXPECT_EQ(1U, problem.scene[1].allow.size());
  ASSERT_EQ(1U, problem.attached.size());
  EXPECT_EQ("shelf", problem.attached[0].name);
  EXPECT_EQ("link_2", problem.attached[0].link);
  EXPECT_EQ(Vector3d(0.1, 0.2, 0.3), problem.attached[0].pose.translation());
}

TEST(SceneFrames, RefuseWhatAMovingBodyCannotHave) {
  const ProblemFolder folder;
  const auto refused = [&](const ProblemFolder::Sections& sections,
                           const std::vector<std::string>& words) {
    expect_message(input_error([&] { static_cast<void>(folder.load(sections)); }), words);
  };
  const std::string shelf = "{name: shelf, sphere: 0.1, frame: link_2";
  refused({{"scene", "[{name: shelf, sphere: 0.1, frame: lnk_2}]"}},
          {"scene[0].frame", "unknown link 'lnk_2', nearest is 'link_2'"});
  refused({{"scene", "[" + shelf + ", allow: [link_1]}]"}},
          {"scene[0].allow", "fixed to link 'link_2'"});
  refused({{"scene", "[" + shelf + "}, " + shelf + "}]"}}, {"scene[1].name", "'shelf'"});
  refused({{"scene", "[" + shelf + "}]"}, {"path", "{frame: shelf, file: weld.csv}"}},
          {"path.frame", "unknown frame 'shelf'", "in its frame"});
  refused({{"scene", "[" + shelf + "}]"}, {"vary", "[{object: shelf}]"}},
          {"vary[0].object", "'shelf'"});
}

}  // namespace
}  // namespace swivel::io::test
