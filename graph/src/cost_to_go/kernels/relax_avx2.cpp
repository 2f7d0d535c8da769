// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kernels/relax.hpp"
#define SWIVEL_ISA avx2
#include "cost_to_go/kernels/relax.inl"

namespace swivel {
const RelaxKernels& avx2_relax_kernels() {
  static constexpr RelaxKernels kernels{&avx2::relax<double>, &avx2::relax_all, &avx2::relax<float>,
                                        &avx2::range<double>, &avx2::range<float>};
  return kernels;
}
}  // namespace swivel
