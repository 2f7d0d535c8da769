// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// The norm of a joint move that edges cost: Euclidean, the sum of the joints, or the largest one.
enum class RelaxMetric { kL2, kL1, kMax };

/// The input and output of relaxing a run of n nodes of one IK solution against runs of one in a
/// layer nearby: node k with the partners k, k + 1, ..., k + offsets - 1. In double precision it
/// has the rounding of Lattice::edge_cost() and keeps the largest moves allowed; in single
/// precision, for bounds, neither.
template <class T>
struct RelaxTask {
  int n, offsets;
  const T* from[7];  ///< joints of the nodes that are relaxed
  const T* to[7];    ///< joints of their partners; any finite numbers where `value` is infinite
  const T* value;    ///< the partners' cost-to-go
  T* best;           ///< least cost + value so far, updated
  T scale[7];        ///< factor of each joint's move before the metric
  T bound[7];        ///< largest move of each joint; for doubles alone
  T turn[7];         ///< 2 pi for continuous joints, else 0
  T unit;            ///< Lattice::cost_unit
  static constexpr int kBlock = 16;
  /// For relax_all() alone, and null where it must do without: for each joint, a middle of the
  /// partners of each block of kBlock, and how far they lie from it at most, on the circle of a
  /// continuous joint.
  const T *block_middle[7] = {}, *block_radius[7] = {};
  /// The least value of each block, infinite where none of its partners has one; given with the
  /// middles.
  const T* block_value = nullptr;
  RelaxMetric metric;
  bool wraps;  ///< any joint is continuous
};

/// The kernels compiled for one instruction set.
struct RelaxKernels {
  /// Relaxes every node with its partners.
  void (*relax)(const RelaxTask<double>&);
  /// Relaxes every node with each of the partners 0 ... offsets - 1; those out of reach by `bound`
  /// are left out in groups.
  void (*relax_all)(const RelaxTask<double>&);
  /// Relaxes every node with its partners, in single precision.
  void (*coarse)(const RelaxTask<float>&);
  /// Finds the least and greatest of those of n joint positions whose value is finite; low > high
  /// where none is.
  void (*range)(const double* q, const double* value, int n, double& low, double& high);
  /// Finds the least and greatest in single precision.
  void (*coarse_range)(const float* q, const float* value, int n, float& low, float& high);
};
/// Returns the kernels for active_isa(). All give the same bits.
const RelaxKernels& relax_kernels();
const RelaxKernels& scalar_relax_kernels();
#ifdef SWIVEL_X86_KERNELS
const RelaxKernels& avx2_relax_kernels();
const RelaxKernels& avx512_relax_kernels();
#endif

}  // namespace swivel
