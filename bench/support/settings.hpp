// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/path_problem.hpp"

namespace swivel::bench {

struct Setting {
  const char* name;
  double ds,
      /// ds: m; dphi: rad, of arm angles and rolls, or of self-motion if the arm has no arm angle.
      dphi;
};
/// The four resolutions of the paper's Table I, and two finer ones.
inline constexpr Setting kSettings[] = {{"#1", 0.02, 0.2},     {"#2", 0.005, 0.2},
                                        {"#3", 0.02, 0.05},    {"#4", 0.005, 0.05},
                                        {"fine", 0.002, 0.02}, {"finest", 0.001, 0.01}};
inline constexpr int kPaperSettings = 4;

inline void set_resolution(PathProblem& problem, const Setting& setting) {
  problem.resolution.ds = setting.ds;
  problem.resolution.dphi = problem.resolution.droll = setting.dphi;
  problem.resolution.arc = setting.dphi;
}

}  // namespace swivel::bench
