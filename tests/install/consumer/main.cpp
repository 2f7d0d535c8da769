// SPDX-License-Identifier: BSD-3-Clause
#include <swivel/core/shape.hpp>

int main() {
  swivel::TriangleMesh tetrahedron;
  tetrahedron.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return swivel::is_closed(tetrahedron) ? 0 : 1;
}
