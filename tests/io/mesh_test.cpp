// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <cstring>

#include "io_support.hpp"

namespace swivel::io::test {
namespace {

MeshPtr load(const fs::path& file, const Vector3d& scale = Vector3d::Ones()) {
  MeshCache cache;
  return load_mesh(file, scale, cache);
}

Eigen::AlignedBox3d bounds(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  return box;
}

void expect_bounds(const TriangleMesh& mesh, const Vector3d& low, const Vector3d& high) {
  EXPECT_TRUE(bounds(mesh).min().isApprox(low, 1e-6) || (bounds(mesh).min() - low).norm() < 1e-6) << bounds(mesh).min().transpose();
  EXPECT_TRUE((bounds(mesh).max() - high).norm() < 1e-6) << bounds(mesh).max().transpose();
}

std::string binary_stl(const std::vector<std::array<float, 9>>& triangles) {
  std::string text(80, ' ');
  const auto append = [&](const void* data, std::size_t size) { text.append(static_cast<const char*>(data), size); };
  const auto count = static_cast<std::uint32_t>(triangles.size());
  append(&count, 4);
  for (const auto& triangle : triangles) {
    const std::array<float, 3> normal{};
    append(normal.data(), 12);
    append(triangle.data(), 36);
    append("\0\0", 2);
  }
  return text;
}

/// One triangle (0,0,0) (1,0,0) (0,0,2), placed by the node's matrix.
std::string dae(const std::string& up, const std::string& unit, const std::string& matrix) {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>)" +
         unit + "<up_axis>" + up + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 0 2</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><matrix>)" +
         matrix + R"(</matrix><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";
}

const char* const kIdentity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

TEST(Mesh, AsciiStlIsClosedAndTurnsOutwards) {
  const TempFolder folder;
  const fs::path file = folder.write("box.STL", box_stl());
  const MeshPtr mesh = load(file);
  EXPECT_EQ(mesh->triangles.size(), 12u);
  EXPECT_TRUE(mesh->closed);
  EXPECT_DOUBLE_EQ(volume(*mesh), 6);
  EXPECT_EQ(mesh->source, file.string());
  expect_bounds(*mesh, {0, 0, 0}, {1, 2, 3});
}

TEST(Mesh, BinaryStlIsOpen) {
  const TempFolder folder;
  const MeshPtr mesh = load(folder.write("one.stl", binary_stl({{0, 0, 0, 1, 0, 0, 0, 1, 0}})));
  EXPECT_EQ(mesh->triangles.size(), 1u);
  EXPECT_FALSE(mesh->closed);
}

TEST(Mesh, ScalePerAxis) {
  const TempFolder folder;
  const MeshPtr mesh = load(folder.write("box.stl", box_stl()), {0.001, 1, 10});
  expect_bounds(*mesh, {0, 0, 0}, {0.001, 2, 30});
}

TEST(Mesh, MirrorFlipsTheWindingBack) {
  const TempFolder folder;
  const fs::path file = folder.write("box.stl", box_stl());
  for (const Vector3d& scale : {Vector3d(1, -1, 1), Vector3d(-1, -1, -1), Vector3d(-1, -1, 1)}) {
    const MeshPtr mesh = load(file, scale);
    EXPECT_DOUBLE_EQ(volume(*mesh), 6) << scale.transpose();
    EXPECT_TRUE(mesh->closed);
  }
  expect_bounds(*load(file, {1, -1, 1}), {0, -2, 0}, {1, 0, 3});
}

TEST(Mesh, ObjQuadsBecomeTriangles) {
  const TempFolder folder;
  const MeshPtr mesh = load(folder.write("quad.obj", "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nf 1 2 3 4\n"));
  EXPECT_EQ(mesh->triangles.size(), 2u);
  expect_bounds(*mesh, {0, 0, 0}, {1, 1, 0});  // the vertex that no face uses is not there
}

TEST(Mesh, Ply) {
  const TempFolder folder;
  const MeshPtr mesh =
      load(folder.write("one.ply",
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  EXPECT_EQ(mesh->triangles.size(), 1u);
}

TEST(Mesh, DaeStaysAsStoredWhateverIsUp) {
  const TempFolder folder;
  for (const char* up : {"Z_UP", "Y_UP", "X_UP"}) {
    const MeshPtr mesh = load(folder.write(std::string(up) + ".dae", dae(up, "", kIdentity)));
    expect_bounds(*mesh, {0, 0, 0}, {1, 0, 2});
  }
}

TEST(Mesh, DaeNodeTransformsAndUnitAreApplied) {
  const TempFolder folder;
  const MeshPtr moved = load(folder.write("moved.dae", dae("Z_UP", "", "1 0 0 5 0 1 0 0 0 0 1 7 0 0 0 1")));
  expect_bounds(*moved, {5, 0, 7}, {6, 0, 9});
  const MeshPtr millimetres =
      load(folder.write("mm.dae", dae("Z_UP", "<unit name='mm' meter='0.001'/>", "1 0 0 5 0 1 0 0 0 0 1 7 0 0 0 1")));
  expect_bounds(*millimetres, {0.005, 0, 0.007}, {0.006, 0, 0.009});
}

TEST(Mesh, DaeMirroredNodeKeepsOutsideOut) {
  const TempFolder folder;
  const auto normal = [](const TriangleMesh& mesh) {
    const auto& t = mesh.triangles[0];
    const auto vertex = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    return Vector3d((vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).normalized());
  };
  const MeshPtr plain = load(folder.write("a.dae", dae("Z_UP", "", kIdentity)));
  const MeshPtr mirrored = load(folder.write("b.dae", dae("Z_UP", "", "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1")));
  EXPECT_TRUE(normal(*plain).isApprox(normal(*mirrored)));  // mirrored in x: a normal along y stays
}

TEST(Mesh, CacheSharesTheSameFileAndScale) {
  const TempFolder folder;
  const fs::path file = folder.write("box.stl", box_stl());
  MeshCache cache;
  const MeshPtr first = load_mesh(file, Vector3d::Ones(), cache);
  EXPECT_EQ(first, load_mesh(folder.path() / "." / "box.stl", Vector3d::Ones(), cache));
  EXPECT_NE(first, load_mesh(file, {1, 1, 2}, cache));
}

TEST(Mesh, BadFiles) {
  const TempFolder folder;
  const std::string whole = binary_stl({{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 0, 1, 0, 0, 0, 0, 1}});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const struct {
    const char* name;
    std::string text;
  } cases[] = {
      {"empty.stl", ""},
      {"text.stl", "hello\n"},
      {"none.stl", "solid x\nendsolid x\n"},
      {"cut.stl", whole.substr(0, whole.size() - 30)},
      {"flat.stl", binary_stl({{0, 0, 0, 1, 0, 0, 2, 0, 0}, {1, 1, 1, 1, 1, 1, 1, 1, 1}})},
      {"nan.stl", binary_stl({{0, 0, 0, nan, 0, 0, 0, 1, 0}})},
      {"points.obj", "v 0 0 0\nv 1 0 0\np 1 2\n"},
      {"index.obj", "v 0 0 0\nv 1 0 0\nf 1 2 7\n"},
      {"index.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 20\n"},
      {"broken.dae", "<COLLADA><nothing>"},
      {"mesh.xyz", "0 0 0\n"},
  };
  for (const auto& [name, text] : cases) {
    SCOPED_TRACE(name);
    const fs::path file = folder.write(name, text);
    expect_message(input_error([&] { (void)load(file); }), {file.string()});
  }
  expect_message(input_error([&] { (void)load(folder.path() / "absent.stl"); }), {"absent.stl", "no such file"});
  expect_message(input_error([&] { (void)load(folder.path()); }), {folder.path().string()});
  const fs::path good = folder.write("good.stl", whole);
  expect_message(input_error([&] { (void)load(good, {1, 0, 1}); }), {"good.stl", "scale"});
  expect_message(input_error([&] { (void)load(good, {1, nan, 1}); }), {"good.stl", "scale"});
}

}  // namespace
}  // namespace swivel::io::test
