// SPDX-License-Identifier: BSD-3-Clause
// Compiled once per vector unit, inside namespace SWIVEL_ISA; see core/src/kernels/circle.inl for why only raw pointers appear.
// Every operation stands in the order of Lattice::delta, step_allowed and edge_cost, so the bits are theirs.

namespace swivel::SWIVEL_ISA {
namespace {

template <class T>
inline T magnitude(T x) {
  return x < 0 ? -x : x;
}
template <class T>
inline T larger(T a, T b) {
  return a > b ? a : b;
}
/// to - from, less the whole turns in it where turn is not 0; halves away from zero, as std::round.
template <bool kWraps>
inline double move(double from, double to, double turn) {
  const double d = to - from;
  if (!kWraps) return d;
  const double turns = d / 6.2831853071795862, nearest = magnitude(turns) + 0.5;
  const double up = (nearest + 4503599627370496.0) - 4503599627370496.0;
  const double whole = up > nearest ? up - 1.0 : up;
  return d - turn * (turns < 0 ? -whole : whole);
}
template <bool kWraps>
inline float move(float from, float to, float turn) {
  const float d = to - from;
  if (!kWraps) return d;
  const float turns = d / 6.2831853071795862F;
  return d - turn * ((turns + 12582912.0F) - 12582912.0F);  // to the nearest whole
}
inline double root(double x) {
  return __builtin_sqrt(x);
}
inline float root(float x) {
  return __builtin_sqrtf(x);
}

template <RelaxMetric kMetric, bool kWraps>
void relax_run(const RelaxTask& task) {
  const double w0 = task.scale[0], w1 = task.scale[1], w2 = task.scale[2], w3 = task.scale[3], w4 = task.scale[4],
               w5 = task.scale[5], w6 = task.scale[6];
  const double l0 = task.bound[0], l1 = task.bound[1], l2 = task.bound[2], l3 = task.bound[3], l4 = task.bound[4],
               l5 = task.bound[5], l6 = task.bound[6];
  const double t0 = task.turn[0], t1 = task.turn[1], t2 = task.turn[2], t3 = task.turn[3], t4 = task.turn[4], t5 = task.turn[5],
               t6 = task.turn[6];
  const double* __restrict a0 = task.from[0], * __restrict a1 = task.from[1], * __restrict a2 = task.from[2], * __restrict a3 = task.from[3], * __restrict a4 = task.from[4], * __restrict a5 = task.from[5], * __restrict a6 = task.from[6];
  double* __restrict best = task.best;
  for (int offset = 0; offset < task.offsets; ++offset) {
    const double* __restrict b0 = task.to[0] + offset, * __restrict b1 = task.to[1] + offset, * __restrict b2 = task.to[2] + offset, * __restrict b3 = task.to[3] + offset, * __restrict b4 = task.to[4] + offset, * __restrict b5 = task.to[5] + offset, * __restrict b6 = task.to[6] + offset;
    const double* __restrict value = task.value + offset;
#pragma GCC ivdep  // GCC gives up on more than ten run-time alias checks, and forgets restrict on locals
    for (int k = 0; k < task.n; ++k) {
      const double d0 = move<kWraps>(a0[k], b0[k], t0), d1 = move<kWraps>(a1[k], b1[k], t1), d2 = move<kWraps>(a2[k], b2[k], t2),
                   d3 = move<kWraps>(a3[k], b3[k], t3), d4 = move<kWraps>(a4[k], b4[k], t4), d5 = move<kWraps>(a5[k], b5[k], t5),
                   d6 = move<kWraps>(a6[k], b6[k], t6);
      const double m0 = magnitude(d0), m1 = magnitude(d1), m2 = magnitude(d2), m3 = magnitude(d3), m4 = magnitude(d4),
                   m5 = magnitude(d5), m6 = magnitude(d6);
      const double excess =
          larger(larger(larger(m0 - l0, m1 - l1), larger(m2 - l2, m3 - l3)), larger(larger(m4 - l4, m5 - l5), m6 - l6));
      double cost;
      if (kMetric == RelaxMetric::kL2) {
        const double x0 = w0 * d0, x1 = w1 * d1, x2 = w2 * d2, x3 = w3 * d3, x4 = w4 * d4, x5 = w5 * d5, x6 = w6 * d6;
        cost = root(((x0 * x0 + x1 * x1) + x2 * x2) + x3 * x3 + ((x4 * x4 + x5 * x5) + x6 * x6));
      } else {
        cost = larger(larger(larger(w0 * m0, w1 * m1), larger(w2 * m2, w3 * m3)), larger(larger(w4 * m4, w5 * m5), w6 * m6));
      }
      const double total = ((cost + 6144.0) - 6144.0) + value[k];
      const double allowed = excess <= 0 ? total : __builtin_inf();
      best[k] = allowed < best[k] ? allowed : best[k];
    }
  }
}

template <RelaxMetric kMetric, bool kWraps>
void chord_run(const ChordTask& task) {
  const float w0 = task.scale[0], w1 = task.scale[1], w2 = task.scale[2], w3 = task.scale[3], w4 = task.scale[4],
              w5 = task.scale[5], w6 = task.scale[6];
  const float t0 = task.turn[0], t1 = task.turn[1], t2 = task.turn[2], t3 = task.turn[3], t4 = task.turn[4], t5 = task.turn[5],
              t6 = task.turn[6];
  const float* __restrict a0 = task.from[0], * __restrict a1 = task.from[1], * __restrict a2 = task.from[2], * __restrict a3 = task.from[3], * __restrict a4 = task.from[4], * __restrict a5 = task.from[5], * __restrict a6 = task.from[6];
  float* __restrict best = task.best;
  for (int offset = 0; offset < task.offsets; ++offset) {
    const float* __restrict b0 = task.to[0] + offset, * __restrict b1 = task.to[1] + offset, * __restrict b2 = task.to[2] + offset, * __restrict b3 = task.to[3] + offset, * __restrict b4 = task.to[4] + offset, * __restrict b5 = task.to[5] + offset, * __restrict b6 = task.to[6] + offset;
    const float* __restrict value = task.value + offset;
#pragma GCC ivdep
    for (int k = 0; k < task.n; ++k) {
      const float x0 = w0 * move<kWraps>(a0[k], b0[k], t0), x1 = w1 * move<kWraps>(a1[k], b1[k], t1),
                  x2 = w2 * move<kWraps>(a2[k], b2[k], t2), x3 = w3 * move<kWraps>(a3[k], b3[k], t3),
                  x4 = w4 * move<kWraps>(a4[k], b4[k], t4), x5 = w5 * move<kWraps>(a5[k], b5[k], t5),
                  x6 = w6 * move<kWraps>(a6[k], b6[k], t6);
      float cost;
      if (kMetric == RelaxMetric::kL2)
        cost = root(((x0 * x0 + x1 * x1) + x2 * x2) + x3 * x3 + ((x4 * x4 + x5 * x5) + x6 * x6));
      else
        cost = larger(larger(larger(magnitude(x0), magnitude(x1)), larger(magnitude(x2), magnitude(x3))),
                      larger(larger(magnitude(x4), magnitude(x5)), magnitude(x6)));
      const float total = cost + value[k];
      best[k] = total < best[k] ? total : best[k];
    }
  }
}

void relax(const RelaxTask& task) {
  if (task.metric == RelaxMetric::kL2)
    task.wraps ? relax_run<RelaxMetric::kL2, true>(task) : relax_run<RelaxMetric::kL2, false>(task);
  else
    task.wraps ? relax_run<RelaxMetric::kMax, true>(task) : relax_run<RelaxMetric::kMax, false>(task);
}

void chord(const ChordTask& task) {
  if (task.metric == RelaxMetric::kL2)
    task.wraps ? chord_run<RelaxMetric::kL2, true>(task) : chord_run<RelaxMetric::kL2, false>(task);
  else
    task.wraps ? chord_run<RelaxMetric::kMax, true>(task) : chord_run<RelaxMetric::kMax, false>(task);
}

}  // namespace
}  // namespace swivel::SWIVEL_ISA
