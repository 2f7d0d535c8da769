// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kernels/relax.hpp"
#include "swivel/core/base/isa.hpp"

namespace swivel {

const RelaxKernels& relax_kernels() {
#ifdef SWIVEL_X86_KERNELS
  switch (active_isa()) {
    case Isa::kAvx2:
      return avx2_relax_kernels();
    case Isa::kAvx512:
      return avx512_relax_kernels();
    case Isa::kScalar:
      break;
  }
#endif
  return scalar_relax_kernels();
}

}  // namespace swivel
