// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

enum class RelaxMetric { kL2, kMax };

/// A run of n nodes of one label against its image, shifted by some offset, in the neighbouring layer.
struct RelaxTask {
  int n;
  const double* from[7];  ///< joints of the nodes that are relaxed
  const double* to[7];    ///< joints of their partners
  const double* value;    ///< the partners' cost-to-go
  double* best;           ///< least cost + value so far, updated
  double scale[7];        ///< on each joint's move before the metric
  double bound[7];        ///< largest move of each joint
  double turn[7];         ///< 2 pi for continuous joints, else 0
  RelaxMetric metric;
  bool wraps;  ///< any joint is continuous
};

struct RelaxKernels {
  void (*relax)(const RelaxTask&);
};
const RelaxKernels& relax_kernels();
const RelaxKernels& scalar_relax_kernels();
#ifdef SWIVEL_X86_KERNELS
const RelaxKernels& avx2_relax_kernels();
const RelaxKernels& avx512_relax_kernels();
#endif

}  // namespace swivel
