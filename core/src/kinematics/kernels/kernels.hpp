// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// The input and output of one triple of joints over a run of n arm angles, for both signs of the
/// middle angle.
struct TripleTask {
  double m[5][3];     ///< TripleCircle: rows m02, m12, m22, m20, m21; columns sin, cos, 1
  double shift;       ///< subtracted from the middle angle, rad
  double base[3];     ///< each joint is given in [base, base + 2 pi), rad
  double upper[3];    ///< upper limit of each joint, rad
  double least_sine;  ///< a node with a smaller sine of the middle angle is singular
  int n;
  const double* sin_phi;
  const double* cos_phi;
  double* q[2][3];  ///< [sign of the middle angle's sine][joint of the triple]
  /// [sign]: 0 where the triple is solved within its limits and not singular, else infinity.
  double* mask[2];
};

/// Inverse kinematics of joint triples compiled for one instruction set.
struct CircleKernels {
  const char* name;
  void (*solve_triple)(const TripleTask&);
};

/// Returns the kernels for active_isa(): the best instruction set of this processor, or the one
/// that SWIVEL_FORCE_ISA=scalar|avx2|avx512 picks. All give the same bits.
const CircleKernels& circle_kernels();

const CircleKernels& scalar_circle_kernels();
#ifdef SWIVEL_X86_KERNELS
const CircleKernels& avx2_circle_kernels();
const CircleKernels& avx512_circle_kernels();
#endif

}  // namespace swivel
