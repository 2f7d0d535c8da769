// SPDX-License-Identifier: BSD-3-Clause
// Files as large as they may be, of one piece over and over: what takes many times its bytes in
// memory, or time by its square, shows here and nowhere else. SWIVEL_TEST_TRIALS is the size in per
// cent of what is allowed (10 unless given), and of the memory too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "seed.hpp"
#include "trial.hpp"

namespace swivel::test {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

struct Large {
  const char* format;
  std::string head, piece, tail;
  std::size_t most;  ///< bytes that its reader takes
};

std::string text_of(const Large& large, double share) {
  const auto size = static_cast<std::size_t>(share * static_cast<double>(large.most));
  std::string text = large.head;
  text.reserve(size);
  while (text.size() + large.piece.size() + large.tail.size() <= size) text += large.piece;
  return text + large.tail;
}

/// A COLLADA file whose geometry "g" has the positions "v" and then `faces`.
std::vector<std::string> dae_around_faces() {
  return {
      "<COLLADA><library_geometries><geometry id='g'><mesh><source id='p'><float_array id='a'>0 0 "
      "0 1 0 0 0 1 0</float_array>"
      "<technique_common><accessor source='#a' count='3' stride='3'/></technique_common></source>"
      "<vertices id='v'><input semantic='POSITION' source='#p'/></vertices>",
      "</mesh></geometry></library_geometries><library_visual_scenes><visual_scene "
      "id='s'><node><instance_geometry "
      "url='#g'/></node>"
      "</visual_scene></library_visual_scenes><scene><instance_visual_scene "
      "url='#s'/></scene></COLLADA>"};
}

/// The node n0 is in the scene; node k is twice in the one before it, and the last one, n16, is
/// left open.
std::string dae_of_doubling_nodes() {
  std::string text =
      "<COLLADA><library_visual_scenes><visual_scene id='s'><instance_node "
      "url='#n0'/></visual_scene></library_visual_scenes>"
      "<scene><instance_visual_scene url='#s'/></scene><library_geometries><geometry "
      "id='g'><mesh/></geometry>"
      "</library_geometries><library_nodes>";
  for (int k = 0; k < 16; ++k) {
    const std::string next = "<instance_node url='#n" + std::to_string(k + 1) + "'/>";
    text += "<node id='n" + std::to_string(k) + "'>" + next + next + "</node>";
  }
  return text + "<node id='n16'>";
}

/// Returns the large problems, robots and tool paths.
std::vector<Large> large_problems() {
  const std::string path = "x,y,z,qw,qx,qy,qz\n", row = "0,0,0,1,0,0,0\n";
  return {
      {"problem", "[", "1,", "1]", 4 * kMiB},
      {"problem", "", "a: 1\n", "", 4 * kMiB},
      {"problem", "[", "!t 1,", "1]", 4 * kMiB},
      {"urdf", "<robot name='r'>", "<a/>", "</robot>", 32 * kMiB},
      {"urdf", "<robot name='r'><link name='a'>", "<collision/>", "</link></robot>", 32 * kMiB},
      {"urdf", "<robot name='r'><link name='a'>", "<a b='' c='' d=''/>", "</link></robot>",
       32 * kMiB},
      {"srdf", "<robot name='r'>", "<group><link/>x</group>", "</robot>", 32 * kMiB},
      {"path", "", ",", "", 256 * kMiB},
      {"path", path + row, "0,0,0,1,0,0,0,", "", 256 * kMiB},
      {"path", path, "\"\"", "", 256 * kMiB},
      {"path", "", ";", "", 256 * kMiB},
      {"apt", "", "$\n", "", 256 * kMiB},
      {"apt", "", "1,$\n", "", 256 * kMiB},
      {"apt", "", "A,", "", 256 * kMiB},
      {"apt", "", "A/,\n", "", 256 * kMiB},
      {"apt", "UNITS/MM\n", "GOTO/1,2,3\n", "", 256 * kMiB},
  };
}

/// Returns the large motions.
std::vector<Large> large_motions() {
  return {
      {"motion", "", "a,", "a", 256 * kMiB},
      {"motion_json", R"({"header":[)", "{},", "1]}", 256 * kMiB},
      {"motion_json", R"({"points":[)",
       R"({"positions":[],"time_from_start":{"sec":0,"nanosec":0}},)", "1]}", 256 * kMiB},
      {"motion_json", R"({"header":{"a":")", "a", "\"}}", 256 * kMiB},
      {"motion_yaml", "header: [", "1,", "1]", 32 * kMiB},
      {"motion_yaml", "header:\n", " a: 1\n", "", 32 * kMiB},
      {"motion_yaml", "points:\n", "- {positions: [1],time_from_start: {sec: 1,nanosec: 0}}\n", "",
       32 * kMiB},
      {"mcap", "\x89MCAP0\r\n", std::string("\0\0\0\0\0\0\0\0\0", 9), "", 256 * kMiB},
      {"mcap", "\x89MCAP0\r\n", std::string("\4\x0c\0\0\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0\0\0", 21), "",
       256 * kMiB},
  };
}

/// Returns the large certificates.
std::vector<Large> large_certificates() {
  const std::string certificate = R"({"format":"swivel certificate 1","x":[)";
  return {
      {"certificate", "[", "{},", "1]", 32 * kMiB},
      {"certificate", certificate, "{\"a\":1},", "1]}", 32 * kMiB},
      {"certificate", certificate, "\"\",", "1]}", 32 * kMiB},
  };
}

/// Returns the large meshes but for those of COLLADA.
std::vector<Large> large_meshes() {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::string vertices =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  return {
      {"stl", "solid\nfacet", "a", "", 256 * kMiB},
      {"stl", "solid\nfacet n\nouter loop\nvertex 0 0 ", "1", "", 256 * kMiB},
      {"obj", corners + "f", " 1", "", 256 * kMiB},
      {"obj", corners + "f 1 2 3 ", "a", "", 256 * kMiB},
      {"obj", corners + "f", " 1 2 3\\\n", "", 256 * kMiB},
      {"ply", "ply\nformat ascii 1.0\n", "element a 0\n", "end_header\n", 256 * kMiB},
      {"ply", "ply\nformat ascii 1.0\nelement vertex 1\n", "property int a\n", "end_header\n",
       256 * kMiB},
      {"ply",
       "ply\nformat ascii 1.0\n" + vertices +
           "element face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 "
           "9999999 ",
       "1 ", "", 256 * kMiB},
      {"ply", "ply\nformat ascii 1.0\n" + vertices + "end_header\n0 0 0 ", "a", "", 256 * kMiB},
      {"ply",
       "ply\nformat binary_little_endian 1.0\n" + vertices +
           "element face 1\nproperty list uint uchar vertex_index\nend_header\n" +
           std::string(36, '\0') + std::string("\0\0\0\2", 4),
       "\1", "", 256 * kMiB},
  };
}

/// Returns the large meshes of COLLADA.
std::vector<Large> large_dae_files() {
  const std::string input = "<input semantic='VERTEX' source='#v'/>",
                    nodes_end = "</node></library_nodes></COLLADA>";
  const std::vector<std::string> dae = dae_around_faces();
  std::string zeros;
  for (int k = 0; k < 500'000; ++k) zeros += "0 ";
  return {
      {"dae", "<COLLADA>", "<p/>", "</COLLADA>", 32 * kMiB},
      {"dae", dae[0] + "<polygons>" + input + "<p>", "0 1 2 ", "</p></polygons>" + dae[1],
       32 * kMiB},
      {"dae", dae[0] + "<polylist>" + input + "<vcount>" + zeros + "</vcount>", "<p/>",
       "</polylist>" + dae[1], 8 * kMiB},
      {"dae", dae_of_doubling_nodes(), "<instance_geometry url='#g'/>", nodes_end, 32 * kMiB},
      {"dae", dae_of_doubling_nodes(), "<scale>1 1 1</scale>", nodes_end, 32 * kMiB},
      {"dae", dae_of_doubling_nodes() + "<scale>1 1", " ", "1</scale>" + nodes_end, 32 * kMiB},
  };
}

std::vector<Large> large_files() {
  std::vector<Large> all;
  for (const auto& files :
       {large_problems(), large_motions(), large_certificates(), large_meshes(), large_dae_files()})
    all.insert(all.end(), files.begin(), files.end());
  return all;
}

/// Returns the files to try: all, or at a scale of a quarter to 1 that share of them, which the
/// seed chooses, of the usual size, since a reader that refuses large files by a count may need
/// more memory for each byte of small ones. Smaller scales make the files smaller.
std::vector<Large> chosen_files() {
  std::vector<Large> files = large_files();
  const std::uint64_t first = seed("LargestFiles") % files.size();
  if (scale() < 0.25 || std::getenv("SWIVEL_TEST_TRIALS")) return files;
  std::rotate(files.begin(), files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
  const auto count = static_cast<std::size_t>(trials(static_cast<int>(files.size())));
  files.resize(std::min(files.size(), count));
  return files;
}

TEST(Fuzz, LargestFiles) {
  const TempFolder folder;
  prepare(folder);
  const std::vector<Reader> known = readers(folder);
  const std::vector<Large> files = chosen_files();
  const bool smaller = scale() < 0.25 || std::getenv("SWIVEL_TEST_TRIALS");
  const double share = (smaller ? trials(10) : 10) / 100.0;
  // The text itself is in memory too.
  constexpr std::size_t kReader = 64, kText = 256;
  const Allowance allowance{
      kAllowance.seconds, kReader + static_cast<std::size_t>(
                                        share * static_cast<double>(kAllowance.megabytes + kText))};
  int accepted = 0, refused = 0;
  // A process for each file: what the allocator keeps of one does not count as the memory of the
  // next.
  for (const Large& large : files) {
    const auto reader = std::find_if(known.begin(), known.end(), [&](const Reader& r) {
      return std::strcmp(r.name, large.format) == 0;
    });
    ASSERT_NE(reader, known.end()) << large.format;
    const Tally tally = watch(1, allowance, [&](int) { reader->read(text_of(large, share)); });
    accepted += tally.accepted;
    refused += tally.refused;
    for (const Finding& finding : tally.findings)
      ADD_FAILURE() << large.format << " of '" << large.piece << "': " << finding.what;
  }
  std::printf("%zu files of %.0f %% of what is allowed: %d read, %d refused\n", files.size(),
              100 * share, accepted, refused);
  EXPECT_GE(refused, at_least(11));
}

}  // namespace
}  // namespace swivel::test
