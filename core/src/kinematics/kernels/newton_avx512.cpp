// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/kernels/newton.hpp"
#define SWIVEL_ISA avx512
#include "kinematics/kernels/newton.inl"

namespace swivel {
const NewtonKernels& avx512_newton_kernels() {
  static constexpr NewtonKernels kernels{avx512::kLanes, &avx512::solve};
  return kernels;
}
}  // namespace swivel
