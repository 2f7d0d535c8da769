// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/kernels/kernels.hpp"
#define SWIVEL_ISA avx512
#include "kinematics/kernels/circle.inl"

namespace swivel {
const CircleKernels& avx512_circle_kernels() {
  static constexpr CircleKernels kernels{"avx512", &avx512::solve_triple};
  return kernels;
}
}  // namespace swivel
