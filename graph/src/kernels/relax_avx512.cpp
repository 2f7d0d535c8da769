// SPDX-License-Identifier: BSD-3-Clause
#include "relax.hpp"
#define SWIVEL_ISA avx512
#include "relax.inl"

namespace swivel {
const RelaxKernels& avx512_relax_kernels() {
  static constexpr RelaxKernels kernels{&avx512::relax, &avx512::chord};
  return kernels;
}
}  // namespace swivel
