// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kernels/relax.hpp"
#define SWIVEL_ISA avx512
#include "cost_to_go/kernels/relax.inl"

namespace swivel {
const RelaxKernels& avx512_relax_kernels() {
  static constexpr RelaxKernels kernels{&avx512::relax<double>, &avx512::relax_all,
                                        &avx512::relax<float>, &avx512::range<double>,
                                        &avx512::range<float>};
  return kernels;
}
}  // namespace swivel
