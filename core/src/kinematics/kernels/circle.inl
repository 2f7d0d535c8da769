// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, inside namespace SWIVEL_ISA. Only raw pointers and
// arithmetic here: the linker could keep this file's copy of an inline function shared with other
// files, with instructions that the processor lacks. No contraction, so that all give the same
// bits.

namespace swivel::SWIVEL_ISA {
namespace {

/// Returns atan2(y, x) to about 1 ulp. t = min/max, reduced to |t| <= tan(pi/8); polynomial of
/// degree 11 in t^2 (interpolated at Chebyshev nodes, truncation error 1.3e-18).
inline double atan2_poly(double y, double x) {
  const double ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const double big = ax > ay ? ax : ay, small = ax > ay ? ay : ax;
  const bool fold = small > 0.41421356237309503 * big;
  const double num = fold ? small - big : small, den = fold ? small + big : big;
  const double t = num / (den > 0 ? den : 1.0);
  const double z = t * t;
  double p = -0.017805395704537506;
  p = p * z + 0.037965256099576565;
  p = p * z - 0.050351024039430294;
  p = p * z + 0.05846878285787001;
  p = p * z - 0.06662951812061838;
  p = p * z + 0.07692045330765912;
  p = p * z - 0.09090896809056438;
  p = p * z + 0.11111110744919396;
  p = p * z - 0.1428571427925024;
  p = p * z + 0.1999999999994089;
  p = p * z - 0.3333333333333312;
  const double core = t + t * z * p;
  const double octant = fold ? core + 0.78539816339744831 : core;
  const double quadrant = ay > ax ? 1.5707963267948966 - octant : octant;
  const double half = x < 0 ? 3.1415926535897931 - quadrant : quadrant;
  return y < 0 ? -half : half;
}

inline double larger(double a, double b) {
  return a > b ? a : b;
}

/// Returns angle q plus the whole turns that bring it into [base, base + 2 pi).
inline double image_from(double q, double base) {
  const double x = (base - q) * 0.15915494309189535;
  const double r = (x + 6755399441055744.0) - 6755399441055744.0;  // nearest integer
  const double k = r < x ? r + 1.0 : r;
  return q + 6.2831853071795862 * k;
}

void solve_triple(const TripleTask& task) {
  const double* __restrict s = task.sin_phi;
  const double* __restrict c = task.cos_phi;
  double* __restrict first0 = task.q[0][0];
  double* __restrict middle0 = task.q[0][1];
  double* __restrict last0 = task.q[0][2];
  double* __restrict first1 = task.q[1][0];
  double* __restrict middle1 = task.q[1][1];
  double* __restrict last1 = task.q[1][2];
  double* __restrict mask0 = task.mask[0];
  double* __restrict mask1 = task.mask[1];
  const double a02 = task.m[0][0], b02 = task.m[0][1], c02 = task.m[0][2], a12 = task.m[1][0],
               b12 = task.m[1][1], c12 = task.m[1][2], a22 = task.m[2][0], b22 = task.m[2][1],
               c22 = task.m[2][2], a20 = task.m[3][0], b20 = task.m[3][1], c20 = task.m[3][2],
               a21 = task.m[4][0], b21 = task.m[4][1], c21 = task.m[4][2];
  const double base0 = task.base[0], base1 = task.base[1], base2 = task.base[2], shift = task.shift;
  const double upper0 = task.upper[0], upper1 = task.upper[1], upper2 = task.upper[2],
               least_sine = task.least_sine;
// GCC gives up on more than ten run-time alias checks, and forgets restrict on locals
#pragma GCC ivdep
  for (int k = 0; k < task.n; ++k) {
    const double x = a02 * s[k] + b02 * c[k] + c02, y = a12 * s[k] + b12 * c[k] + c12,
                 z = a22 * s[k] + b22 * c[k] + c22;
    const double h = __builtin_sqrt(x * x + y * y);
    const double first = atan2_poly(y, x), middle = atan2_poly(h, z);
    const double last = atan2_poly(a21 * s[k] + b21 * c[k] + c21, -(a20 * s[k] + b20 * c[k] + c20));
    const double first_flip = first > 0 ? first - 3.1415926535897931 : first + 3.1415926535897931;
    const double last_flip = last > 0 ? last - 3.1415926535897931 : last + 3.1415926535897931;
    const double f0 = image_from(first, base0), m0 = image_from(middle - shift, base1),
                 l0 = image_from(last, base2);
    const double f1 = image_from(first_flip, base0), m1 = image_from(-middle - shift, base1),
                 l1 = image_from(last_flip, base2);
    const double excess0 =
        larger(larger(f0 - upper0, m0 - upper1), larger(l0 - upper2, least_sine - h));
    const double excess1 =
        larger(larger(f1 - upper0, m1 - upper1), larger(l1 - upper2, least_sine - h));
    first0[k] = f0;
    middle0[k] = m0;
    last0[k] = l0;
    first1[k] = f1;
    middle1[k] = m1;
    last1[k] = l1;
    mask0[k] = excess0 <= 0 ? 0.0 : __builtin_inf();
    mask1[k] = excess1 <= 0 ? 0.0 : __builtin_inf();
  }
}

}  // namespace

}  // namespace swivel::SWIVEL_ISA
