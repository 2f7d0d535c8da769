// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <map>

#include "io_support.hpp"

namespace swivel::io::test {

/// A folder with a good robot, mesh and path, and problem files made of sections.
class ProblemFolder {
 public:
  using Sections = std::map<std::string, std::string>;

  ProblemFolder() {
    folder_.write("robots/arm.urdf", arm_urdf());
    folder_.write("robots/arm.srdf",
                  "<robot name='arm'><disable_collisions link1='link_1' link2='link_3'/></robot>");
    folder_.write("problems/box.stl", box_stl());
    folder_.write("problems/weld.csv", "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n1,0,0,1,0,0,0\n");
  }

  [[nodiscard]] static Sections good() {
    return {{"robot", "{urdf: ../robots/arm.urdf, base_link: base_link, tip_link: link_7}"},
            {"path", "{file: weld.csv}"}};
  }
  /// Sections of `changes` replace or join the good ones; an empty text leaves the section out.
  [[nodiscard]] fs::path write(const Sections& changes) const {
    Sections sections = good();
    for (const auto& [name, text] : changes) sections[name] = text;
    std::string yaml;
    for (const auto& [name, text] : sections)
      if (!text.empty()) yaml += name + ": " + text + "\n";
    return folder_.write("problems/problem.yaml", yaml);
  }
  [[nodiscard]] PathProblem load(const Sections& changes) const {
    return load_path_problem(write(changes));
  }
  [[nodiscard]] const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_;
};

/// Returns the good robot section with more keys.
inline std::string robot_with(const std::string& more) {
  return "{urdf: ../robots/arm.urdf, base_link: base_link, tip_link: link_7, " + more + "}";
}

}  // namespace swivel::io::test
