// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/workcell_result.hpp"

namespace swivel {

const char* to_string(WorkcellSearch search) {
  switch (search) {
    case WorkcellSearch::kArmsAlone:
      return "arms alone";
    case WorkcellSearch::kRegions:
      return "regions";
    case WorkcellSearch::kProduct:
      return "pairs of nodes";
    case WorkcellSearch::kNone:
      break;
  }
  return "none";
}

}  // namespace swivel
