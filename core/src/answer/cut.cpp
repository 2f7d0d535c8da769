// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/cut.hpp"

namespace swivel {

CutCounts count(const Cut& cut) {
  CutCounts counts;
  counts.by_witness.resize(cut.witnesses.size());
  const auto of = [](const Cut::Range& range) { return static_cast<std::int64_t>(range.last) - range.first + 1; };
  for (const Cut::Layer& layer : cut.band) {
    for (const Cut::Range& range : layer.reached) counts.reached += of(range);
    for (const Cut::Nodes& nodes : layer.removed)
      counts.by_witness.at(static_cast<std::size_t>(nodes.witness)).nodes += of(nodes.slots);
    for (const Cut::Edges& edges : layer.edges) counts.by_witness.at(static_cast<std::size_t>(edges.witness)).edges += edges.count;
  }
  return counts;
}

}  // namespace swivel
