// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"
#define SWIVEL_ISA scalar
#include "circle.inl"

namespace swivel {
const CircleKernels& scalar_circle_kernels() {
  static constexpr CircleKernels kernels{"scalar", &scalar::solve_triple};
  return kernels;
}
}  // namespace swivel
