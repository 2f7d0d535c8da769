// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

enum class RelaxMetric { kL2, kMax };

/// A run of n nodes of one sheet against runs of a sheet in a layer nearby: node k with the partners k, k + 1, ...,
/// k + offsets - 1. In double precision with the rounding of Lattice::edge_cost and the largest moves allowed; in single precision,
/// for bounds, with neither.
template <class T>
struct RelaxTask {
  int n, offsets;
  const T* from[7];  ///< joints of the nodes that are relaxed
  const T* to[7];    ///< joints of their partners; any finite numbers where `value` is infinite
  const T* value;    ///< the partners' cost-to-go
  T* best;           ///< least cost + value so far, updated
  T scale[7];        ///< on each joint's move before the metric
  T bound[7];        ///< largest move of each joint; of doubles
  T turn[7];         ///< 2 pi for continuous joints, else 0
  T unit;            ///< Lattice::cost_unit
  RelaxMetric metric;
  bool wraps;  ///< any joint is continuous
};

struct RelaxKernels {
  void (*relax)(const RelaxTask<double>&);
  /// Every node with every one of the partners 0 ... offsets - 1; those out of reach by `bound` are left by groups.
  void (*relax_all)(const RelaxTask<double>&);
  void (*coarse)(const RelaxTask<float>&);
  /// Least and greatest of those of n joints whose value is finite; low > high where none is.
  void (*range)(const double* q, const double* value, int n, double& low, double& high);
  void (*coarse_range)(const float* q, const float* value, int n, float& low, float& high);
};
const RelaxKernels& relax_kernels();
const RelaxKernels& scalar_relax_kernels();
#ifdef SWIVEL_X86_KERNELS
const RelaxKernels& avx2_relax_kernels();
const RelaxKernels& avx512_relax_kernels();
#endif

}  // namespace swivel
