// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/kernels/newton.hpp"
#define SWIVEL_ISA scalar
#include "kinematics/kernels/newton.inl"

namespace swivel {
const NewtonKernels& scalar_newton_kernels() {
  static constexpr NewtonKernels kernels{scalar::kLanes, &scalar::solve};
  return kernels;
}
}  // namespace swivel
