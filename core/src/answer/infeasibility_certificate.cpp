// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/infeasibility_certificate.hpp"

namespace swivel {

CertificateCounts count(const InfeasibilityCertificate& certificate) {
  CertificateCounts counts;
  counts.by_witness.resize(certificate.witnesses.size());
  const auto of = [](const InfeasibilityCertificate::Range& range) {
    return static_cast<std::int64_t>(range.last) - range.first + 1;
  };
  for (const InfeasibilityCertificate::Layer& layer : certificate.band) {
    for (const InfeasibilityCertificate::Range& range : layer.reached) counts.reached += of(range);
    for (const InfeasibilityCertificate::Nodes& nodes : layer.removed)
      counts.by_witness.at(static_cast<std::size_t>(nodes.witness)).nodes += of(nodes.slots);
    for (const InfeasibilityCertificate::Edges& edges : layer.edges)
      counts.by_witness.at(static_cast<std::size_t>(edges.witness)).edges += edges.count;
  }
  return counts;
}

}  // namespace swivel
