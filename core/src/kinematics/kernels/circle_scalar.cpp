// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/kernels/kernels.hpp"
#define SWIVEL_ISA scalar
#include "kinematics/kernels/circle.inl"

namespace swivel {
const CircleKernels& scalar_circle_kernels() {
  static constexpr CircleKernels kernels{"scalar", &scalar::solve_triple};
  return kernels;
}
}  // namespace swivel
