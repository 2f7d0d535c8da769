// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// A chain of seven joints as frames along common normals. m, rad; matrices column by column.
struct NewtonChain {
  double first[4][3];  ///< axes x, y, z of the frame of joint 1 in base, and its origin
  /// Transform to the next joint's frame: Rz(q + turn) Tz(height) Tx(width) Rx(twist); of a slide
  /// Rz(turn) Tz(height + q) Tx(width) Rx(twist).
  struct Link {
    double turn, height, width, twist_cosine, twist_sine;
  } link[7];          ///< the last one has only a turn
  double last[4][3];  ///< axes and origin of the tool in the frame of joint 7
  int slide;          ///< joint that slides, 0-based; -1: none
};

/// How Newton moves a point onto the self-motion curve.
enum class NewtonMove {
  kNone,     ///< not at all: it computes the first-order moves
  kNearest,  ///< by steps of least norm, sum (scale_j dq_j)^2
  kLocked    ///< with one joint held at a value
};

/// The input and output of Newton's method for n points at once. Arrays have n numbers, or `stride`
/// n, of which the first seven of each point are used.
struct NewtonTask {
  const NewtonChain* chain;
  double tool[4][3];  ///< axes and origin of the goal in base
  NewtonMove move;
  int steps;  ///< most Newton steps
  /// rad: a longer step fails; after a shorter step than `settled` the error is its square.
  double longest, settled;
  double scale2[7];     ///< for kNearest
  int joint;            ///< for kLocked, 0-based
  const double* value;  ///< for kLocked, one for each point
  int n;
  int stride;  ///< numbers from a point to the next in the arrays below, at least 7
  const double* start;
  double* q;
  double* particular;  ///< for kNone: q + particular + lambda null closes the error to first order
  double* null;        ///< for kNone of any length, else the unit tangent
  unsigned char* found;
};

/// Newton's method compiled for one instruction set.
struct NewtonKernels {
  int lanes;  ///< points computed at once
  void (*solve)(const NewtonTask&);
};
/// Returns the kernels for active_isa(). All give the same bits.
const NewtonKernels& newton_kernels();
const NewtonKernels& scalar_newton_kernels();
#ifdef SWIVEL_X86_KERNELS
const NewtonKernels& avx2_newton_kernels();
const NewtonKernels& avx512_newton_kernels();
#endif

}  // namespace swivel
