// SPDX-License-Identifier: BSD-3-Clause
#include "job/job_lift.hpp"

#include <cmath>

#include "plan/layout/told_turns.hpp"

namespace swivel {

namespace {

constexpr double kRounding = 1e-9;  // rad

/// Notes the bounded joints that are outside of their limits at q.
void note_off_limits(const Lattice& lattice, const Config& q, Lattice::Joints& off) {
  const double margin = lattice.limits().joint_margin - kRounding;
  const Lattice::Joints circles = bounded_circles(lattice);
  for (std::size_t j = 0; j < kDof; ++j) {
    if (!circles[j]) continue;
    const double x = q[static_cast<Eigen::Index>(j)];
    const JointLimit& limit = lattice.chain().limit[j];
    off[j] = off[j] || x < limit.lower + margin || x > limit.upper - margin;
  }
}

/// Notes the bounded joints that are in another turn at `q` than at `wanted`.
void note_other_turn(const Lattice& lattice, const Config& q, const Config& wanted,
                     Lattice::Joints& off) {
  const Lattice::Joints circles = bounded_circles(lattice);
  for (std::size_t j = 0; j < kDof; ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    if (circles[j]) off[j] = off[j] || std::abs(q[i] - wanted[i]) > kPi;
  }
}

}  // namespace

Lattice::Joints lift(std::vector<Part>& parts, const Lattice& lattice, const Problem& job) {
  Lattice::Joints off{};
  std::optional<Config> end = job.arm().home;
  for (Part& part : parts) {
    // the run itself leaves the limits, whatever its turn
    if (part.rows.empty()) return bounded_circles(lattice);
    Config last = part.rows.front().q;
    if (end) last = *end + lattice.delta(*end, last);
    Config before = part.rows.front().q;
    for (TrajectoryRow& row : part.rows) {
      // rows of runs come without jumps, ways of transitions as they were found
      const Config step = part.run ? Config(row.q - before) : lattice.delta(before, row.q);
      before = row.q;
      row.q = last += step;
      note_off_limits(lattice, row.q, off);
    }
    end = last;
    if (!part.run) continue;
    if (const auto& given = job.arm().strokes[part.run->stroke].end)
      note_other_turn(lattice, last, *given, off);
  }
  if (job.arm().home) note_other_turn(lattice, *end, *job.arm().home, off);
  return off;
}

}  // namespace swivel
