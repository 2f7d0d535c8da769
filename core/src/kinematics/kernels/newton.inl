// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, inside namespace SWIVEL_ISA; circle.inl says why nothing
// shared with other files appears here. A lane is a point: every lane's operations have one order,
// so a point's bits depend on neither its neighbours nor the instruction set.
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace swivel::SWIVEL_ISA {
namespace {

constexpr double kRank = 1e-9;       // a smaller pivot means that the Jacobian has lost rank
constexpr double kRound = 0x1.8p52;  // added and taken away again, it rounds to an integer

// Operations that plain C++ lacks for a vector of lanes: the widest vector of this instruction set,
// and one number.
using Widest =
#if defined(__AVX512F__)
    __m512d;
#elif defined(__AVX2__)
    __m256d;
#else
    double;
#endif
constexpr int kLanes = sizeof(Widest) / sizeof(double);

inline double root(double x) {
  return __builtin_sqrt(x);
}
inline double magnitude(double x) {
  return __builtin_fabs(x);
}
inline bool any_above(double a, double b) {
  return a > b;
}
#if defined(__AVX512F__)
inline __m512d root(__m512d x) {
  return _mm512_maskz_sqrt_pd(0xff, x);  // GCC 12 warns of the plain one
}
inline __m512d magnitude(__m512d x) {
  return _mm512_abs_pd(x);
}
inline bool any_above(__m512d a, __m512d b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ) != 0;
}
#elif defined(__AVX2__)
inline __m256d root(__m256d x) {
  return _mm256_sqrt_pd(x);
}
inline __m256d magnitude(__m256d x) {
  return _mm256_andnot_pd(_mm256_set1_pd(-0.0), x);
}
inline bool any_above(__m256d a, __m256d b) {
  return _mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ)) != 0;
}
#endif

/// One of seven columns, chosen by each lane for itself.
template <class V>
struct Column {
  V number;
  [[nodiscard]] V of(const V* row) const {
    V value = row[0];
    for (int c = 1; c < 7; ++c) value = number == double(c) ? row[c] : value;
    return value;
  }
  void set(V* row, V to) const {
    for (int c = 0; c < 7; ++c) row[c] = number == double(c) ? to : row[c];
  }
};
template <class V>
struct Vec3 {
  V x, y, z;
};
template <class V>
inline Vec3<V> operator+(const Vec3<V>& a, const Vec3<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class V>
inline Vec3<V> operator-(const Vec3<V>& a, const Vec3<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class V, class S>
inline Vec3<V> operator*(S s, const Vec3<V>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class V>
inline Vec3<V> cross(const Vec3<V>& a, const Vec3<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class V>
inline Vec3<V> constant(const double* from) {
  return {V{} + from[0], V{} + from[1], V{} + from[2]};
}

template <class V>
inline V dot(const V* a, const V* b) {
  return (((a[0] * b[0]) + (a[2] * b[2] + a[4] * b[4])) +
          ((a[1] * b[1]) + (a[3] * b[3] + a[5] * b[5]))) +
         a[6] * b[6];
}

/// Computes sine and cosine of an angle of a few turns, to about 1 ulp. Source: reduction to an
/// eighth of a turn in two parts (Cody & Waite 1980), polynomials of fdlibm's k_sin and k_cos.
template <class V>
inline void sine_cosine(V x, V& sine, V& cosine) {
  // two parts of pi/2; the product of the high part with a small integer is exact
  constexpr double kHigh = 0x1.921fb544p0, kLow = 0x1.0b4611a626331p-34;
  const V quarters = (x * (2 / 3.14159265358979323846) + kRound) - kRound;
  const V r = (x - quarters * kHigh) - quarters * kLow, z = r * r;
  const V s =
      r + r * z *
              (-1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 +
                                                                z * 1.58969099521155010221e-10)))));
  const V c =
      1.0 -
      (0.5 * z -
       z * z *
           (4.16666666666666019037e-02 +
            z * (-1.38888888888741095749e-03 +
                 z * (2.48015872894767294178e-05 +
                      z * (-2.75573143513906633035e-07 +
                           z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))))));
  const V m = quarters - 4.0 * ((quarters * 0.25 + kRound) - kRound), square = m * m;  // -2 ... 2
  const V a = square == 1.0 ? c : s, b = square == 1.0 ? s : c;
  const V turned = square == 4.0 ? -a : a;
  sine = m == -1.0 ? -a : turned;
  const V back = m == -2.0 ? -b : b;
  cosine = m > 0.0 ? -b : back;
}

/// Returns the angle by which joint k turns the frame of its link, rad.
template <class V>
inline V angle_of(const NewtonChain& chain, const V* q, int k) {
  return k == chain.slide ? V{} + chain.link[k].turn : V(q[k] + chain.link[k].turn);
}

/// Axes of the joints, the tool's origin, and the pose error: `miss` (m) and `turn` (rad).
template <class V>
struct Stand {
  Vec3<V> axis[7], point[7], tool, miss, turn;
};
template <class V>
inline void stand_at(const NewtonTask& task, const V* q, const V* sine, const V* cosine,
                     Stand<V>& out) {
  const NewtonChain& chain = *task.chain;
  Vec3<V> X = constant<V>(chain.first[0]), Y = constant<V>(chain.first[1]),
          Z = constant<V>(chain.first[2]), P = constant<V>(chain.first[3]);
  for (int k = 0; k < 7; ++k) {
    out.axis[k] = Z;
    out.point[k] = P;
    const NewtonChain::Link& link = chain.link[k];
    const Vec3<V> x = cosine[k] * X + sine[k] * Y, y = cosine[k] * Y - sine[k] * X;
    if (k == chain.slide) P = P + q[k] * Z;
    if (k == 6) {  // no more than its own motion
      X = x;
      Y = y;
      break;
    }
    P = P + (link.height * Z + link.width * x);
    X = x;
    Y = link.twist_cosine * y + link.twist_sine * Z;
    Z = link.twist_cosine * Z - link.twist_sine * y;
  }
  const double(&L)[4][3] = chain.last;
  const auto in_base = [&](const double* v) { return (v[0] * X + v[1] * Y) + v[2] * Z; };
  out.tool = P + in_base(L[3]);
  const Vec3<V> tx = in_base(L[0]), ty = in_base(L[1]), tz = in_base(L[2]);
  out.miss = constant<V>(task.tool[3]) - out.tool;
  out.turn = 0.5 * ((cross(tx, constant<V>(task.tool[0])) + cross(ty, constant<V>(task.tool[1]))) +
                    cross(tz, constant<V>(task.tool[2])));
}

/// Sets the rows of the Jacobian (columns 0 to 6) and the pose error (column 7).
template <class V>
[[gnu::always_inline]] inline void linearise(const Stand<V>& stand, int slide, V (&A)[6][8]) {
  for (int k = 0; k < 7; ++k) {
    const Vec3<V> v = cross(stand.axis[k], stand.tool - stand.point[k]);
    A[0][k] = v.x;
    A[1][k] = v.y;
    A[2][k] = v.z;
    A[3][k] = stand.axis[k].x;
    A[4][k] = stand.axis[k].y;
    A[5][k] = stand.axis[k].z;
  }
  if (slide >= 0) {
    const Vec3<V>& along = stand.axis[slide];
    A[0][slide] = along.x;
    A[1][slide] = along.y;
    A[2][slide] = along.z;
    A[3][slide] = A[4][slide] = A[5][slide] = V{};
  }
  A[0][7] = stand.miss.x;
  A[1][7] = stand.miss.y;
  A[2][7] = stand.miss.z;
  A[3][7] = stand.turn.x;
  A[4][7] = stand.turn.y;
  A[5][7] = stand.turn.z;
}

/// Eliminates by Gauss; each row takes the largest column left as its pivot. `taken` becomes the
/// sum of the pivots' columns. Returns 0 in lanes whose Jacobian has lost rank, else 1; ends where
/// all lanes have.
template <class V>
[[gnu::always_inline]] inline V eliminate(V (&A)[6][8], Column<V> (&pivot)[6], V& taken) {
  V left[7], whole = V{} + 1.0;
  for (int c = 0; c < 7; ++c) left[c] = V{} + 1.0;
  for (int r = 0; r < 6; ++r) {
    V size = magnitude(A[r][0]) * left[0], number = V{};
    for (int c = 1; c < 7; ++c) {
      const V other = magnitude(A[r][c]) * left[c];
      number = other > size ? V{} + double(c) : number;
      size = other > size ? other : size;
    }
    whole = size > kRank ? whole : V{};
    if (!any_above(whole, V{})) return whole;
    pivot[r] = {number};
    taken = taken + number;
    pivot[r].set(left, V{});
    const V scale = 1.0 / pivot[r].of(A[r]);
    for (int c = 0; c < 8; ++c) A[r][c] = A[r][c] * scale;
    for (int i = r + 1; i < 6; ++i) {
      const V factor = pivot[r].of(A[i]);
      for (int c = 0; c < 8; ++c) A[i][c] = A[i][c] - factor * A[r][c];
    }
  }
  return whole;
}

/// Computes the moves particular + lambda null that close the pose error to first order. Returns 0
/// in lanes whose Jacobian has lost rank, else 1.
template <class V>
inline V linear(const NewtonTask& task, const V* q, V* particular, V* null) {
  Stand<V> stand;
  V sine[7], cosine[7];
  for (int k = 0; k < 7; ++k) sine_cosine(angle_of(*task.chain, q, k), sine[k], cosine[k]);
  stand_at(task, q, sine, cosine, stand);
  V A[6][8], taken = V{};
  linearise(stand, task.chain->slide, A);
  Column<V> pivot[6];
  const V whole = eliminate(A, pivot, taken);
  if (!any_above(whole, V{})) {
    for (int c = 0; c < 7; ++c) particular[c] = null[c] = V{};
    return whole;
  }
  const Column<V> free = {21.0 - taken};
  V part[6], kernel[6];  // by pivots
  for (int r = 5; r >= 0; --r) {
    part[r] = A[r][7];
    kernel[r] = -free.of(A[r]);
    for (int i = r + 1; i < 6; ++i) {
      const V a = pivot[i].of(A[r]);
      part[r] = part[r] - a * part[i];
      kernel[r] = kernel[r] - a * kernel[i];
    }
  }
  for (int c = 0; c < 7; ++c) {
    particular[c] = V{};
    null[c] = V{} + 1.0;
  }
  for (int r = 0; r < 6; ++r) {
    pivot[r].set(particular, part[r]);
    pivot[r].set(null, kernel[r]);
  }
  return whole;
}

/// Eliminates as above, for one point. `free` becomes the column without a pivot. Returns false
/// where the Jacobian has lost rank.
[[gnu::always_inline]] inline bool eliminate(double (&A)[6][8], int (&pivot)[6], int& free) {
  double left[7] = {1, 1, 1, 1, 1, 1, 1};
  free = 21;
  for (int r = 0; r < 6; ++r) {
    int column = 0;
    double size = magnitude(A[r][0]) * left[0];
    for (int c = 1; c < 7; ++c) {
      const double other = magnitude(A[r][c]) * left[c];
      column = other > size ? c : column;
      size = other > size ? other : size;
    }
    if (!(size > kRank)) return false;
    left[column] = 0;
    pivot[r] = column;
    free -= column;
    const double scale = 1.0 / A[r][column];
    for (double& a : A[r]) a *= scale;
    for (int i = r + 1; i < 6; ++i) {
      const double factor = A[i][column];
      for (int c = 0; c < 8; ++c) A[i][c] = A[i][c] - factor * A[r][c];
    }
  }
  return true;
}

/// Computes linear() for one point, with vectors along the rows of the matrix.
template <>
inline double linear<double>(const NewtonTask& task, const double* q, double* particular,
                             double* null) {
  double angle[8], sine[8], cosine[8], A[6][8];  // seven joints, and the pose error
  for (int k = 0; k < 7; ++k) angle[k] = angle_of(*task.chain, q, k);
  angle[7] = 0;
  for (int k = 0; k < 8; ++k) sine_cosine(angle[k], sine[k], cosine[k]);
  Stand<double> stand;
  stand_at(task, q, sine, cosine, stand);
  linearise(stand, task.chain->slide, A);
  int pivot[6], free;
  if (!eliminate(A, pivot, free)) {
    for (int c = 0; c < 7; ++c) particular[c] = null[c] = 0;
    return 0;
  }
  particular[free] = 0;
  null[free] = 1;
  for (int r = 5; r >= 0; --r) {
    double part = A[r][7], kernel = -A[r][free];
    for (int i = r + 1; i < 6; ++i) {
      const double a = A[r][pivot[i]];
      part = part - a * particular[pivot[i]];
      kernel = kernel - a * null[pivot[i]];
    }
    particular[pivot[r]] = part;
    null[pivot[r]] = kernel;
  }
  return 1;
}

/// Reads and writes as many points of a task as V has lanes, from point `at` on; lanes beyond the
/// last point repeat it.
template <class V>
struct Lanes {
  static constexpr int kOwn = sizeof(V) / sizeof(double);
  const NewtonTask& task;
  int at;

  [[nodiscard]] V gather(const double* from, int stride, int offset) const {
    double lanes[kOwn];
    for (int lane = 0; lane < kOwn; ++lane) {
      const int point = at + lane < task.n ? at + lane : task.n - 1;
      lanes[lane] = from[point * stride + offset];
    }
    V value;
    __builtin_memcpy(&value, lanes, sizeof value);
    return value;
  }
  void scatter(V value, double* to, int offset) const {
    double lanes[kOwn];
    __builtin_memcpy(lanes, &value, sizeof value);
    for (int lane = 0; lane < kOwn && at + lane < task.n; ++lane)
      to[(at + lane) * task.stride + offset] = lanes[lane];
  }
};

/// Runs Newton from q, which becomes what it finds, with a joint at its value or by the least
/// weighted moves. `tangent` becomes the direction of the self-motion there. Returns 1 in lanes
/// that settle, else 0.
template <class V>
[[gnu::always_inline]] inline V run_newton(const NewtonTask& task, const Lanes<V>& lanes, V* q,
                                           V* tangent) {
  const bool locked = task.move == NewtonMove::kLocked;
  const V value = locked ? lanes.gather(task.value, 1, 0) : V{};
  V particular[7], null[7], found = V{}, going = V{} + 1.0;
  for (int j = 0; j < 7; ++j) tangent[j] = V{};
  for (int step = 0; step < task.steps && any_above(going, V{}); ++step) {
    going = going * linear(task, q, particular, null);
    V along;
    if (locked) {
      const V own = null[task.joint];
      going = own == 0.0 ? V{} : going;
      along = ((value - q[task.joint]) - particular[task.joint]) / own;
    } else {
      V weighted[7];
      for (int j = 0; j < 7; ++j) weighted[j] = task.scale2[j] * null[j];
      along = -(dot(weighted, particular) / dot(weighted, null));
    }
    V move[7];
    for (int j = 0; j < 7; ++j) move[j] = particular[j] + along * null[j];
    const V length2 = dot(move, move);
    going = length2 < task.longest * task.longest ? going : V{};
    for (int j = 0; j < 7; ++j) q[j] = going > 0.0 ? q[j] + move[j] : q[j];
    if (locked) q[task.joint] = going > 0.0 ? value : q[task.joint];
    const V settled = length2 < task.settled * task.settled ? going : V{};
    if (!any_above(settled, V{})) continue;
    const V length = root(dot(null, null));
    for (int j = 0; j < 7; ++j) tangent[j] = settled > 0.0 ? null[j] / length : tangent[j];
    found = found + settled;
    going = going - settled;
  }
  return found;
}

/// Solves as many points as V has lanes, from `at` on.
template <class V>
void solve_lanes(const NewtonTask& task, int at) {
  const Lanes<V> lanes{task, at};
  V q[7], found = V{};
  for (int j = 0; j < 7; ++j) q[j] = lanes.gather(task.start, task.stride, j);
  if (task.move == NewtonMove::kNone) {
    V particular[7], null[7];
    found = linear(task, q, particular, null);
    for (int j = 0; j < 7; ++j) {
      lanes.scatter(particular[j], task.particular, j);
      lanes.scatter(null[j], task.null, j);
    }
  } else {
    V tangent[7];
    found = run_newton(task, lanes, q, tangent);
    for (int j = 0; j < 7; ++j) {
      lanes.scatter(q[j], task.q, j);
      lanes.scatter(tangent[j], task.null, j);
    }
  }
  double of_lanes[Lanes<V>::kOwn];
  __builtin_memcpy(of_lanes, &found, sizeof found);
  for (int lane = 0; lane < Lanes<V>::kOwn && at + lane < task.n; ++lane)
    task.found[at + lane] = of_lanes[lane] > 0;
}

void solve(const NewtonTask& task) {
  int at = 0;
  for (; task.n - at > 1; at += kLanes) solve_lanes<Widest>(task, at);
  if (at < task.n) solve_lanes<double>(task, at);
}

}  // namespace
}  // namespace swivel::SWIVEL_ISA
