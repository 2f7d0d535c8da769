// SPDX-License-Identifier: BSD-3-Clause
#include "posture_beside.hpp"

#include <array>
#include <cmath>

namespace swivel {

namespace {

/// One step along the self-motion: the way that leads on in the direction of `way`, brought back to the pose by Newton steps of
/// least norm. `way` becomes the tangent at its end.
std::optional<Config> step(const Chain& chain, const Pose& tool, const Config& from, double length, Config& way) {
  constexpr int kSteps = 6;
  constexpr double kClosed = 1e-12, kSingular = 1e-6;  // m and rad; of the Jacobian's singular values
  Config q = from + length * way;
  for (int k = 0; k < kSteps; ++k) {
    const Pose at = chain.tool(q);
    const Eigen::AngleAxisd turn(tool.linear() * at.linear().transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << tool.translation() - at.translation(), turn.angle() * turn.axis();
    const Eigen::JacobiSVD<Eigen::Matrix<double, 6, kDof>> svd(chain.jacobian(q), Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (svd.singularValues()[5] < kSingular) return std::nullopt;
    const Config null = svd.matrixV().col(kDof - 1);
    way = null.dot(way) < 0 ? Config(-null) : null;
    if (error.norm() < kClosed) return q;
    q += svd.solve(error);
  }
  return std::nullopt;
}

}  // namespace

std::optional<Config> posture_beside(const Chain& chain, const Config& q, double farthest,
                                     const std::function<bool(const Config&)>& allowed) {
  constexpr double kFirst = 1e-4, kGrowth = 1.3;  // rad
  if (allowed(q)) return q;
  const Pose tool = chain.tool(q);
  struct Side {
    Config at, way;
    bool leads_on = true;
  };
  Config way = Config::Zero();
  if (!step(chain, tool, q, 0, way)) return std::nullopt;
  std::array<Side, 2> sides{Side{q, way}, Side{q, -way}};
  double gone = 0;
  for (double length = kFirst; gone < farthest; length *= kGrowth) {
    gone += length;
    for (Side& side : sides) {
      if (!side.leads_on) continue;
      const auto next = step(chain, tool, side.at, length, side.way);
      side.leads_on = next.has_value();
      if (!next) continue;
      side.at = *next;
      if (allowed(side.at)) return side.at;
    }
  }
  return std::nullopt;
}

}  // namespace swivel
