// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// A chain of seven joints as frames along common normals, and where its tool is to stand. m, rad. Columns of matrices one after
/// the other.
struct NewtonChain {
  double first[4][3];  ///< axes x, y, z of the frame of joint 1 in base, and its origin
  struct Link {        ///< to the frame of the next joint: Rz(q + turn) Tz(height) Tx(width) Rx(twist)
    double turn, height, width, twist_cosine, twist_sine;
  } link[7];          ///< the last has a turn only
  double last[4][3];  ///< axes and origin of the tool in the frame of joint 7
};

/// How a point is moved onto the curve of self-motion.
enum class NewtonMove {
  kNone,     ///< not at all
  kNearest,  ///< by steps of least norm, sum (scale_j dq_j)^2
  kLocked    ///< with one joint at a value
};

/// Newton's method for n points at once. Arrays of n, or n * 7.
struct NewtonTask {
  const NewtonChain* chain;
  double tool[4][3];  ///< axes and origin in base
  NewtonMove move;
  int steps;                ///< at most
  double longest, settled;  ///< rad: a longer step fails; after so short a one the error is its square
  double scale2[7];         ///< of kNearest
  int joint;                ///< of kLocked
  const double* value;      ///< of kLocked, one for each point
  int n;
  const double* start;
  double* q;
  double* particular;  ///< of kNone: q + particular + lambda null closes the error to first order
  double* null;        ///< of kNone as it comes out, else the unit tangent
  unsigned char* found;
};

struct NewtonKernels {
  int lanes;  ///< points for the price of one
  void (*solve)(const NewtonTask&);
};
const NewtonKernels& newton_kernels();
const NewtonKernels& scalar_newton_kernels();
#ifdef SWIVEL_X86_KERNELS
const NewtonKernels& avx2_newton_kernels();
const NewtonKernels& avx512_newton_kernels();
#endif

}  // namespace swivel
