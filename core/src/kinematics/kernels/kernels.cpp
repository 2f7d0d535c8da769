// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/kernels/kernels.hpp"

#include "swivel/core/base/isa.hpp"

namespace swivel {

const CircleKernels& circle_kernels() {
#ifdef SWIVEL_X86_KERNELS
  switch (active_isa()) {
    case Isa::kAvx2:
      return avx2_circle_kernels();
    case Isa::kAvx512:
      return avx512_circle_kernels();
    case Isa::kScalar:
      break;
  }
#endif
  return scalar_circle_kernels();
}

}  // namespace swivel
