// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, inside namespace SWIVEL_ISA;
// core/src/kinematics/kernels/circle.inl says why nothing shared with other files appears here.
// Operations have the order of Lattice::delta, step_allowed and edge_cost, so that the bits are
// theirs.
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace swivel::SWIVEL_ISA {
namespace {

// Operations that plain C++ lacks for a vector of lanes: the widest vector of this instruction set,
// and one number.
template <class T>
struct Widest {
  using Lanes = T;
};
template <class T>
constexpr bool kSingle = sizeof(T) == sizeof(float);

inline double root(double x) {
  return __builtin_sqrt(x);
}
inline float root(float x) {
  return __builtin_sqrtf(x);
}
inline double magnitude(double x) {
  return __builtin_fabs(x);
}
inline float magnitude(float x) {
  return __builtin_fabsf(x);
}
inline bool any_less(double a, double b) {
  return a < b;
}
inline bool any_less(float a, float b) {
  return a < b;
}
#if defined(__AVX512F__)
template <>
struct Widest<double> {
  using Lanes = __m512d;
};
template <>
struct Widest<float> {
  using Lanes = __m512;
};
inline __m512d root(__m512d x) {
  return _mm512_maskz_sqrt_pd(0xff, x);  // GCC 12 warns of the plain one
}
inline __m512 root(__m512 x) {
  return _mm512_maskz_sqrt_ps(0xffff, x);
}
inline __m512d magnitude(__m512d x) {
  return _mm512_abs_pd(x);
}
inline __m512 magnitude(__m512 x) {
  return _mm512_abs_ps(x);
}
inline bool any_less(__m512d a, __m512d b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ) != 0;
}
inline bool any_less(__m512 a, __m512 b) {
  return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ) != 0;
}
#elif defined(__AVX2__)
template <>
struct Widest<double> {
  using Lanes = __m256d;
};
template <>
struct Widest<float> {
  using Lanes = __m256;
};
inline __m256d root(__m256d x) {
  return _mm256_sqrt_pd(x);
}
inline __m256 root(__m256 x) {
  return _mm256_sqrt_ps(x);
}
inline __m256d magnitude(__m256d x) {
  return _mm256_andnot_pd(_mm256_set1_pd(-0.0), x);
}
inline __m256 magnitude(__m256 x) {
  return _mm256_andnot_ps(_mm256_set1_ps(-0.0F), x);
}
inline bool any_less(__m256d a, __m256d b) {
  return _mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LT_OQ)) != 0;
}
inline bool any_less(__m256 a, __m256 b) {
  return _mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ)) != 0;
}
#endif

template <class V, class T>
inline V load(const T* from) {
  V lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
template <class V>
inline V larger(V a, V b) {
  return a > b ? a : b;
}

/// Returns to - from, less the whole turns in it where turn is not 0; halves round away from zero,
/// as std::round does.
template <bool kWraps, class V>
inline V move(V from, V to, double turn) {
  const V d = to - from;
  if constexpr (!kWraps) return d;
  const V turns = d / 6.2831853071795862, nearest = magnitude(turns) + 0.5;
  const V up = (nearest + 4503599627370496.0) - 4503599627370496.0;
  const V whole = up > nearest ? up - 1.0 : up;
  return d - turn * (turns < 0.0 ? -whole : whole);
}
template <bool kWraps, class V>
inline V move(V from, V to, float turn) {
  const V d = to - from;
  if constexpr (!kWraps) return d;
  const V turns = d / 6.2831853071795862F;
  return d - turn * ((turns + 12582912.0F) - 12582912.0F);  // to the nearest whole
}

/// Returns to - from less whole turns up to rounding, and at half a turn to either side: enough for
/// bounds.
template <bool kWraps, class V>
inline V move_about(V from, V to, double turn) {
  const V d = to - from;
  if constexpr (!kWraps) return d;
  return d - turn * ((d * (1 / 6.2831853071795862) + 6755399441055744.0) - 6755399441055744.0);
}

/// Returns `best`, or the value through a partner where that is less. Partners that better no
/// lane's best are left out before the square root. `sure` is a measure of the move up to which
/// every joint stays within its bound; negative where there is no such measure.
template <class V, RelaxMetric kMetric, bool kWraps, class T>
inline V with_partner(const RelaxTask<T>& task, const V* from, const V* to, V value, V best,
                      T sure) {
  // far above what the sum may lose
  const T rounding = (kSingle<T> ? T(1e-4) : T(1e-11)) * task.unit;
  const T shift = T(6144) * task.unit;
  const V room = larger(V(best - value + rounding), V{});
  V step[7], x[7];
  V longest{};
  for (int j = 0; j < 7; ++j) {
    step[j] = to[j] - from[j];
    longest = larger(longest, magnitude(step[j]));
  }
  if constexpr (kWraps)  // below half a turn nothing is taken away, and dividing is slow
    if (any_less(V{} + T(3), longest))
      for (int j = 0; j < 7; ++j) step[j] = move<kWraps>(from[j], to[j], task.turn[j]);
  for (int j = 0; j < 7; ++j) x[j] = task.scale[j] * step[j];
  V measure, limit;  // a measure that grows with the cost, and its largest allowed value
  if constexpr (kMetric == RelaxMetric::kL2) {
    measure = ((x[0] * x[0] + x[1] * x[1]) + x[2] * x[2]) + x[3] * x[3] +
              ((x[4] * x[4] + x[5] * x[5]) + x[6] * x[6]);
    limit = room * room;
  } else {
    for (V& part : x) part = magnitude(part);
    if constexpr (kMetric == RelaxMetric::kL1)
      measure = ((x[0] + x[1]) + x[2]) + x[3] + ((x[4] + x[5]) + x[6]);
    else
      measure =
          larger(larger(larger(x[0], x[1]), larger(x[2], x[3])), larger(larger(x[4], x[5]), x[6]));
    limit = room;
  }
  if (!any_less(measure, limit)) return best;
  V cost = measure;
  if constexpr (kMetric == RelaxMetric::kL2) cost = root(measure);
  if constexpr (!kSingle<T>) cost = (cost + shift) - shift;
  V total = cost + value;
  if constexpr (!kSingle<T>)
    if (any_less(V{} + sure, measure)) {
      V excess = magnitude(step[0]) - task.bound[0];
      for (int j = 1; j < 7; ++j) excess = larger(excess, V(magnitude(step[j]) - task.bound[j]));
      total = excess > T(0) ? V{} + T(__builtin_inf()) : total;
    }
  return total < best ? total : best;
}

/// Relaxes as many nodes as V has lanes, from the run's node `at` on. The middle partner comes
/// first, since it is mostly the best.
template <class V, RelaxMetric kMetric, bool kWraps, class T>
inline void relax_lanes(const RelaxTask<T>& task, int at, T sure) {
  V from[7];
  for (int j = 0; j < 7; ++j) from[j] = load<V>(task.from[j] + at);
  V best = load<V>(task.best + at);
  for (int turn = 0; turn < task.offsets; ++turn) {
    const int offset = task.offsets / 2 + (turn % 2 == 0 ? turn / 2 : -(turn + 1) / 2),
              partner = at + offset;
    V to[7];
    for (int j = 0; j < 7; ++j) to[j] = load<V>(task.to[j] + partner);
    best =
        with_partner<V, kMetric, kWraps>(task, from, to, load<V>(task.value + partner), best, sure);
  }
  __builtin_memcpy(task.best + at, &best, sizeof best);
}

/// Returns a measure of a move up to which every joint stays within its bound; negative where there
/// is none.
template <RelaxMetric kMetric, class T>
T sure_measure(const RelaxTask<T>& task) {
  T sure = 0;
  for (int j = 0; j < 7; ++j) {
    const T least = task.scale[j] * task.bound[j];
    if (j == 0 || least < sure) sure = least;
  }
  sure *= T(1 - 1e-12);
  if (kMetric == RelaxMetric::kL2) sure *= sure;
  // A joint of weight 0 moves at no cost, and a tiny product underflows: the measure then says
  // nothing of the moves.
  return sure > T(1e-280) ? sure : T(-1);
}

template <RelaxMetric kMetric, bool kWraps, class T>
void relax_run(const RelaxTask<T>& task) {
  using Lanes = typename Widest<T>::Lanes;
  constexpr int kLanes = sizeof(Lanes) / sizeof(T);
  const T sure = sure_measure<kMetric>(task);
  int at = 0;
  for (; at + kLanes <= task.n; at += kLanes) relax_lanes<Lanes, kMetric, kWraps>(task, at, sure);
  if (at < task.n && task.n >= kLanes) {  // nodes relaxed twice come out the same
    relax_lanes<Lanes, kMetric, kWraps>(task, task.n - kLanes, sure);
    return;
  }
  for (; at < task.n; ++at) relax_lanes<T, kMetric, kWraps>(task, at, sure);
}

/// Bounds, for each joint a middle and a distance from it, where partners of the nodes first ...
/// last - 1 may be.
template <bool kWraps>
struct Reach {
  double middle[7], radius[7];
  double spread[7];  // how far the nodes lie from the middle at most
  int last;
  /// Adds nodes for as long as they stay together, at most `most`.
  Reach(const RelaxTask<double>& task, int first, int most) : last(first + 1) {
    constexpr double kTogether = 1;     // rad: nodes further apart are looked at by themselves
    constexpr double kRounding = 1e-9;  // far above that of a few operations on angles
    double low[7] = {}, high[7] = {};
    for (; last < first + most; ++last) {
      double step[7];
      bool together = true;
      for (int j = 0; j < 7; ++j) {
        step[j] = move_about<kWraps>(task.from[j][first], task.from[j][last], task.turn[j]);
        together = together && magnitude(step[j]) < kTogether;
      }
      if (!together) break;
      for (int j = 0; j < 7; ++j) {
        low[j] = step[j] < low[j] ? step[j] : low[j];
        high[j] = step[j] > high[j] ? step[j] : high[j];
      }
    }
    for (int j = 0; j < 7; ++j) {
      middle[j] = task.from[j][first] + (low[j] + high[j]) / 2;
      spread[j] = (high[j] - low[j]) / 2 + kRounding;
      radius[j] = task.bound[j] + spread[j];
    }
  }
  /// Returns values above 0 in lanes whose partner has a joint out of every node's reach.
  template <class V>
  V excess(const RelaxTask<double>& task, int partner) const {
    return excess_of<V>([&](int j) {
      return V(magnitude(move_about<kWraps>(V{} + middle[j], load<V>(task.to[j] + partner),
                                            task.turn[j])) -
               radius[j]);
    });
  }
  /// Returns less than any node's cost through any partner of a block that is within reach, and
  /// infinity for blocks out of every node's reach.
  template <RelaxMetric kMetric, class V>
  V least_through_blocks(const RelaxTask<double>& task, int block) const {
    V sum{}, most = V{} - 1.0;
    for (int j = 6; j >= 0; --j) {
      const V apart = magnitude(move_about<kWraps>(
                          V{} + middle[j], load<V>(task.block_middle[j] + block), task.turn[j])) -
                      (spread[j] + load<V>(task.block_radius[j] + block));
      most = larger(most, V(apart - task.bound[j]));
      const V cost = task.scale[j] * larger(apart, V{});
      if constexpr (kMetric == RelaxMetric::kL2)
        sum = sum + cost * cost;
      else if constexpr (kMetric == RelaxMetric::kL1)
        sum = sum + cost;
      else
        sum = larger(sum, cost);
    }
    if constexpr (kMetric == RelaxMetric::kL2) sum = root(sum);
    const V least = sum * (1 - 1e-12) + load<V>(task.block_value + block) - 1e-11 * task.unit;
    return most > 0.0 ? V{} + __builtin_inf() : least;
  }
  /// Returns true if every lane is above 0.
  template <class V>
  static bool none_within(V excess) {
    return !any_less(excess, V{} + 1e-300);
  }

 private:
  /// Returns the largest of the joints' excesses, or one above 0. The last joints come first: they
  /// move most and mostly decide.
  template <class V, class OfJoint>
  static V excess_of(const OfJoint& of) {
    const V most = larger(larger(of(6), of(5)), larger(of(4), of(3)));
    return none_within(most) ? most : larger(larger(most, of(2)), larger(of(1), of(0)));
  }
};

/// Appends to `near`, which holds `count` partners, those of first ... end - 1 that are within
/// reach. Returns how many it then holds.
template <bool kWraps>
inline int add_near(const RelaxTask<double>& task, const Reach<kWraps>& reach, int first, int end,
                    int* near, int count) {
  using Lanes = typename Widest<double>::Lanes;
  constexpr int kLanes = sizeof(Lanes) / sizeof(double);
  int partner = first;
  for (; partner + kLanes <= end; partner += kLanes) {
    const Lanes excess = reach.template excess<Lanes>(task, partner);
    if (reach.none_within(excess)) continue;
    double lane[kLanes];
    __builtin_memcpy(lane, &excess, sizeof excess);
    for (int k = 0; k < kLanes; ++k) {
      near[count] = partner + k;
      count += !(lane[k] > 0);
    }
  }
  for (; partner < end; ++partner) {
    near[count] = partner;
    count += !(reach.template excess<double>(task, partner) > 0);
  }
  return count;
}

/// Relaxes as many nodes as V has lanes, from `at` on, with each of the partners listed.
template <class V, RelaxMetric kMetric, bool kWraps>
inline void relax_with(const RelaxTask<double>& task, int at, const int* partners, int count,
                       double sure) {
  V from[7];
  for (int j = 0; j < 7; ++j) from[j] = load<V>(task.from[j] + at);
  V best = load<V>(task.best + at);
  for (int k = 0; k < count; ++k) {
    V to[7];
    for (int j = 0; j < 7; ++j) to[j] = V{} + task.to[j][partners[k]];
    best = with_partner<V, kMetric, kWraps>(task, from, to, V(V{} + task.value[partners[k]]), best,
                                            sure);
  }
  __builtin_memcpy(task.best + at, &best, sizeof best);
}

/// Relaxes the nodes at ... last - 1 with the partners listed. A vector may extend into the next
/// run, whose nodes then meet all of their own partners.
template <RelaxMetric kMetric, bool kWraps>
inline void relax_near(const RelaxTask<double>& task, int at, int last, const int* near, int count,
                       double sure) {
  using Lanes = typename Widest<double>::Lanes;
  constexpr int kLanes = sizeof(Lanes) / sizeof(double);
  if (task.n >= kLanes)
    for (int node = at; node < last; node += kLanes)
      relax_with<Lanes, kMetric, kWraps>(task, node + kLanes <= task.n ? node : task.n - kLanes,
                                         near, count, sure);
  else
    for (int node = at; node < last; ++node)
      relax_with<double, kMetric, kWraps>(task, node, near, count, sure);
}

constexpr int kMostPartners = 256;  // at once

constexpr int kMostBlocks = 1024;  // of a layer whose blocks are looked at

/// Blocks of partners, each with less than any value through it.
struct Blocks {
  int count = 0;
  int block[kMostBlocks];
  double least[kMostBlocks];
  /// Lists the blocks of partners within reach of a run of nodes. Returns the place of the one with
  /// the least value.
  template <RelaxMetric kMetric, bool kWraps>
  int list(const RelaxTask<double>& task, const Reach<kWraps>& reach) {
    using Lanes = typename Widest<double>::Lanes;
    constexpr int kLanes = sizeof(Lanes) / sizeof(double), kBlock = RelaxTask<double>::kBlock;
    const int blocks = (task.offsets + kBlock - 1) / kBlock;
    count = 0;
    int first = 0, at = 0;
    const auto add = [&](int number, double value) {
      if (!(value < __builtin_inf())) return;
      block[count] = number;
      least[count] = value;
      if (value < least[first]) first = count;
      ++count;
    };
    for (; at + kLanes <= blocks; at += kLanes) {
      const Lanes value = reach.template least_through_blocks<kMetric, Lanes>(task, at);
      double lane[kLanes];
      __builtin_memcpy(lane, &value, sizeof value);
      for (int k = 0; k < kLanes; ++k) add(at + k, lane[k]);
    }
    for (; at < blocks; ++at)
      add(at, reach.template least_through_blocks<kMetric, double>(task, at));
    return first;
  }
};

/// Returns the largest value of the nodes first ... last - 1.
inline double largest_value(const RelaxTask<double>& task, int first, int last) {
  double most = task.best[first];
  for (int k = first + 1; k < last; ++k) most = task.best[k] > most ? task.best[k] : most;
  return most;
}

/// Relaxes the nodes at ... reach.last - 1, which are near each other, with the partners in their
/// reach.
template <RelaxMetric kMetric, bool kWraps>
void relax_run_of_nodes(const RelaxTask<double>& task, int at, const Reach<kWraps>& reach,
                        double sure) {
  constexpr int kBlock = RelaxTask<double>::kBlock;
  int near[2 * kMostPartners], count = 0;
  const auto relax = [&] {
    if (count > 0) relax_near<kMetric, kWraps>(task, at, reach.last, near, count, sure);
    count = 0;
  };
  const auto add = [&](int first, int length) {
    const int end = first + length < task.offsets ? first + length : task.offsets;
    count = add_near(task, reach, first, end, near, count);
    if (count >= kMostPartners) relax();
  };
  if (!task.block_middle[0] || task.offsets > kMostBlocks * kBlock) {
    for (int first = 0; first < task.offsets; first += kMostPartners) add(first, kMostPartners);
    relax();
    return;
  }
  Blocks blocks;
  const int best = blocks.list<kMetric, kWraps>(task, reach);
  if (blocks.count == 0) return;
  // The most promising block comes first: its values leave out most of the others.
  add(blocks.block[best] * kBlock, kBlock);
  relax();
  double most = largest_value(task, at, reach.last);
  for (int k = 0; k < blocks.count; ++k) {
    if (k == best || !(blocks.least[k] < most)) continue;
    add(blocks.block[k] * kBlock, kBlock);
    if (count == 0) most = largest_value(task, at, reach.last);
  }
  relax();
}

/// Relaxes runs of nodes near each other with the partners in their reach.
template <RelaxMetric kMetric, bool kWraps>
void relax_all_run(const RelaxTask<double>& task) {
  constexpr int kMost = 8;
  const double sure = sure_measure<kMetric>(task);
  for (int at = 0; at < task.n;) {
    const Reach<kWraps> reach(task, at, task.n - at < kMost ? task.n - at : kMost);
    relax_run_of_nodes<kMetric, kWraps>(task, at, reach, sure);
    at = reach.last;
  }
}

template <RelaxMetric kMetric>
void relax_all_by(const RelaxTask<double>& task) {
  task.wraps ? relax_all_run<kMetric, true>(task) : relax_all_run<kMetric, false>(task);
}

void relax_all(const RelaxTask<double>& task) {
  if (task.metric == RelaxMetric::kL2)
    relax_all_by<RelaxMetric::kL2>(task);
  else if (task.metric == RelaxMetric::kL1)
    relax_all_by<RelaxMetric::kL1>(task);
  else
    relax_all_by<RelaxMetric::kMax>(task);
}

template <RelaxMetric kMetric, class T>
void relax_by(const RelaxTask<T>& task) {
  task.wraps ? relax_run<kMetric, true>(task) : relax_run<kMetric, false>(task);
}

template <class T>
void relax(const RelaxTask<T>& task) {
  if (task.metric == RelaxMetric::kL2)
    relax_by<RelaxMetric::kL2>(task);
  else if (task.metric == RelaxMetric::kL1)
    relax_by<RelaxMetric::kL1>(task);
  else
    relax_by<RelaxMetric::kMax>(task);
}

/// Returns the least of the lanes, by halves.
template <class V, class T>
inline T least_lane(V lanes) {
  constexpr int kLanes = sizeof(V) / sizeof(T);
  T lane[kLanes];
  __builtin_memcpy(lane, &lanes, sizeof lanes);
  for (int half = kLanes / 2; half > 0; half /= 2)
    for (int k = 0; k < half; ++k) lane[k] = lane[k + half] < lane[k] ? lane[k + half] : lane[k];
  return lane[0];
}

template <class V, class T>
inline void add_to_range(const T* q, const T* value, V& low, V& minus_high) {
  const V joint = load<V>(q), none = V{} + T(__builtin_inf()), known = load<V>(value);
  const V up = known < none ? joint : none, down = known < none ? -joint : none;
  low = up < low ? up : low;
  minus_high = down < minus_high ? down : minus_high;
}

template <class T>
void range(const T* q, const T* value, int n, T& low, T& high) {
  using Lanes = typename Widest<T>::Lanes;
  constexpr int kLanes = sizeof(Lanes) / sizeof(T);
  T least = T(__builtin_inf()), minus_most = least;
  if (n >= kLanes) {
    Lanes lows = Lanes{} + least, minus_highs = lows;
    for (int at = 0; at + kLanes <= n; at += kLanes)
      add_to_range(q + at, value + at, lows, minus_highs);
    add_to_range(q + n - kLanes, value + n - kLanes, lows, minus_highs);
    least = least_lane<Lanes, T>(lows);
    minus_most = least_lane<Lanes, T>(minus_highs);
  } else {
    for (int at = 0; at < n; ++at) add_to_range(q + at, value + at, least, minus_most);
  }
  low = least;
  high = -minus_most;
}

}  // namespace
}  // namespace swivel::SWIVEL_ISA
