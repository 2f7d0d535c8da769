// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"

namespace swivel::io::test {

namespace fs = std::filesystem;

/// A folder that is removed when the test ends.
class TempFolder {
 public:
  TempFolder() {
    static std::atomic<int> count{0};
    path_ = fs::temp_directory_path() /
            ("swivel_io_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    fs::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }
  fs::path write(const std::string& name, const std::string& text) const {
    const fs::path file = path_ / name;
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  [[nodiscard]] static std::string read(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }

 private:
  fs::path path_;
};

/// Returns the message of the InputError that `call` throws; a test failure and "" when it throws
/// nothing or something else.
template <class Call>
std::string input_error(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "not an InputError: " << error.what();
    return "";
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

/// Expects the message to be one line that says what is allowed and holds every needle.
inline void expect_message(const std::string& message, const std::vector<std::string>& needles) {
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_NE(message.find("allowed"), std::string::npos) << message;
  for (const std::string& needle : needles)
    EXPECT_NE(message.find(needle), std::string::npos) << "'" << needle << "' not in: " << message;
}

/// Returns a box as ASCII STL: outward triangles, corners at the origin and (x, y, z).
inline std::string box_stl(double x = 1, double y = 2, double z = 3) {
  // Faces of the corners numbered by bits x y z.
  constexpr std::array<std::array<int, 3>, 12> kTriangles{{{0, 2, 3},
                                                           {0, 3, 1},
                                                           {4, 5, 7},
                                                           {4, 7, 6},
                                                           {0, 1, 5},
                                                           {0, 5, 4},
                                                           {2, 6, 7},
                                                           {2, 7, 3},
                                                           {0, 4, 6},
                                                           {0, 6, 2},
                                                           {1, 3, 7},
                                                           {1, 7, 5}}};
  std::ostringstream text;
  text << "solid box\n";
  for (const auto& triangle : kTriangles) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int corner : triangle)
      text << "vertex " << (corner & 1 ? x : 0) << ' ' << (corner & 2 ? y : 0) << ' '
           << (corner & 4 ? z : 0) << '\n';
    text << "endloop\nendfacet\n";
  }
  text << "endsolid box\n";
  return text.str();
}

/// Returns the signed volume of the mesh, positive where its triangles turn outwards.
inline double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto vertex = [&](std::size_t k) { return mesh.vertices[t[k]]; };
    sum += vertex(0).dot(vertex(1).cross(vertex(2)));
  }
  return sum / 6;
}

/// Returns the URDF of an arm with base_link, link_1 ... link_7 on joint_1 ... joint_7, and a
/// finger on a prismatic joint.
inline std::string arm_urdf() {
  std::string text = "<robot name='arm'>\n<link name='base_link'/>\n";
  for (int k = 1; k <= 7; ++k) {
    const std::string n = std::to_string(k),
                      parent = k == 1 ? "base_link" : "link_" + std::to_string(k - 1);
    text += "<link name='link_" + n +
            "'><collision><geometry><sphere radius='0.05'/></geometry></collision></link>\n";
    text += "<joint name='joint_" + n + "' type='revolute'><parent link='" + parent +
            "'/><child link='link_" + n + "'/>" + "<origin xyz='0 0 0.2'/><axis xyz='" +
            (k % 2 != 0 ? "0 0 1" : "0 1 0") +
            "'/><limit lower='-2' upper='2.5' velocity='1' effort='0'/></joint>\n";
  }
  return text +
         "<link name='finger'/>\n<joint name='finger_joint' type='prismatic'><parent "
         "link='link_7'/><child link='finger'/>"
         "<limit lower='0' upper='0.04' velocity='0' effort='0'/></joint>\n</robot>\n";
}

/// Returns a motion in the format of the file name's ending, as it is written of an answer.
/// `joint_names` are those of each arm.
inline std::string text_of_motion(const Motion& motion, const Problem& problem,
                                  const std::vector<JointNames>& joint_names,
                                  const std::string& name) {
  Answer answer;
  answer.arms.resize(motion.arms.size());
  for (std::size_t k = 0; k < answer.arms.size(); ++k) {
    answer.arms[k].name = motion.arms[k].name;
    answer.arms[k].joint_names = joint_names.at(k);
  }
  answer.motion.emplace().motion = motion;
  return motion_text(answer, problem, name);
}

}  // namespace swivel::io::test
