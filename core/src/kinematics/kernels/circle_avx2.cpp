// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/kernels/kernels.hpp"
#define SWIVEL_ISA avx2
#include "kinematics/kernels/circle.inl"

namespace swivel {
const CircleKernels& avx2_circle_kernels() {
  static constexpr CircleKernels kernels{"avx2", &avx2::solve_triple};
  return kernels;
}
}  // namespace swivel
