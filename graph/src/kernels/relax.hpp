// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

enum class RelaxMetric { kL2, kMax };

/// A run of n nodes of one label against runs of a label in the neighbouring layer: node k with the partners k, k + 1, ...,
/// k + offsets - 1.
struct RelaxTask {
  int n, offsets;
  const double* from[7];  ///< joints of the nodes that are relaxed
  const double* to[7];    ///< joints of their partners; any finite numbers where `value` is infinite
  const double* value;    ///< the partners' cost-to-go
  double* best;           ///< least cost + value so far, updated
  double scale[7];        ///< on each joint's move before the metric
  double bound[7];        ///< largest move of each joint
  double turn[7];         ///< 2 pi for continuous joints, else 0
  RelaxMetric metric;
  bool wraps;  ///< any joint is continuous
};

/// The same in single precision, all steps allowed, for bounds.
struct ChordTask {
  int n, offsets;
  const float* from[7];
  const float* to[7];
  const float* value;
  float* best;
  float scale[7];
  float turn[7];
  RelaxMetric metric;
  bool wraps;
};

struct RelaxKernels {
  void (*relax)(const RelaxTask&);
  void (*chord)(const ChordTask&);
};
const RelaxKernels& relax_kernels();
const RelaxKernels& scalar_relax_kernels();
#ifdef SWIVEL_X86_KERNELS
const RelaxKernels& avx2_relax_kernels();
const RelaxKernels& avx512_relax_kernels();
#endif

}  // namespace swivel
