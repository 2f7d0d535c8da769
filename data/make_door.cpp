// SPDX-License-Identifier: BSD-3-Clause
// Makes the car-door panel of experiment C and the polishing path on it:
//   make_door --triangles N OUT.stl      a closed panel of about N triangles, binary STL, metres
//   make_door --path OUT.csv             tool poses x,y,z,qw,qx,qy,qz in the door's frame
// Door frame: x along the door (towards its rear), y inwards, z up; the origin lies on the outer
// surface in the middle of the belt line. Only + - * / and sqrt, all correctly rounded, so that
// every machine writes the same bytes.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using Vec = std::array<double, 3>;

constexpr double kThickness = 0.040;
constexpr double kStandOff = 0.012;
// Where the grid of the panel has lines: outline and window, before the front pillar is slanted.
constexpr std::array<double, 4> kLinesX{-0.75, -0.50, 0.60, 0.75};
constexpr std::array<double, 4> kLinesZ{-0.50, 0.07, 0.41, 0.50};

Vec operator+(const Vec& a, const Vec& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vec operator-(const Vec& a, const Vec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec operator*(double s, const Vec& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec unit(const Vec& a) {
  const double n = std::sqrt(dot(a, a));
  return {a[0] / n, a[1] / n, a[2] / n};
}

/// Outer surface: bent along the door, a belly below the belt line, leaning inwards above it.
Vec surface(double x, double z) {
  return {x, 0.12 * x * x + 0.20 * z + 0.45 * z * z, z};
}
/// Its unit normal, outwards (-y).
Vec outward(double x, double z) {
  return unit({0.24 * x, -1.0, 0.20 + 0.90 * z});
}
/// The front pillar leans back above the belt line.
double slanted(double x, double z) {
  return z > 0 ? x + 0.6 * z * (0.75 - x) / 1.5 : x;
}

/// Grid coordinates between given lines, about `step` apart; `hole` receives the indices between
/// which the window lies.
std::vector<double> grid(const std::array<double, 4>& lines, double step,
                         std::pair<int, int>& hole) {
  std::vector<double> result{lines[0]};
  for (std::size_t k = 0; k + 1 < lines.size(); ++k) {
    if (k == 1) hole.first = static_cast<int>(result.size()) - 1;
    const double length = lines[k + 1] - lines[k];
    const int parts = length < step ? 1 : static_cast<int>(length / step + 0.5);
    for (int i = 1; i < parts; ++i) result.push_back(lines[k] + length * i / parts);
    result.push_back(lines[k + 1]);
    if (k == 1) hole.second = static_cast<int>(result.size()) - 1;
  }
  return result;
}

struct Mesh {
  std::vector<Vec> vertices;
  std::vector<std::array<int, 3>> triangles;
};

Mesh panel(double step) {
  std::pair<int, int> hole_x, hole_z;
  const std::vector<double> xs = grid(kLinesX, step, hole_x), zs = grid(kLinesZ, step, hole_z);
  const int nx = static_cast<int>(xs.size()), nz = static_cast<int>(zs.size());

  Mesh mesh;
  for (const double depth : {0.0, kThickness})
    for (const double z : zs)
      for (const double x : xs) {
        const double sx = slanted(x, z);
        mesh.vertices.push_back(surface(sx, z) - depth * outward(sx, z));
      }

  // Outer IK solution: counter-clockwise in (x, z), so that its normals point to -y.
  for (int j = 0; j + 1 < nz; ++j)
    for (int i = 0; i + 1 < nx; ++i) {
      if (i >= hole_x.first && i < hole_x.second && j >= hole_z.first && j < hole_z.second)
        continue;
      const int a = j * nx + i, b = a + 1, c = b + nx, d = a + nx;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }

  // Walls along every edge that has a triangle on one side only, and the inner IK solution, turned
  // over.
  std::set<std::pair<int, int>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
  const std::vector<std::array<int, 3>> outer = mesh.triangles;
  const int inner = nx * nz;
  for (const auto& t : outer) mesh.triangles.push_back({t[0] + inner, t[2] + inner, t[1] + inner});
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) {
      mesh.triangles.push_back({b, a, a + inner});
      mesh.triangles.push_back({b, a + inner, b + inner});
    }
  return mesh;
}

/// The coarsest panel of a series of ever finer ones that has at least `count` triangles, or the
/// one before if that is closer.
Mesh panel_of(int count) {
  Mesh before = panel(1.5 / 4);
  for (int parts = 5;; ++parts) {
    Mesh mesh = panel(1.5 / parts);
    const int now = static_cast<int>(mesh.triangles.size()),
              then = static_cast<int>(before.triangles.size());
    if (now >= count) return now - count < count - then ? mesh : before;
    before = std::move(mesh);
  }
}

void append(std::string& bytes, float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<char>((bits >> (8 * k)) & 0xff));
}

std::string stl(const Mesh& mesh) {
  std::string bytes = "Swivel car-door panel, metres; made by data/make_door.cpp";
  bytes.resize(80, ' ');
  const std::uint32_t count = static_cast<std::uint32_t>(mesh.triangles.size());
  for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<char>((count >> (8 * k)) & 0xff));
  for (const auto& t : mesh.triangles) {
    const auto vertex = [&](std::size_t k) {
      return mesh.vertices[static_cast<std::size_t>(t[k])];
    };
    const Vec normal = unit(cross(vertex(1) - vertex(0), vertex(2) - vertex(0)));
    for (const Vec& v : {normal, vertex(0), vertex(1), vertex(2)})
      for (const double c : v)
        append(bytes, static_cast<float>(c) + 0.0f);  // + 0: no negative zero, which would not weld
    bytes.append(2, '\0');
  }
  return bytes;
}

/// Unit quaternion (w, x, y, z) of the rotation with the given columns. Shepperd 1978.
std::array<double, 4> quaternion(const Vec& x, const Vec& y, const Vec& z) {
  const double trace = x[0] + y[1] + z[2];
  const std::array<double, 4> square{1 + trace, 1 + 2 * x[0] - trace, 1 + 2 * y[1] - trace,
                                     1 + 2 * z[2] - trace};  // 4 q_k^2
  std::size_t k = 0;
  for (std::size_t m = 1; m < 4; ++m)
    if (square[m] > square[k]) k = m;
  const double r = std::sqrt(square[k]), f = 1 / (2 * r);
  switch (k) {
    case 0:
      return {r / 2, (y[2] - z[1]) * f, (z[0] - x[2]) * f, (x[1] - y[0]) * f};
    case 1:
      return {(y[2] - z[1]) * f, r / 2, (x[1] + y[0]) * f, (z[0] + x[2]) * f};
    case 2:
      return {(z[0] - x[2]) * f, (x[1] + y[0]) * f, r / 2, (y[2] + z[1]) * f};
    default:
      return {(x[1] - y[0]) * f, (z[0] + x[2]) * f, (y[2] + z[1]) * f, r / 2};
  }
}

/// A bow below the window's lower edge, towards the rear. Tool z points into the surface, tool x up
/// the door.
std::string path() {
  std::string text = "x,y,z,qw,qx,qy,qz\n";
  std::array<double, 4> last{1, 0, 0, 0};
  constexpr int kSteps = 18;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = 0.45 * (2 * i - kSteps) / (2 * kSteps), z = 0.035 - 0.5 * x * x;
    const Vec normal = outward(x, z);
    const Vec position = surface(x, z) + kStandOff * normal;
    const Vec tool_z = -1.0 * normal;
    const Vec up{0, 0, 1};
    const Vec tool_x = unit(up - dot(up, tool_z) * tool_z);
    std::array<double, 4> q = quaternion(tool_x, cross(tool_z, tool_x), tool_z);
    if (q[0] * last[0] + q[1] * last[1] + q[2] * last[2] + q[3] * last[3] < 0)
      for (double& c : q) c = -c;
    last = q;
    std::array<char, 200> line;
    std::snprintf(line.data(), line.size(), "%.12f,%.12f,%.12f,%.12f,%.12f,%.12f,%.12f\n",
                  position[0], position[1], position[2], q[0], q[1], q[2], q[3]);
    text += line.data();
  }
  return text;
}

void write(const std::string& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> args(argv + 1, argv + argc);
    if (args.size() == 2 && args[0] == "--path") {
      write(args[1], path());
    } else if (args.size() == 3 && args[0] == "--triangles" && std::atoi(args[1].c_str()) > 0 &&
               std::atoi(args[1].c_str()) <= 10'000'000) {
      const Mesh mesh = panel_of(std::atoi(args[1].c_str()));
      write(args[2], stl(mesh));
      std::cout << mesh.triangles.size() << " triangles\n";
    } else {
      std::cerr << "usage: make_door --triangles N OUT.stl | make_door --path OUT.csv\n";
      return 2;
    }
  } catch (const std::exception& error) {
    std::cerr << "make_door: " << error.what() << '\n';
    return 2;
  }
}
