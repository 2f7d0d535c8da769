// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <ctime>

#include "../support/seed.hpp"
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
  EXPECT_TRUE(bounds(mesh).min().isApprox(low, 1e-6) || (bounds(mesh).min() - low).norm() < 1e-6)
      << bounds(mesh).min().transpose();
  EXPECT_TRUE((bounds(mesh).max() - high).norm() < 1e-6) << bounds(mesh).max().transpose();
}

std::string binary_stl(const std::vector<std::array<float, 9>>& triangles) {
  std::string text(80, ' ');
  const auto append = [&](const void* data, std::size_t size) {
    text.append(static_cast<const char*>(data), size);
  };
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
         unit + "<up_axis>" + up +
         R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 0 2</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>)"
         R"(<param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><matrix>)" +
         matrix +
         R"(</matrix><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
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
  const MeshPtr mesh = load(folder.write(
      "quad.obj", "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nf 1 2 3 4\n"));
  EXPECT_EQ(mesh->triangles.size(), 2u);
  expect_bounds(*mesh, {0, 0, 0}, {1, 1, 0});  // the vertex that no face uses is not there
}

TEST(Mesh, Ply) {
  const TempFolder folder;
  const MeshPtr mesh =
      load(folder.write("one.ply",
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                        "y\nproperty float z\n"
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
  const MeshPtr moved =
      load(folder.write("moved.dae", dae("Z_UP", "", "1 0 0 5 0 1 0 0 0 0 1 7 0 0 0 1")));
  expect_bounds(*moved, {5, 0, 7}, {6, 0, 9});
  const MeshPtr millimetres = load(folder.write(
      "mm.dae", dae("Z_UP", "<unit name='mm' meter='0.001'/>", "1 0 0 5 0 1 0 0 0 0 1 7 0 0 0 1")));
  expect_bounds(*millimetres, {0.005, 0, 0.007}, {0.006, 0, 0.009});
}

TEST(Mesh, DaeMirroredNodeKeepsOutsideOut) {
  const TempFolder folder;
  const auto normal = [](const TriangleMesh& mesh) {
    const auto& t = mesh.triangles[0];
    const auto vertex = [&](std::size_t k) { return mesh.vertices[t[k]]; };
    return Vector3d((vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).normalized());
  };
  const MeshPtr plain = load(folder.write("a.dae", dae("Z_UP", "", kIdentity)));
  const MeshPtr mirrored =
      load(folder.write("b.dae", dae("Z_UP", "", "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1")));
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

/// The text with the first `from` replaced.
std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// A tetrahedron as text; `drop` bytes are missing at the end.
std::string ply(std::size_t drop) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 4\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n0.1 0 0\n0 0.1 0\n0 0 0.1\n3 0 2 "
      "1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  return text.substr(0, text.size() - drop);
}

TEST(Mesh, TruncatedPlyIsBadInputWhereverItEnds) {
  const TempFolder folder;
  EXPECT_TRUE(load(folder.write("whole.ply", ply(1)))->closed);
  for (std::size_t drop = 2; drop < ply(0).size(); ++drop) {
    SCOPED_TRACE(drop);
    const fs::path file = folder.write("cut.ply", ply(drop));
    expect_message(input_error([&] { (void)load(file); }), {"cut.ply"});
  }
}

TEST(Mesh, HeadersThatPromiseTooMuchAreBadInput) {
  const TempFolder folder;
  const std::string many = with(ply(0), "vertex 4", "vertex 4000000000");
  expect_message(input_error([&] { (void)load(folder.write("many.ply", many)); }),
                 {"many.ply", "4000000000"});
  const std::string list = with(ply(0), "3 0 2 1", "2000000000 0 2 1");
  expect_message(input_error([&] { (void)load(folder.write("list.ply", list)); }), {"list.ply:14"});
  std::string stl = binary_stl({{0, 0, 0, 1, 0, 0, 0, 1, 0}});
  stl.replace(80, 4, "\xff\xff\xff\x7f");
  expect_message(input_error([&] { (void)load(folder.write("many.stl", stl)); }),
                 {"many.stl", "cut short"});
}

TEST(Mesh, WhatTakesManyTimesItsBytesIsBadInput) {
  const TempFolder folder;
  const auto message = [&](const char* name, const std::string& text) {
    return input_error([&] { (void)load(folder.write(name, text)); });
  };
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                    half(std::size_t{8} << 20, ' ');
  EXPECT_EQ(
      load(folder.write("a.obj", corners + "#" + std::string((std::size_t{16} << 20) - 2, ' ')))
          ->triangles.size(),
      1u);
  expect_message(message("a.obj", corners + "#" + half + half), {"a.obj:5", "too long", "16 MiB"});
  expect_message(message("a.obj", corners + "f" + half + "\\\n" + half),
                 {"a.obj:5", "too long", "16 MiB"});
  std::string elements = "ply\nformat ascii 1.0\n", properties = elements + "element vertex 0\n";
  for (int k = 0; k < 1'000; ++k) elements += "element a 0\n", properties += "property int a\n";
  EXPECT_EQ(message("a.ply", elements + "end_header\n").find("too many elements"),
            std::string::npos);
  expect_message(message("a.ply", elements + "element a 0\nend_header\n"),
                 {"a.ply:1003", "too many elements and properties", "1000"});
  expect_message(message("a.ply", properties + "end_header\n"),
                 {"a.ply:1003", "too many elements and properties"});
  const std::string face =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\n"
      "property list int int vertex_index\nend_header\n0 0 0 1 0 0 0 1 0 ";
  std::string ones;
  for (int k = 0; k < 2'000'003; ++k) ones += "1 ";
  expect_message(message("a.ply", face + "2000003 " + ones),
                 {"2000003 corners", "2000000 triangles"});
  EXPECT_EQ(load(folder.write("a.ply", face + "3 0 1 2 "))->triangles.size(), 1u);
}

TEST(Mesh, DaeWithABrokenIndexIsBadInput) {
  const TempFolder folder;
  const std::string good = dae("Z_UP", "", kIdentity);
  for (const char* p : {"0 1 3", "0 1 400000000", "0 1 -1", "0 1", "0 1 2 0", "0 1 x"}) {
    SCOPED_TRACE(p);
    const std::string text = with(good, "<p>0 1 2", std::string("<p>") + p);
    expect_message(input_error([&] { (void)load(folder.write("index.dae", text)); }),
                   {"index.dae:9"});
  }
  const struct {
    const char *from, *to;
  } changes[] = {{"count=\"3\" stride", "count=\"4000000000\" stride"},
                 {"stride=\"3\"", "stride=\"0\""},
                 {"<triangles count=\"1\"", "<triangles count=\"2000000000\""},
                 {"offset=\"0\"", "offset=\"4000000000\""},
                 {"0 0 0 1 0 0 0 0 2", "0 0 0 1 0 0 0 0"},
                 {"source=\"#p\"", "source=\"#absent\""},
                 {"source=\"#pa\"", "source=\"#p\""},
                 {"url=\"#g\"", "url=\"#s\""},
                 {"<instance_visual_scene url=\"#s\"", "<instance_visual_scene url=\"#n\""},
                 {"<instance_geometry url=\"#g\"/>", "<instance_node url=\"#n\"/>"}};
  for (const auto& [from, to] : changes) {
    SCOPED_TRACE(to);
    expect_message(
        input_error([&] { (void)load(folder.write("broken.dae", with(good, from, to))); }),
        {"broken.dae:"});
  }
}

TEST(Mesh, DaeInstancesOfInstancesAreBounded) {
  const TempFolder folder;
  std::string nodes;
  for (int k = 0; k < 40; ++k) {
    const std::string next = "<instance_node url='#n" + std::to_string(k + 1) + "'/>";
    nodes += "<node id='n" + std::to_string(k) + "'>" + (k < 39 ? next + next : "") + "</node>";
  }
  std::string text = with(dae("Z_UP", "", kIdentity), "<instance_geometry url=\"#g\"/>",
                          "<instance_node url='#n0'/>");
  text = with(text, "<library_visual_scenes>",
              "<library_nodes>" + nodes + "</library_nodes><library_visual_scenes>");
  expect_message(input_error([&] { (void)load(folder.write("doubling.dae", text)); }),
                 {"too many parts"});
}

/// Nodes that are there 65,536 times, with `inside` each.
std::string doubling_dae(const std::string& inside) {
  std::string nodes;
  for (int k = 0; k < 16; ++k) {
    const std::string next = "<instance_node url='#n" + std::to_string(k + 1) + "'/>";
    nodes += "<node id='n" + std::to_string(k) + "'>" + next + next + "</node>";
  }
  const std::string text = with(dae("Z_UP", "", kIdentity), "<instance_geometry url=\"#g\"/>",
                                "<instance_node url='#n0'/>");
  return with(text, "<library_visual_scenes>",
              "<library_nodes>" + nodes + "<node id='n16'>" + inside +
                  "</node></library_nodes><library_visual_scenes>");
}

// Each once took minutes.
TEST(Mesh, DaeThatRepeatsItselfIsReadSoon) {
  const TempFolder folder;
  const std::clock_t begin = std::clock();
  const auto message = [&](const std::string& text) {
    return input_error([&] { (void)load(folder.write("a.dae", text)); });
  };
  std::string instances, scales;
  for (int k = 0; k < 3'000; ++k)
    instances += "<instance_geometry url='#none'/>", scales += "<scale>1 1 1</scale>";
  const std::string nothing = "<library_geometries><geometry id=\"none\"/>";
  expect_message(message(with(doubling_dae(instances), "<library_geometries>", nothing)),
                 {"too many parts"});
  expect_message(message(doubling_dae(scales)), {"too many parts"});
  const std::string blank(1 << 20, ' ');
  EXPECT_EQ(load(folder.write("a.dae", doubling_dae("<scale>1 1" + blank +
                                                    "1</scale><instance_geometry url='#g'/>")))
                ->triangles.size(),
            65'536u);
  std::string sources, numbers;
  for (int k = 0; k < 300'000; ++k) numbers += "1 ";
  for (int k = 0; k < 2'000; ++k) {
    const std::string n = std::to_string(k);
    sources += "<source id='p" + n +
               "'><technique_common><accessor source='#many' count='1' "
               "stride='3'/></technique_common></source><vertices id='v" +
               n + "'><input semantic='POSITION' source='#p" + n +
               "'/></vertices><triangles><input semantic='VERTEX' source='#v" + n +
               "'/><p>0 0 0</p></triangles>";
  }
  const std::string text =
      with(dae("Z_UP", "", kIdentity), "<mesh>",
           "<mesh><source><float_array id='many'>" + numbers + "</float_array></source>");
  EXPECT_EQ(
      load(folder.write("a.dae", with(text, "</mesh>", sources + "</mesh>")))->triangles.size(),
      2'001u);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 20);
}

/// Geometry as `faces` over the corners of a unit square in z = 0, counted round.
std::string square_dae(const std::string& faces) {
  std::string text = with(dae("Z_UP", "", kIdentity), "count=\"9\">0 0 0 1 0 0 0 0 2",
                          "count=\"12\">0 0 0 1 0 0 1 1 0 0 1 0");
  text = with(text, "count=\"3\" stride", "count=\"4\" stride");
  const auto begin = text.find("<triangles"), end = text.find("</triangles>") + 12;
  return text.replace(begin, end - begin, faces);
}

TEST(Mesh, DaePolylistHasOneListOfCorners) {
  const TempFolder folder;
  const std::string faces =
      "<polylist count='1'><input semantic='VERTEX' source='#v' offset='0'/><vcount>3</vcount><p>0 "
      "1 2</p>";
  EXPECT_EQ(load(folder.write("a.dae", square_dae(faces + "</polylist>")))->triangles.size(), 1u);
  expect_message(input_error([&] {
                   (void)load(folder.write("a.dae", square_dae(faces + "<p>1 2 3</p></polylist>")));
                 }),
                 {"several <p>", "one"});
}

TEST(Mesh, DaeFacesOfEveryKind) {
  const TempFolder folder;
  const std::string vertex =
      "<input semantic='VERTEX' source='#v' offset='1'/><input semantic='NORMAL' source='#p' "
      "offset='0'/>";
  const struct {
    const char* name;
    std::string faces;
  } cases[] = {
      {"polylist", "<polylist count='2'>" + vertex +
                       "<vcount>3 3</vcount><p>0 0 0 1 0 2 0 0 0 2 0 3</p></polylist>"},
      {"polygons", "<polygons count='1'>" + vertex + "<p>0 0 0 1 0 2 0 3</p></polygons>"},
      {"trifans", "<trifans count='1'>" + vertex + "<p>0 0 0 1 0 2 0 3</p></trifans>"},
      {"tristrips", "<tristrips count='1'>" + vertex + "<p>0 0 0 1 0 3 0 2</p></tristrips>"},
      {"triangles", "<triangles>" + vertex + "<p>0 0 0 1 0 2 0 0 0 2 0 3</p></triangles>"},
  };
  for (const auto& [name, faces] : cases) {
    SCOPED_TRACE(name);
    const MeshPtr mesh = load(folder.write(std::string(name) + ".dae", square_dae(faces)));
    ASSERT_EQ(mesh->triangles.size(), 2u);
    for (const auto& t : mesh->triangles) {  // each half of the square, facing up
      const auto vertex_at = [&](std::size_t k) { return mesh->vertices[t[k]]; };
      EXPECT_EQ((vertex_at(1) - vertex_at(0)).cross(vertex_at(2) - vertex_at(0)),
                Vector3d(0, 0, 1));
    }
  }
}

TEST(Mesh, BinaryPlyOfBothByteOrders) {
  const TempFolder folder;
  for (const bool big : {false, true}) {
    std::string text = "ply\nformat binary_" + std::string(big ? "big" : "little") +
                       "_endian 1.0\ncomment red\nelement vertex 3\nproperty double x\nproperty "
                       "float y\nproperty short z\nproperty uchar red\n"
                       "element face 1\nproperty list uchar uint vertex_index\nproperty list "
                       "ushort float weights\nend_header\n";
    const auto put = [&](const auto& value) {
      std::string bytes(sizeof value, '\0');
      std::memcpy(bytes.data(), &value, sizeof value);
      if (big) std::reverse(bytes.begin(), bytes.end());
      text += bytes;
    };
    for (int k = 0; k < 3; ++k) {
      put(k == 1 ? 2.0 : 0.0);
      put(k == 2 ? 3.0f : 0.0f);
      put(static_cast<std::int16_t>(-k));
      put(static_cast<std::uint8_t>(10));  // a line break among the data
    }
    put(static_cast<std::uint8_t>(3));
    for (std::uint32_t k = 0; k < 3; ++k) put(k);
    put(static_cast<std::uint16_t>(1));
    put(1.0f);
    const MeshPtr mesh = load(folder.write("binary.ply", text));
    ASSERT_EQ(mesh->triangles.size(), 1u);
    expect_bounds(*mesh, {0, 0, -2}, {2, 3, 0});
    for (std::size_t drop = 1; drop < 30; ++drop)
      expect_message(input_error([&] {
                       (void)load(folder.write("cut.ply", text.substr(0, text.size() - drop)));
                     }),
                     {"cut short"});
  }
}

/// Polygons that are not convex, in any plane and order: the triangles' areas have one sign and add
/// up to the polygon's.
TEST(Mesh, PolygonsAreCutIntoTrianglesInsideThem) {
  swivel::test::Random random(swivel::test::seed("PolygonsAreCutIntoTrianglesInsideThem"));
  const TempFolder folder;
  int concave = 0;
  for (int trial = 0; trial < swivel::test::trials(200); ++trial) {
    const int n = 4 + random.below(20);
    const Matrix3d turn = Quaterniond(random.uniform(-1, 1), random.uniform(-1, 1),
                                      random.uniform(-1, 1), random.uniform(-1, 1))
                              .normalized()
                              .toRotationMatrix();
    std::vector<Vector3d> points;
    std::string text, face = "f";
    for (int k = 0; k < n; ++k) {  // a star about the origin: simple
      const double angle = kTwoPi * k / n, radius = random.uniform(0.2, 1);
      points.push_back(turn * Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0));
      std::ostringstream line;
      line << "v " << points.back().x() << ' ' << points.back().y() << ' ' << points.back().z()
           << '\n';
      text += line.str();
      face += ' ' + std::to_string(k - n);
    }
    const Vector3d up = turn.col(2);
    double area = 0;
    bool bent = false;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vector3d &a = points[k], &b = points[(k + 1) % points.size()],
                     &c = points[(k + 2) % points.size()];
      area += a.cross(b).dot(up);
      bent = bent || (b - a).cross(c - b).dot(up) < 0;
    }
    concave += bent;
    const MeshPtr mesh = load(folder.write("polygon.obj", text + face + '\n'));
    ASSERT_EQ(mesh->triangles.size(), points.size() - 2);
    double sum = 0;
    for (const auto& t : mesh->triangles) {
      const auto vertex = [&](std::size_t k) { return mesh->vertices[t[k]]; };
      const double part = (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).dot(up);
      EXPECT_GT(part, -1e-6);
      sum += part;
    }
    EXPECT_NEAR(sum, area, 1e-4);
  }
  EXPECT_GE(concave, swivel::test::at_least(101));
}

TEST(Mesh, FarVerticesAreBadInput) {
  const TempFolder folder;
  const fs::path file = folder.write("box.stl", box_stl());
  EXPECT_TRUE(load(file, {300, 300, 300})->closed);
  expect_message(input_error([&] {
                   (void)load(file, {1, 1, 400});
                 }),
                 {"box.stl", "1200 m", "1000 m"});
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
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
       "float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 "
       "0 1 20\n"},
      {"broken.dae", "<COLLADA><nothing>"},
      {"mesh.xyz", "0 0 0\n"},
  };
  for (const auto& [name, text] : cases) {
    SCOPED_TRACE(name);
    const fs::path file = folder.write(name, text);
    expect_message(input_error([&] { (void)load(file); }), {file.string()});
  }
  expect_message(input_error([&] { (void)load(folder.path() / "absent.stl"); }),
                 {"absent.stl", "no such file"});
  expect_message(input_error([&] { (void)load(folder.path()); }), {folder.path().string()});
  const fs::path good = folder.write("good.stl", whole);
  expect_message(input_error([&] { (void)load(good, {1, 0, 1}); }), {"good.stl", "scale"});
  expect_message(input_error([&] { (void)load(good, {1, nan, 1}); }), {"good.stl", "scale"});
}

}  // namespace
}  // namespace swivel::io::test
