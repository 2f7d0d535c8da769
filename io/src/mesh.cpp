// SPDX-License-Identifier: BSD-3-Clause
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <string>

#include "bad_input.hpp"
#include "files.hpp"
#include "swivel/io/io.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

using Affine = Eigen::Affine3d;

Affine to_affine(const aiMatrix4x4& m) {
  Affine result = Affine::Identity();
  result.matrix().topRows<3>() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4;
  return result;
}

/// Appends the triangles of one mesh; vertices that no triangle uses are left out, since they bound nothing.
void append(const aiMesh& source, const Affine& placed, TriangleMesh& mesh, const std::string& where) {
  const bool mirrored = placed.linear().determinant() < 0;
  std::vector<int> index(source.mNumVertices, -1);
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines
    std::array<int, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const unsigned v = face.mIndices[k];
      if (v >= source.mNumVertices)
        bad_input(where, "a triangle names vertex " + std::to_string(v), "an index below the number of vertices");
      if (index[v] < 0) {
        const Vector3d stored(source.mVertices[v].x, source.mVertices[v].y, source.mVertices[v].z);
        const Vector3d vertex = placed * stored;
        if (!vertex.allFinite()) bad_input(where, "a vertex is not finite", "finite coordinates");
        index[v] = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(vertex);
      }
      triangle[k] = index[v];
    }
    if (mirrored) std::swap(triangle[1], triangle[2]);
    mesh.triangles.push_back(triangle);
  }
}

void append(const aiScene& scene, const aiNode& node, const Affine& parent, TriangleMesh& mesh, const std::string& where) {
  const Affine placed = parent * to_affine(node.mTransformation);
  for (unsigned m = 0; m < node.mNumMeshes; ++m) append(*scene.mMeshes[node.mMeshes[m]], placed, mesh, where);
  for (unsigned c = 0; c < node.mNumChildren; ++c) append(scene, *node.mChildren[c], placed, mesh, where);
}

bool has_area(const TriangleMesh& mesh) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& triangle) {
    const auto vertex = [&](int k) -> const Vector3d& {
      return mesh.vertices[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
    };
    return (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).squaredNorm() > 0;
  });
}

bool known_format(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".stl" || extension == ".obj" || extension == ".dae" || extension == ".ply";
}

MeshPtr read_mesh(const fs::path& file, const Vector3d& scale) {
  const std::string where = file.string();
  Assimp::Importer importer;
  // Vertices as stored, whatever the file calls "up": that is how ROS tools read them, and URDFs are written for it.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* const scene = importer.ReadFile(where, aiProcess_ValidateDataStructure | aiProcess_Triangulate);
  const char* const allowed = "a mesh with at least one triangle of positive area";
  if (scene == nullptr || scene->mRootNode == nullptr) {
    const std::string reason = importer.GetErrorString();
    bad_input(where, "cannot be read as a mesh" + (reason.empty() ? reason : " (" + reason + ")"), allowed);
  }
  const auto mesh = std::make_shared<TriangleMesh>();
  mesh->source = where;
  append(*scene, *scene->mRootNode, Affine(Eigen::Scaling(scale)), *mesh, where);
  if (mesh->triangles.empty()) bad_input(where, "has no triangles", allowed);
  if (!has_area(*mesh)) bad_input(where, "every triangle has zero area", allowed);
  mesh->closed = is_closed(*mesh);
  return mesh;
}

}  // namespace

MeshPtr load_mesh(const fs::path& file, const Vector3d& scale, MeshCache& cache) {
  const std::string where = file.string();
  if (!scale.allFinite() || (scale.array() == 0).any())
    bad_input(where, "mesh scale is zero or not finite", "finite numbers other than 0");
  std::error_code error;
  if (!fs::is_regular_file(file, error)) bad_input(where, "no such file", "an existing STL, OBJ, DAE or PLY file");
  if (!known_format(file))
    bad_input(where, "unknown mesh format '" + file.extension().string() + "'", "an STL, OBJ, DAE or PLY file");
  std::string key = fs::weakly_canonical(file, error).string();
  for (const double factor : scale) key += '|' + format_double(factor);
  MeshPtr& mesh = cache[key];
  if (!mesh) mesh = read_mesh(file, scale);
  return mesh;
}

}  // namespace swivel::io
