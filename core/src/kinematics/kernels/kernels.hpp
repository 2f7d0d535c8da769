// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// One triple of joints over a run of arm angles: both signs of the middle angle. Arrays of n.
struct TripleTask {
  double m[5][3];     ///< TripleCircle: rows m02, m12, m22, m20, m21; columns sin, cos, 1
  double shift;       ///< subtracted from the middle angle
  double base[3];     ///< each joint's image is taken in [base, base + 2 pi)
  double upper[3];    ///< and exists up to here
  double least_sine;  ///< below: singular
  int n;
  const double* sin_phi;
  const double* cos_phi;
  double* q[2][3];  ///< [sign of the middle angle's sine][joint of the triple]
  double* mask[2];  ///< [sign]: 0 where the triple is solved within its limits and not singular, else infinity
};

struct CircleKernels {
  const char* name;
  void (*solve_triple)(const TripleTask&);
};

/// The kernels of the best vector unit this processor has; SWIVEL_FORCE_ISA=scalar|avx2|avx512 picks one. All give the same bits.
const CircleKernels& circle_kernels();

const CircleKernels& scalar_circle_kernels();
#ifdef SWIVEL_X86_KERNELS
const CircleKernels& avx2_circle_kernels();
const CircleKernels& avx512_circle_kernels();
#endif

}  // namespace swivel
