// SPDX-License-Identifier: BSD-3-Clause
// Measures the kinematic floor: how fast one thread can (1) solve the closed-form IK and joint
// limits of every node of an (s, phi, branch) lattice and (2) sweep a backward layered dynamic
// program over it with a window of +-W arm angles. There is no collision, no singularity and no
// edge across branches. No planner that looks at every node can be expected to be faster, so that
// the kinematic part of a planner is compared with this in the same run.
//
//   floor LAYERS ANGLES WINDOW    such as 201 126 4
//
// The program is built for this machine alone (-march=native -ffast-math). It prints one line:
// layers, arm angles, nodes, valid nodes, IK ms, DP ms (medians of 9), worst FK residual.
#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

// An S-R-S arm with z-y-z triples and the lengths of a 14 kg class arm, m.
constexpr double kBaseShoulder = 0.36, kShoulderElbow = 0.42, kElbowWrist = 0.40,
                 kWristTool = 0.126;
constexpr double kLimit[7] = {2.967, 2.094, 2.967, 2.094, 2.967, 2.094, 3.054};
constexpr double kInfinity = 1e9;

Matrix3d skew(const Vector3d& u) {
  return (Matrix3d() << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0).finished();
}
Matrix3d rot_z(double a) {
  return Eigen::AngleAxisd(a, Vector3d::UnitZ()).toRotationMatrix();
}
Matrix3d rot_y(double a) {
  return Eigen::AngleAxisd(a, Vector3d::UnitY()).toRotationMatrix();
}

struct Pose {
  Vector3d p;
  Matrix3d R;
};

Pose tool_pose(double t) {  // a curved line of about 1 m, t in [0, 1]
  return {{0.45 + 0.05 * std::sin(3 * t), -0.5 + t, 0.45 + 0.1 * t},
          rot_z(0.3 * t) * rot_y(M_PI * 0.75)};
}

Pose forward(const double* q) {
  const Matrix3d R03 = rot_z(q[0]) * rot_y(q[1]) * rot_z(q[2]), R34 = rot_y(q[3]);
  const Matrix3d R = R03 * R34 * rot_z(q[4]) * rot_y(q[5]) * rot_z(q[6]);
  const Vector3d wrist = Vector3d(0, 0, kBaseShoulder) + R03 * Vector3d(0, 0, kShoulderElbow) +
                         R03 * R34 * Vector3d(0, 0, kElbowWrist);
  return {wrist + R * Vector3d(0, 0, kWristTool), R};
}

struct Lattice {
  int layers, angles;
  std::vector<double> q;             // [layer][branch][joint][angle]
  std::vector<unsigned char> valid;  // [layer][branch][angle]
  std::vector<double> sin_phi, cos_phi;
  Lattice(int m, int n)
      : layers(m),
        angles(n),
        q(size_t(m) * 8 * 7 * n),
        valid(size_t(m) * 8 * n),
        sin_phi(n),
        cos_phi(n) {
    for (int k = 0; k < n; ++k) {
      sin_phi[k] = std::sin(-M_PI + 2 * M_PI * k / n);
      cos_phi[k] = std::cos(-M_PI + 2 * M_PI * k / n);
    }
  }
  double* joint(int i, int b, int j) { return &q[((size_t(i) * 8 + b) * 7 + j) * angles]; }
  unsigned char* ok(int i, int b) { return &valid[(size_t(i) * 8 + b) * angles]; }
};

// Three z-y-z angles of A sin(phi) + B cos(phi) + C for the whole circle.
void zyz_circle(const Matrix3d& A, const Matrix3d& B, const Matrix3d& C, const Lattice& l,
                double* first, double* second, double* third) {
  const double *s = l.sin_phi.data(), *c = l.cos_phi.data();
  const double a02 = A(0, 2), b02 = B(0, 2), c02 = C(0, 2), a12 = A(1, 2), b12 = B(1, 2),
               c12 = C(1, 2), a22 = A(2, 2), b22 = B(2, 2), c22 = C(2, 2), a21 = A(2, 1),
               b21 = B(2, 1), c21 = C(2, 1), a20 = A(2, 0), b20 = B(2, 0), c20 = C(2, 0);
#pragma GCC ivdep
  for (int k = 0; k < l.angles; ++k) {
    first[k] = std::atan2(a12 * s[k] + b12 * c[k] + c12, a02 * s[k] + b02 * c[k] + c02);
    second[k] = std::acos(std::min(1.0, std::max(-1.0, a22 * s[k] + b22 * c[k] + c22)));
    third[k] = std::atan2(a21 * s[k] + b21 * c[k] + c21, -(a20 * s[k] + b20 * c[k] + c20));
  }
}

void flip(double* out, const double* in, int n) {
#pragma GCC ivdep
  for (int k = 0; k < n; ++k) out[k] = in[k] > 0 ? in[k] - M_PI : in[k] + M_PI;
}
void negate(double* out, const double* in, int n) {
#pragma GCC ivdep
  for (int k = 0; k < n; ++k) out[k] = -in[k];
}

void solve_layer(Lattice& l, int i) {
  const int n = l.angles;
  const Pose tool = tool_pose(double(i) / (l.layers - 1));
  const Vector3d sw = tool.p - tool.R * Vector3d(0, 0, kWristTool) - Vector3d(0, 0, kBaseShoulder);
  const Vector3d u = sw.normalized();
  const double cos4 =
      (sw.squaredNorm() - kShoulderElbow * kShoulderElbow - kElbowWrist * kElbowWrist) /
      (2 * kShoulderElbow * kElbowWrist);
  for (int elbow = 0; elbow < 2; ++elbow) {
    const double q4 = (elbow ? -1 : 1) * std::acos(std::clamp(cos4, -1.0, 1.0));
    const double beta =
        std::atan2(kElbowWrist * std::sin(q4), kShoulderElbow + kElbowWrist * std::cos(q4));
    const Matrix3d R03_ref =
        rot_z(std::atan2(u.y(), u.x())) * rot_y(std::acos(std::clamp(u.z(), -1.0, 1.0)) - beta);
    const Matrix3d K = skew(u), A = K * R03_ref, B = -K * K * R03_ref,
                   C = u * u.transpose() * R03_ref, R43 = rot_y(q4).transpose();
    const int b0 = elbow * 4;
    zyz_circle(A, B, C, l, l.joint(i, b0, 0), l.joint(i, b0, 1), l.joint(i, b0, 2));
    zyz_circle(R43 * A.transpose() * tool.R, R43 * B.transpose() * tool.R,
               R43 * C.transpose() * tool.R, l, l.joint(i, b0, 4), l.joint(i, b0, 5),
               l.joint(i, b0, 6));
    std::fill_n(l.joint(i, b0, 3), n, q4);
    for (int b = 1; b < 4; ++b)
      for (int triple = 0; triple < 7; triple += 4) {
        double *x = l.joint(i, b0, triple), *y = l.joint(i, b0 + b, triple);
        if (b & (triple ? 2 : 1)) {
          flip(y, x, n);
          negate(y + n, x + n, n);
          flip(y + 2 * n, x + 2 * n, n);
        } else
          std::copy(x, x + 3 * n, y);
        std::fill_n(l.joint(i, b0 + b, 3), n, q4);
      }
    for (int b = b0; b < b0 + 4; ++b) {
      unsigned char* ok = l.ok(i, b);
      std::fill_n(ok, n, (unsigned char)(std::abs(cos4) <= 1));
      for (int j = 0; j < 7; ++j) {
        const double* x = l.joint(i, b, j);
#pragma GCC ivdep
        for (int k = 0; k < n; ++k) ok[k] &= std::abs(x[k]) <= kLimit[j];
      }
    }
  }
}

double sweep(Lattice& l, int W, std::vector<double>& g) {
  const int n = l.angles, m = l.layers;
  g.assign(size_t(m) * 8 * n, kInfinity);
  std::vector<double> pad[8];
  for (auto& p : pad) p.resize(n + 2 * W);
  for (int b = 0; b < 8; ++b)
    for (int k = 0; k < n; ++k)
      if (l.ok(m - 1, b)[k]) g[(size_t(m - 1) * 8 + b) * n + k] = 0;
  for (int i = m - 2; i >= 0; --i)
    for (int b = 0; b < 8; ++b) {
      double* gi = &g[(size_t(i) * 8 + b) * n];
      for (int j = 0; j < 8; ++j) {
        const double* src = j < 7 ? l.joint(i + 1, b, j) : &g[(size_t(i + 1) * 8 + b) * n];
        for (int k = 0; k < W; ++k) {
          pad[j][k] = src[n - W + k];
          pad[j][n + W + k] = src[k];
        }
        std::copy(src, src + n, &pad[j][W]);
      }
      const double* x = l.joint(i, b, 0);
      for (int w = 0; w <= 2 * W; ++w) {
        const double *p0 = &pad[0][w], *p1 = &pad[1][w], *p2 = &pad[2][w], *p3 = &pad[3][w],
                     *p4 = &pad[4][w], *p5 = &pad[5][w], *p6 = &pad[6][w], *pg = &pad[7][w];
#pragma GCC ivdep
        for (int k = 0; k < n; ++k) {
          const double d0 = x[k] - p0[k], d1 = x[n + k] - p1[k], d2 = x[2 * n + k] - p2[k],
                       d3 = x[3 * n + k] - p3[k], d4 = x[4 * n + k] - p4[k],
                       d5 = x[5 * n + k] - p5[k], d6 = x[6 * n + k] - p6[k];
          const double c =
              std::sqrt(d0 * d0 + d1 * d1 + d2 * d2 + d3 * d3 + d4 * d4 + d5 * d5 + d6 * d6) +
              pg[k];
          gi[k] = c < gi[k] ? c : gi[k];
        }
      }
      for (int k = 0; k < n; ++k)
        if (!l.ok(i, b)[k]) gi[k] = kInfinity;
    }
  return *std::min_element(g.begin(), g.begin() + 8 * n);
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + v.size() / 2, v.end());
  return v[v.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && (argc > 4 || argv[1][0] == '-')) {
    const bool help = std::string_view(argv[1]) == "--help" || std::string_view(argv[1]) == "-h";
    std::fprintf(help ? stdout : stderr,
                 "floor [LAYERS=201 [ANGLES=126 [WINDOW=4]]]: times of one thread's closed-form IK "
                 "and sweep\n");
    return help ? 0 : 2;
  }
  const int m = argc > 1 ? std::atoi(argv[1]) : 201, n = argc > 2 ? std::atoi(argv[2]) : 126,
            W = argc > 3 ? std::atoi(argv[3]) : 4;
  if (m < 2 || n < 2 * W + 1 || W < 0) {
    std::fprintf(stderr, "usage: floor LAYERS>=2 ANGLES>=2W+1 W>=0\n");
    return 2;
  }
  const auto ms = [](auto t) { return std::chrono::duration<double, std::milli>(t).count(); };
  using Clock = std::chrono::steady_clock;
  Lattice l(m, n);
  std::vector<double> g, ik_ms, dp_ms;
  double best = 0;
  for (int rep = 0; rep < 10; ++rep) {
    const auto t0 = Clock::now();
    for (int i = 0; i < m; ++i) solve_layer(l, i);
    const auto t1 = Clock::now();
    best = sweep(l, W, g);
    const auto t2 = Clock::now();
    if (rep) {
      ik_ms.push_back(ms(t1 - t0));
      dp_ms.push_back(ms(t2 - t1));
    }
  }
  double residual = 0;
  for (int i = 0; i < m; i += 17)
    for (int b = 0; b < 8; ++b)
      for (int k = 0; k < n; k += 13) {
        double q[7];
        for (int j = 0; j < 7; ++j) q[j] = l.joint(i, b, j)[k];
        const Pose a = forward(q), d = tool_pose(double(i) / (m - 1));
        residual = std::max({residual, (a.p - d.p).norm(), (a.R - d.R).norm()});
      }
  size_t valid = 0;
  for (unsigned char v : l.valid) valid += v;
  std::printf(
      "layers=%d angles=%d nodes=%zu valid=%zu ik_ms=%.3f dp_ms=%.3f cost=%.6f fk_residual=%.1e\n",
      m, n, size_t(m) * n * 8, valid, median(ik_ms), median(dp_ms), best, residual);
  return residual < 1e-9 ? 0 : 1;
}
