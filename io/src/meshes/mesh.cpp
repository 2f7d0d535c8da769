// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "meshes/mesh_file.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/io/meshes/mesh.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

/// Appends a placed surface to a mesh, without the vertices that no triangle uses.
void append(const Surface& surface, const Eigen::Affine3d& placed, TriangleMesh& mesh,
            const MeshFile& file) {
  if (mesh.triangles.size() + surface.triangles().size() > kMostTriangles)
    file.fail(0, "too many triangles", "at most " + std::to_string(kMostTriangles));
  const bool mirrored = placed.linear().determinant() < 0;
  std::vector<int> index(surface.points().size(), -1);
  for (std::array<int, 3> triangle : surface.triangles()) {
    for (int& corner : triangle) {
      int& known = index[corner];
      if (known < 0) {
        known = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(placed * surface.points()[corner]);
        const Vector3d& vertex = mesh.vertices.back();
        if (!(vertex.array().abs() <= kMostMetres).all())
          file.fail(
              0,
              "a vertex lies " + format_double(vertex.norm()) + " m from the origin, scale applied",
              "vertices within 1000 m");
      }
      corner = known;
    }
    if (mirrored) std::swap(triangle[1], triangle[2]);
    mesh.triangles.push_back(triangle);
  }
}

bool has_area(const TriangleMesh& mesh) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& triangle) {
    const auto vertex = [&](int k) -> const Vector3d& { return mesh.vertices[triangle[k]]; };
    return (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).squaredNorm() > 0;
  });
}

using Reader = void (*)(const MeshFile&, const PlaceSurface&);

/// Returns the reader for a file name's ending; null if it is unknown.
Reader reader_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".stl") return read_stl;
  if (extension == ".obj") return read_obj;
  if (extension == ".dae") return read_dae;
  if (extension == ".ply") return read_ply;
  return nullptr;
}

MeshPtr read_mesh(const fs::path& path, Reader read, const Vector3d& scale) {
  const MeshFile file{path.string(), read_file(path, "mesh file",
                                               read == read_dae ? kMostXmlBytes : kMostMeshBytes)};
  const auto mesh = std::make_shared<TriangleMesh>();
  mesh->source = file.name, mesh->scale = scale;
  std::size_t work = 0;
  read(file, [&](const Surface& surface, const Eigen::Affine3d& pose) {
    // A surface that is placed often costs time even if it adds little.
    if ((work += surface.points().size()) > 10 * kMostTriangles)
      file.fail(0, "too many vertices", "fewer parts");
    append(surface, Eigen::Scaling(scale) * pose, *mesh, file);
  });
  const char* const allowed = "a mesh with at least one triangle of positive area";
  if (mesh->triangles.empty()) file.fail(0, "has no triangles", allowed);
  if (!has_area(*mesh)) file.fail(0, "every triangle has zero area", allowed);
  mesh->closed = is_closed(*mesh);
  return mesh;
}

}  // namespace

MeshPtr load_mesh(const fs::path& file, const Vector3d& scale, MeshCache& cache) {
  const std::string where = file.string();
  if (!scale.allFinite() || (scale.array() == 0).any())
    bad_input(where, "mesh scale is zero or not finite", "finite numbers other than 0");
  std::error_code error;
  if (!fs::is_regular_file(file, error))
    bad_input(where, "no such file", "an existing STL, OBJ, DAE or PLY file");
  const Reader read = reader_of(file);
  if (read == nullptr)
    bad_input(where, "unknown mesh format '" + file.extension().string() + "'",
              "an STL, OBJ, DAE or PLY file");
  std::string key = fs::weakly_canonical(file, error).string();
  for (const double factor : scale) key += '|' + format_double(factor);
  MeshPtr& mesh = cache[key];
  if (!mesh) mesh = read_mesh(file, read, scale);
  return mesh;
}

}  // namespace swivel::io
