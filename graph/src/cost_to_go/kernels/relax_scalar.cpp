// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kernels/relax.hpp"
#define SWIVEL_ISA scalar
#include "cost_to_go/kernels/relax.inl"

namespace swivel {
const RelaxKernels& scalar_relax_kernels() {
  static constexpr RelaxKernels kernels{&scalar::relax<double>, &scalar::relax_all,
                                        &scalar::relax<float>, &scalar::range<double>,
                                        &scalar::range<float>};
  return kernels;
}
}  // namespace swivel
