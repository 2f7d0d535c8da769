// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/kernels/newton.hpp"
#define SWIVEL_ISA avx2
#include "kinematics/kernels/newton.inl"

namespace swivel {
const NewtonKernels& avx2_newton_kernels() {
  static constexpr NewtonKernels kernels{avx2::kLanes, &avx2::solve};
  return kernels;
}
}  // namespace swivel
