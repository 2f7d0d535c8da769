// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/base/budget.hpp"

namespace swivel {

const char* to_string(Stage stage) {
  switch (stage) {
    case Stage::kPreparing:
      return "preparing the robot";
    case Stage::kLattice:
      return "laying out the lattice";
    case Stage::kBounds:
      return "bounding costs";
    case Stage::kSweep:
      return "sweeping the lattice";
    case Stage::kSearch:
      return "searching";
    case Stage::kReach:
      return "no path; seeking the furthest layer";
    case Stage::kProving:
      return "proving the answer";
    case Stage::kMeasuring:
      return "measuring the trajectory";
    case Stage::kDiagnosis:
      return "no path; finding out why";
    case Stage::kDrawing:
      return "drawing";
  }
  return "?";
}

}  // namespace swivel
