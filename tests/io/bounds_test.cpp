// SPDX-License-Identifier: BSD-3-Clause
// What files may hold: sizes, numbers, names. Each case once took minutes or gigabytes, or came
// through to pictures and terminals.
#include <sys/stat.h>

#include <ctime>
#include <thread>

#include "problem_support.hpp"
#include "swivel/core/messages/bounds.hpp"

namespace swivel::io::test {
namespace {

/// Seconds of the processor that the call takes, whatever else the machine does.
template <class Call>
double seconds(const Call& call) {
  const std::clock_t begin = std::clock();
  call();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

/// Readers are not asked to be fast under sanitizers and debuggers, only not to be quadratic.
constexpr double kSoon = 5;

TEST(Bounds, DevicesAreNotRead) {
  const ProblemFolder folder;
  expect_message(input_error([] { (void)load_path_problem("/dev/zero"); }),
                 {"/dev/zero", "device"});
  expect_message(input_error([] { (void)load_robot("/dev/zero"); }), {"/dev/zero", "device"});
  expect_message(input_error([] { (void)load_path("/dev/zero"); }), {"/dev/zero", "device"});
  expect_message(input_error([&] {
                   (void)load_path_problem(folder.write({{"path", "{file: /dev/zero}"}}));
                 }),
                 {"path.file", "device"});
}

TEST(Bounds, APipeIsRead) {
  const TempFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer(
      [&] { std::ofstream(pipe) << "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n1,0,0,1,0,0,0\n"; });
  EXPECT_EQ(load_path(pipe).size(), 2u);
  writer.join();
}

TEST(Bounds, FilesAreOfBoundedSize) {
  const TempFolder folder;
  const auto large = [&](const char* name, std::uintmax_t mebibytes) {
    const fs::path file = folder.write(name, "");
    fs::resize_file(file, mebibytes << 20);
    return file;
  };
  expect_message(input_error([&] { (void)load_path_problem(large("a.yaml", 5)); }),
                 {"a.yaml", "too large", "4 MiB"});
  expect_message(input_error([&] { (void)load_robot(large("a.urdf", 33)); }),
                 {"a.urdf", "too large", "32 MiB"});
  expect_message(input_error([&] { (void)load_path(large("a.csv", 257)); }),
                 {"a.csv", "too large", "256 MiB"});
  MeshCache cache;
  expect_message(
      input_error([&] { (void)load_mesh(large("a.stl", 257), Vector3d::Ones(), cache); }),
      {"a.stl", "too large"});
  expect_message(input_error([&] { (void)load_mesh(large("a.dae", 33), Vector3d::Ones(), cache); }),
                 {"a.dae", "too large"});
}

TEST(Bounds, AMillionWaypoints) {
  const TempFolder folder;
  std::string text = "x,y,z,qw,qx,qy,qz\n";
  for (int k = 0; k < 1'000'000; ++k) text += "0,0,0,1,0,0,0\n";
  EXPECT_EQ(load_path(folder.write("a.csv", text)).size(), 1'000'000u);
  text += "0,0,0,1,0,0,0\n";
  expect_message(input_error([&] { (void)load_path(folder.write("a.csv", text)); }),
                 {"a.csv:1000002", "too many data rows"});
}

TEST(Bounds, ManyKeysAreReadSoon) {
  const ProblemFolder folder;
  std::string hold;
  for (int k = 0; k < 50'000; ++k) hold += "  k" + std::to_string(k) + ": 0\n";
  const fs::path file = folder.folder().write("problems/problem.yaml", hold);
  EXPECT_LT(seconds([&] {
              expect_message(input_error([&] { (void)load_path_problem(file); }), {"unknown key"});
            }),
            kSoon);
}

TEST(Bounds, LongChainsOfLinksAreReadSoon) {
  const TempFolder folder;
  const auto chain = [](int links) {
    std::string text = "<robot name='r'><link name='l0'/>\n";
    for (int k = 1; k < links; ++k) {
      const std::string n = std::to_string(k), before = std::to_string(k - 1);
      text += "<link name='l" + n + "'/><joint name='j" + n + "' type='fixed'><parent link='l" +
              before + "'/><child link='l" + n + "'/></joint>\n";
    }
    return text + "</robot>\n";
  };
  EXPECT_LT(seconds([&] {
              EXPECT_EQ(load_robot(folder.write("chain.urdf", chain(10'000)))->links.size(),
                        10'000u);
            }),
            kSoon);
  expect_message(input_error([&] { (void)load_robot(folder.write("long.urdf", chain(10'002))); }),
                 {"long.urdf:", "10000"});
}

TEST(Bounds, AliasesDoNotMultiply) {
  const ProblemFolder folder;
  std::string allow, scene;
  for (int k = 0; k < 3'000; ++k) allow += std::string(k == 0 ? "" : ", ") + "link_7";
  for (int k = 0; k < 3'000; ++k)
    scene += "  - {name: o" + std::to_string(k) + ", sphere: 0.1, allow: *a}\n";
  const fs::path file = folder.write(
      {{"scene", "\n  - {name: o, sphere: 0.1, allow: &a [" + allow + "]}\n" + scene}});
  expect_message(input_error([&] { (void)load_path_problem(file); }),
                 {"problem.yaml:", "too many values"});
}

TEST(Bounds, MessagesEnd) {
  const ProblemFolder folder;
  const std::string key(60'000, 'k'), name = "box" + std::string(60'000, '-') + ".stl";
  for (const std::string& message :
       {input_error([&] {
          (void)load_path_problem(folder.write({{"path", "{" + key + ": 1}"}}));
        }),
        input_error([&] {
          (void)load_path_problem(folder.write({{key, "1"}}));
        }),
        input_error([&] {
          (void)load_path_problem(folder.write({{"scene", "[{name: rail, mesh: " + name + "}]"}}));
        })}) {
    EXPECT_LE(message.size(), 4000u);
    expect_message(message, {".yaml", "allowed"});
  }
}

TEST(Bounds, MisplacedCharactersOfYamlEnd) {
  const TempFolder folder;
  for (const char* const text :
       {",", ",<", ", tool_angle", "]", "}", "a: 1\n, b", "a: 1\n--- \n,"}) {
    const std::string message =
        input_error([&] { (void)load_path_problem(folder.write("p.yaml", text)); });
    expect_message(message, {"p.yaml", "allowed"});
  }
  const ProblemFolder problems;
  for (const char* const more : {"\n, b", "\n]", "\n---\n", "\n--- ~\n---\nscene: []\n"}) {
    const fs::path file = problems.write({});
    EXPECT_FALSE(load_path_problem(file).waypoints.empty());
    std::ofstream(file, std::ios::app) << more;
    expect_message(input_error([&] { (void)load_path_problem(file); }), {"problem.yaml"});
  }
}

TEST(Bounds, LinesOfTablesEnd) {
  const TempFolder folder;
  const std::string commas(std::size_t{1} << 20, ',');
  const std::string head = "x,y,z,qw,qx,qy,qz\n";
  expect_message(input_error([&] { (void)load_path(folder.write("a.csv", commas + ",\n")); }),
                 {"a.csv:1", "1048577 bytes", "1 MiB"});
  expect_message(
      input_error([&] { (void)load_path(folder.write("a.csv", head + commas + ",\n")); }),
      {"a.csv:2", "1 MiB"});
  expect_message(input_error([&] { (void)load_path(folder.write("a.csv", head + commas)); }),
                 {"a.csv:2", "1048577 columns"});
}

TEST(Bounds, CertificatesOfManyObjectsAreReadSoon) {
  const TempFolder folder;
  const auto message = [&](const std::string& text) {
    return input_error([&] { (void)load_certificate(folder.write("a.json", text)); });
  };
  const std::string head = R"({"format":"swivel certificate 1","x":[0)";
  std::string objects = head, keys = head + "]";
  for (int k = 0; k < 500'000; ++k) objects += ",{}";
  for (int k = 0; k < 200'000; ++k) keys += ",\"k" + std::to_string(k) + "\":0";
  EXPECT_LT(seconds([&] {
              expect_message(message(objects + "]}"), {"is unknown", "allowed"});
            }),
            kSoon);
  EXPECT_LT(seconds([&] {
              expect_message(message(keys + "}"), {"is unknown", "allowed"});
            }),
            kSoon);
  // Brackets in texts are none.
  expect_message(message(R"({"format":"swivel certificate 1","a\"[[[[[[[[[\\":"[{[{[{[{[{"})"),
                 {"is unknown", "allowed"});
  expect_message(message(R"({"format":"swivel certificate 1","x":[[[[[[[[0]]]]]]]]})"),
                 {"nested too deep", "8 levels"});
}

TEST(Bounds, TagsEnd) {
  const TempFolder folder;
  std::string tags;
  for (int k = 0; k < 1'999'998; ++k) tags += "<a/>";
  const std::string robot = "<robot name='r'><link name='l'/>", dae = "<COLLADA>";
  const auto urdf = folder.write("few.urdf", robot + "</robot>");
  EXPECT_EQ(load_robot(urdf, folder.write("a.srdf", "<robot name='r'>" + tags + "</robot>"))
                ->disabled_pairs.size(),
            0u);
  expect_message(input_error([&] {
                   (void)load_robot(
                       urdf, folder.write("a.srdf", "<robot name='r'>" + tags + "<a/></robot>"));
                 }),
                 {"a.srdf", "too many tags", "2000000"});
  expect_message(
      input_error([&] { (void)load_robot(folder.write("a.urdf", robot + tags + "</robot>")); }),
      {"a.urdf", "too many tags"});
  MeshCache cache;
  const fs::path mesh = folder.write("a.dae", dae + tags + "<a/></COLLADA>");
  expect_message(input_error([&] { (void)load_mesh(mesh, Vector3d::Ones(), cache); }),
                 {"a.dae", "too many tags"});
}

TEST(Bounds, PairsAndShapesOfARobotEnd) {
  const TempFolder folder;
  std::string pairs = "<robot name='r'>", balls = "<robot name='r'><link name='l'>";
  for (int k = 0; k < 150'000; ++k)
    pairs += "<disable_default_collisions link='x" + std::to_string(k) + "'/>";
  const fs::path arm = folder.write("arm.urdf", arm_urdf());  // of nine links
  expect_message(
      input_error([&] { (void)load_robot(arm, folder.write("a.srdf", pairs + "</robot>")); }),
      {"a.srdf:1", "too many pairs", "1000000"});
  for (int k = 0; k < 10'000; ++k)
    balls += "<collision><geometry><sphere radius='1'/></geometry></collision>";
  EXPECT_EQ(
      load_robot(folder.write("a.urdf", balls + "</link></robot>"))->links[0].collision.size(),
      10'000u);
  const std::string more =
      "</link><link name='m'><collision><geometry><sphere "
      "radius='1'/></geometry></collision></link>"
      "<joint name='j' type='fixed'><parent link='l'/><child link='m'/></joint></robot>";
  expect_message(input_error([&] { (void)load_robot(folder.write("a.urdf", balls + more)); }),
                 {"link 'm'", "too many", "10000"});
}

/// What looks like a format of printf is text, in messages too.
TEST(Bounds, TextOfARobotIsNoFormat) {
  const TempFolder folder;
  const std::string wrong =
      "<robot name='r'><link name='a'><collision><geometry><sphere "
      "radius='0%.0300000000E%n'/></geometry></collision></link></robot>";
  expect_message(input_error([&] { (void)load_robot(folder.write("wrong.urdf", wrong)); }),
                 {"wrong.urdf", "0%.0300000000E%n"});
  const auto named = load_robot(folder.write(
      "named.urdf",
      "<robot name='100%s'><link name='%n'/><link name='50% b'/><joint name='%s' type='fixed'>"
      "<parent link='%n'/><child link='50% b'/></joint></robot>"));
  EXPECT_EQ(named->links[1].name, "50% b");
  EXPECT_EQ(named->joints[0].name, "%s");
}

/// What stands around the robot, or between its elements, is not read again as something else.
TEST(Bounds, AWholeRobotInADeclarationIsNone) {
  const TempFolder folder;
  const std::string text =
      "<?&t its ends. -->\n<robot name='r'><link name='a'/></robot>\n?><robot name='s'>text<link "
      "name='b'/></robot>\n";
  EXPECT_EQ(load_robot(folder.write("around.urdf", text))->links.at(0).name, "b");
}

TEST(Bounds, DeeplyNestedFiles) {
  const ProblemFolder folder;
  const auto nested = [](const std::string& open, int depth) {
    std::string text;
    for (int k = 0; k < depth; ++k) text += open;
    return text;
  };
  for (const char* open : {"[", "{a: ", "- ", "? ", "[{a: ", "*a [", "!t [", "&a ["})
    for (const int depth : {400, 600, 5'000, 200'000}) {
      SCOPED_TRACE(open + std::to_string(depth));
      const fs::path file = folder.folder().write("problems/problem.yaml", nested(open, depth));
      expect_message(input_error([&] { (void)load_path_problem(file); }), {"problem.yaml"});
    }
  for (const char* open : {"<a>", "<node>", "<robot name='r'>"})
    for (const int depth : {400, 600, 5'000, 200'000}) {
      SCOPED_TRACE(open + std::to_string(depth));
      const std::string text = nested(open, depth);
      expect_message(input_error([&] { (void)load_robot(folder.folder().write("a.urdf", text)); }),
                     {"a.urdf"});
      MeshCache cache;
      const fs::path dae = folder.folder().write("a.dae", "<COLLADA>" + text);
      expect_message(input_error([&] { (void)load_mesh(dae, Vector3d::Ones(), cache); }),
                     {"a.dae"});
    }
}

TEST(Bounds, SizesAndCoordinatesEnd) {
  const ProblemFolder folder;
  const auto message = [&](const char* section, const std::string& text) {
    return input_error([&] { (void)folder.load({{section, text}}); });
  };
  expect_message(message("scene", "[{name: a, sphere: 1000.1}]"), {"scene[0].sphere", "1000"});
  expect_message(message("scene", "[{name: a, box: [1, 1e9, 1]}]"), {"scene[0].box[1]", "1000"});
  expect_message(message("scene", "[{name: a, cylinder: {radius: 1, length: 1e9}}]"),
                 {"scene[0].cylinder.length", "1000"});
  expect_message(message("scene", "[{name: a, sphere: 1, xyz: [0, 0, -1e9]}]"),
                 {"scene[0].xyz[2]", "1000"});
  expect_message(message("path", "{waypoints: [{xyz: [0, 0, 0]}, {xyz: [2000, 0, 0]}]}"),
                 {"path.waypoints[1].xyz[0]", "1000"});
  expect_message(message("limits", "{clearance: 1e9}"), {"limits.clearance", "1000"});
  EXPECT_EQ(folder.load({{"scene", "[{name: a, sphere: 1000, xyz: [0, 0, -1000]}]"}}).scene.size(),
            1u);
  const std::string csv = "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n1e9,0,0,1,0,0,0\n";
  expect_message(input_error([&] { (void)load_path(folder.folder().write("far.csv", csv)); }),
                 {"far.csv:3", "x,y,z", "1000"});
  const auto robot = [&](const std::string& link, const std::string& joint) {
    const std::string text =
        "<robot name='r'><link name='a'>" + link +
        "</link>\n<link name='b'/><joint name='j' type='fixed'><parent link='a'/>" +
        "<child link='b'/>" + joint + "</joint></robot>";
    return input_error([&] { (void)load_robot(folder.folder().write("far.urdf", text)); });
  };
  const std::string ball = "<collision><geometry><sphere radius='";
  expect_message(robot(ball + "1e9'/></geometry></collision>", ""),
                 {"far.urdf:1: link 'a'", "1000"});
  expect_message(
      robot(
          "<collision><origin xyz='0 1e9 0'/><geometry><sphere radius='1'/></geometry></collision>",
          ""),
      {"far.urdf:1", "origin"});
  expect_message(robot("", "<origin xyz='0 1e9 0'/>"), {"far.urdf:2: joint 'j'", "origin"});
}

const char* const kBadNames[] = {"a\x1b[31m",
                                 "a\nb",
                                 "\x01",
                                 "a\x7f",
                                 "\xff",
                                 "\xc0\x80",
                                 "\xed\xa0\x80",
                                 "\xf5\x80\x80\x80",
                                 "\xc2\x9b"
                                 "31m",
                                 "\xef\xbf\xbf",
                                 "\xe2\x82"};
const char* const kGoodNames[] = {"a", "<!--<script>", "</script>",  "a - b", "Türgriff", "扉",
                                  "🚪", "a b",          "\"'&;|$(x)", "%s"};

TEST(Names, AreUtf8WithoutControlCharacters) {
  for (const char* name : kGoodNames) EXPECT_TRUE(is_valid_name(name)) << name;
  for (const char* name : kBadNames) EXPECT_FALSE(is_valid_name(name)) << name;
  EXPECT_FALSE(is_valid_name(""));
  EXPECT_EQ(printable("a\x1b[31m\xff\xc3\xa4\xe2\x82"), "a?[31m?ä??");
  for (const char* name : kBadNames) EXPECT_TRUE(is_valid_name(printable(name)));
  for (const char* control : {"\u202e", "\u202a", "\u2066", "\u2069", "\u200e", "\u200f", "\u061c",
                              "\u2028", "\u2029", "\ufeff", "\u200b", "\U000e0041", "\ufff9"}) {
    EXPECT_FALSE(is_valid_name(std::string("gnp") + control + ".stl"));
    EXPECT_EQ(printable(std::string("a") + control + "b"),
              "a" + std::string(std::string_view(control).size(), '?') + "b");
  }
  for (const char* joiner : {"\u200c", "\u200d"})
    EXPECT_TRUE(is_valid_name(std::string("a") + joiner + "b"));  // of Persian, of emoji
}

/// Writes a name as a double-quoted YAML scalar, with an escape for each byte that YAML would
/// refuse.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    char escaped[8];
    std::snprintf(escaped, sizeof escaped, "\\x%02x",
                  static_cast<unsigned>(static_cast<unsigned char>(c)));
    text +=
        static_cast<unsigned char>(c) < 0x20 || c == '"' || c == '\\' ? escaped : std::string(1, c);
  }
  return text + '"';
}

TEST(Names, OfProblemFiles) {
  const ProblemFolder folder;
  for (const char* name : kGoodNames) {
    const PathProblem problem =
        folder.load({{"scene", "[{name: " + quoted(name) + ", sphere: 1}]"}});
    EXPECT_EQ(problem.scene[0].name, name);
  }
  for (const char* name : kBadNames) {
    SCOPED_TRACE(quoted(name));
    for (const auto& [section, text] : std::map<std::string, std::string>{
             {"scene", "[{name: " + quoted(name) + ", sphere: 1}]"},
             {"robot", robot_with("attached: [{name: " + quoted(name) + ", sphere: 1}]")}}) {
      const std::string message = input_error([&] { (void)folder.load({{section, text}}); });
      expect_message(message, {"problem.yaml:"});
      EXPECT_TRUE(is_valid_name(message)) << message;
    }
  }
}

TEST(Names, OfRobots) {
  const TempFolder folder;
  for (const std::string name : {"a\x1b[31m", "a&#10;b", "\xff", "&#x7f;", "\xc2\x9b", ""}) {
    for (const std::string& text :
         {"<robot name='r'>\n<link name='" + name + "'/></robot>",
          "<robot name='" + name + "'>\n<link name='a'/></robot>",
          "<robot name='r'><link name='a'/><link name='b'/>\n<joint name='" + name +
              "' type='fixed'><parent link='a'/><child link='b'/></joint></robot>"}) {
      const std::string message =
          input_error([&] { (void)load_robot(folder.write("a.urdf", text)); });
      expect_message(message, {"a.urdf:"});
      EXPECT_TRUE(is_valid_name(message)) << message;
    }
    const fs::path urdf = folder.write("a.urdf", "<robot name='r'><link name='a'/></robot>");
    const fs::path srdf = folder.write(
        "a.srdf", "<robot name='r'>\n<disable_collisions link1='a' link2='" + name + "'/></robot>");
    const std::string message = input_error([&] { (void)load_robot(urdf, srdf); });
    expect_message(message, {"a.srdf:2"});
    EXPECT_TRUE(is_valid_name(message)) << message;
  }
}

}  // namespace
}  // namespace swivel::io::test
