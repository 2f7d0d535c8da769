// SPDX-License-Identifier: BSD-3-Clause
// Robots and problems with one word of them changed: what states geometry, limits or which joints
// move is understood or told from what is; nothing of it is passed over.
#include <tinyxml2.h>

#ifdef SWIVEL_URDFDOM
#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>
#endif

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "io_support.hpp"
#include "seed.hpp"

namespace swivel::io::test {
namespace {

using swivel::test::at_least;
using swivel::test::Random;
using swivel::test::trials;

/// Every element and attribute that the reader honours, on a tree with a mimic joint and joints of
/// all types.
const char* const kEveryWord = R"(<robot name="every" version="1.2">
<link name="base_link"><collision name="c"><origin xyz="0 0 0.1" rpy="0.1 0.2 0.3"/><geometry>
<box size="0.1 0.2 0.3"/></geometry></collision>
<collision><origin xyz="0 0 0.2" quat_xyzw="0 0.6 0 0.8"/><geometry>
<capsule radius="0.05" length="0.2"/></geometry></collision></link>
<link name="a"><collision><geometry><cylinder radius="0.05" length="0.2"/></geometry></collision>
</link>
<link name="b"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="c"/><link name="d"/><link name="e"/><link name="f"/>
<joint name="ja" type="revolute"><parent link="base_link"/><child link="a"/>
<origin xyz="0 0 0.3" rpy="0 0.5 0"/><axis xyz="0 0 2"/>
<limit lower="-1" upper="2" velocity="3" effort="4" acceleration="5" deceleration="4" jerk="60"/>
<safety_controller soft_lower_limit="-0.5" soft_upper_limit="1.5" k_position="10" k_velocity="10"/>
</joint>
<joint name="jb" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0.1 0 0.3"/>
<axis xyz="0 1 0"/>
<limit lower="0" upper="0.5" velocity="1" effort="1"/></joint>
<joint name="jc" type="continuous"><parent link="a"/><child link="c"/>
<origin rpy="0 0 1" xyz="0 0.2 0"/><axis xyz="1 1 0"/><limit velocity="1" effort="1"/></joint>
<joint name="jd" type="revolute"><parent link="b"/><child link="d"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/>
<mimic joint="jb" multiplier="-2" offset="0.5"/></joint>
<joint name="je" type="fixed"><parent link="d"/><child link="e"/>
<origin xyz="0 0 0.1" quat_xyzw="0.5 0.5 0.5 0.5"/></joint>
<joint name="jf" type="floating"><parent link="base_link"/><child link="f"/>
<origin xyz="1 0 0.1"/></joint>
</robot>)";

std::vector<std::string> robots(const char* extension) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(SWIVEL_DATA_DIR) / "robots"))
    if (entry.path().extension() == extension) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<std::string> texts;
  for (const fs::path& file : files) texts.push_back(TempFolder::read(file));
  return texts;
}

/// A document and its elements.
struct Xml {
  explicit Xml(const std::string& text) {
    EXPECT_EQ(document.Parse(text.c_str()), tinyxml2::XML_SUCCESS);
    collect(*document.RootElement());
  }
  [[nodiscard]] std::string text() const {
    tinyxml2::XMLPrinter printer;
    document.Print(&printer);
    return printer.CStr();
  }
  void collect(tinyxml2::XMLElement& element) {
    elements.push_back(&element);
    for (auto* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement())
      collect(*child);
  }
  tinyxml2::XMLDocument document;
  std::vector<tinyxml2::XMLElement*> elements;
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, what.size(), by);
}

/// A slip of the hand: a letter more, less, twice, in capitals, or two of them swapped.
std::string misspelt(std::string word, Random& random) {
  const std::string before = word;
  while (word == before || word.empty()) {
    word = before;
    const auto at = static_cast<std::size_t>(random.below(static_cast<int>(word.size())));
    switch (random.below(5)) {
      case 0:
        word.insert(at, 1, static_cast<char>('a' + random.below(26)));
        break;
      case 1:
        word.erase(at, 1);
        break;
      case 2:
        word.insert(at, 1, word[at]);
        break;
      case 3:
        word[at] = static_cast<char>(std::toupper(word[at]));
        break;
      default:
        std::swap(word[at], word[at == 0 ? word.size() - 1 : at - 1]);
    }
  }
  return word;
}

enum class What {
  kRenameElement,
  kDoubleElement,
  kRemoveElement,
  kRenameAttribute,
  kDoubleAttribute,
  kRemoveAttribute
};

struct Mutation {
  What what;
  std::string element, attribute, text;
  /// The same text with what is removed written as the default that the format has for it; none
  /// where it has none.
  std::optional<std::string> with_default = {};
};

/// Returns the default of an attribute that is not there, by https://wiki.ros.org/urdf/XML.
std::optional<std::string> default_of(const std::string& element, const std::string& attribute) {
  static const std::map<std::string, std::string> kDefaults{
      {"origin xyz", "0 0 0"},        {"origin rpy", "0 0 0"}, {"limit lower", "0"},
      {"limit upper", "0"},           {"limit velocity", "0"}, {"limit effort", "0"},
      {"mimic multiplier", "1"},      {"mimic offset", "0"},   {"mesh scale", "1 1 1"},
      {"origin quat_xyzw", "0 0 0 1"}};
  const auto found = kDefaults.find(element + " " + attribute);
  return found == kDefaults.end() ? std::nullopt : std::optional(found->second);
}

/// One random change of one element with one of those names, or of one of its attributes.
std::optional<Mutation> mutated(const std::string& text, const std::set<std::string>& names,
                                Random& random) {
  Xml xml(text);
  auto& element =
      *xml.elements[static_cast<std::size_t>(random.below(static_cast<int>(xml.elements.size())))];
  Mutation result{static_cast<What>(random.below(6)), element.Name(), "", ""};
  if (!names.contains(result.element)) return {};
  if (result.what < What::kRenameAttribute) {
    if (&element == xml.document.RootElement()) return {};
    if (result.what == What::kRenameElement) {
      element.SetName(misspelt(element.Name(), random).c_str());
    } else if (result.what == What::kDoubleElement) {
      element.Parent()->InsertAfterChild(&element, element.DeepClone(&xml.document));
    } else {
      if (result.element == "origin" || result.element == "axis") {
        tinyxml2::XMLElement* const there = xml.document.NewElement(element.Name());
        there->SetAttribute("xyz", result.element == "axis" ? "1 0 0" : "0 0 0");
        element.Parent()->InsertAfterChild(&element, there);
        auto* const parent = element.Parent();
        parent->DeleteChild(&element);
        result.with_default = xml.text();
        parent->DeleteChild(there);
      } else {
        element.Parent()->DeleteChild(&element);
      }
    }
    result.text = xml.text();
    return result;
  }
  std::vector<std::string> attributes;
  for (const auto* attribute = element.FirstAttribute(); attribute != nullptr;
       attribute = attribute->Next())
    attributes.emplace_back(attribute->Name());
  if (attributes.empty()) return {};
  const std::string name =
      attributes[static_cast<std::size_t>(random.below(static_cast<int>(attributes.size())))];
  const std::string value = element.Attribute(name.c_str());
  result.attribute = name;
  if (result.what == What::kDoubleAttribute) {
    element.SetAttribute("MORE", value.c_str());
    result.text = replaced(xml.text(), "MORE", name);
    return result;
  }
  if (result.what == What::kRemoveAttribute) {
    if (const auto there = default_of(result.element, name)) {
      element.SetAttribute(name.c_str(), there->c_str());
      result.with_default = xml.text();
    }
    element.DeleteAttribute(name.c_str());
  } else {
    element.DeleteAttribute(name.c_str());
    element.SetAttribute(misspelt(name, random).c_str(), value.c_str());
  }
  result.text = xml.text();
  return result;
}

/// All that a plan takes from a model, but lines and warnings.
std::string kinematics(const RobotModel& robot) {
  std::ostringstream text;
  text.precision(17);
  const auto pose = [&](const Pose& p) { text << p.matrix() << '\n'; };
  text << robot.root_link << '\n';
  for (const Joint& j : robot.joints) {
    text << j.name << ' ' << static_cast<int>(j.type) << ' ' << j.parent_link << ' ' << j.child_link
         << ' ' << j.axis.transpose() << ' ' << j.lower << ' ' << j.upper << ' ' << j.velocity
         << ' ' << j.acceleration << ' ' << j.jerk;
    if (j.mimic)
      text << " mimics " << j.mimic->joint << ' ' << j.mimic->multiplier << ' ' << j.mimic->offset;
    pose(j.origin);
  }
  for (const Link& link : robot.links) {
    text << link.name << ' ' << link.parent_joint << ' ' << link.collision.size() << '\n';
    for (const PlacedShape& shape : link.collision) {
      text << shape.shape.index() << ' ';
      if (const auto* box = std::get_if<Box>(&shape.shape)) text << box->size.transpose();
      if (const auto* one = std::get_if<Sphere>(&shape.shape)) text << one->radius;
      if (const auto* one = std::get_if<Cylinder>(&shape.shape))
        text << one->radius << ' ' << one->length;
      if (const auto* one = std::get_if<Capsule>(&shape.shape))
        text << one->radius << ' ' << one->length;
      pose(shape.pose);
    }
  }
  return text.str();
}

std::size_t bodies(const RobotModel& robot) {
  std::size_t count = 0;
  for (const Link& link : robot.links) count += link.collision.size();
  return count;
}

/// The model, or none where the text is refused; what is refused is told in one line.
std::shared_ptr<const RobotModel> read(const std::string& urdf, const std::string& srdf = "") {
  try {
    return parse_robot(urdf, srdf);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    EXPECT_NE(std::string(error.what()).find(": allowed is "), std::string::npos) << error.what();
    return nullptr;
  }
}

#ifdef SWIVEL_URDFDOM
/// Holds a model against what urdfdom, which kdl_parser and robot_state_publisher read by, makes of
/// the file: poses and axes to the last bit. Returns false where urdfdom refuses the file.
bool agrees_with_urdfdom(const std::string& text, const RobotModel& robot) {
  console_bridge::noOutputHandler();
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  console_bridge::restorePreviousOutputHandler();
  if (!model) return false;
  EXPECT_EQ(model->joints_.size(), robot.joints.size());
  EXPECT_EQ(model->links_.size(), robot.links.size());
  EXPECT_EQ(model->getRoot()->name, robot.links[static_cast<std::size_t>(robot.root_link)].name);
  for (const Joint& joint : robot.joints) {
    const auto& other = *model->joints_.at(joint.name);
    const auto& [position, rotation] = std::pair(other.parent_to_joint_origin_transform.position,
                                                 other.parent_to_joint_origin_transform.rotation);
    EXPECT_EQ(joint.origin.translation(), Vector3d(position.x, position.y, position.z))
        << joint.name;
    EXPECT_EQ(
        joint.origin.linear(),
        Quaterniond(rotation.w, rotation.x, rotation.y, rotation.z).normalized().toRotationMatrix())
        << joint.name;
    EXPECT_EQ(other.parent_link_name,
              robot.links[static_cast<std::size_t>(joint.parent_link)].name);
    if (!joint.movable()) continue;
    const Vector3d axis(other.axis.x, other.axis.y, other.axis.z);
    EXPECT_EQ(joint.axis, axis / axis.norm()) << joint.name;
    if (joint.type == Joint::Type::kContinuous) continue;
    const Joint::Range limits = joint.hard.value_or(Joint::Range{joint.lower, joint.upper});
    EXPECT_EQ(limits.lower, other.limits->lower);
    EXPECT_EQ(limits.upper, other.limits->upper);
    EXPECT_EQ(joint.velocity, other.limits->velocity);
    EXPECT_EQ(joint.mimic.has_value(), other.mimic != nullptr);
    if (!joint.mimic) continue;
    EXPECT_EQ(joint.mimic->multiplier, other.mimic->multiplier);
    EXPECT_EQ(joint.mimic->offset, other.mimic->offset);
  }
  for (const Link& link : robot.links)
    EXPECT_EQ(link.collision.size(), model->links_.at(link.name)->collision_array.size());
  return true;
}
#endif

/// Counts what became of changed robots.
struct UrdfCounts {
  int refused = 0, warned = 0, defaults = 0, removed = 0, doubled_bodies = 0, compared = 0;
};

/// Expects a robot from whose text a mutation removed something to be as the format's defaults say.
/// `text` is what it was before, `whole` the robot of that.
void expect_defaults(const Mutation& mutation, const RobotModel& robot, const std::string& text,
                     const RobotModel& whole, UrdfCounts& counts) {
  if (mutation.with_default) {
    ++counts.defaults;
    const auto written = read(*mutation.with_default);
    ASSERT_TRUE(written);
    EXPECT_EQ(kinematics(robot), kinematics(*written));
  }
  if (mutation.element == "collision" && mutation.attribute.empty()) {
    EXPECT_EQ(bodies(robot) + 1, bodies(whole));
  }
  if (mutation.element == "safety_controller" && mutation.attribute.empty()) {
    EXPECT_EQ(kinematics(robot), kinematics(*parse_robot(text, "", {}, {{}, false})));
  }
#ifdef SWIVEL_URDFDOM
  // The words of URDF 1.1 and 1.2, which older ones do not have, and limits without a velocity,
  // which they refuse, are left out.
  if (text != kEveryWord) counts.compared += agrees_with_urdfdom(mutation.text, robot);
#endif
}

/// Expects a changed robot to be refused or warned of, unless a body was doubled or something was
/// removed. `text` is what it was before, `whole` the robot of that.
void expect_nothing_passed_over(const Mutation& mutation, const std::string& text,
                                const RobotModel& whole, UrdfCounts& counts) {
  SCOPED_TRACE("<" + mutation.element + "> " + mutation.attribute + ", mutation " +
               std::to_string(static_cast<int>(mutation.what)));
  const auto robot = read(mutation.text);
  if (!robot) {
    ++counts.refused;
    return;
  }
  const bool removes =
      mutation.what == What::kRemoveElement || mutation.what == What::kRemoveAttribute;
  if (!removes && robot->warnings.size() > whole.warnings.size()) {
    ++counts.warned;
  } else if (mutation.what == What::kDoubleElement && mutation.element == "collision") {
    ++counts.doubled_bodies;
    EXPECT_EQ(bodies(*robot), bodies(whole) + 1);
  } else {
    ++counts.removed;
    ASSERT_TRUE(removes) << "passed over:\n" << mutation.text;
    expect_defaults(mutation, *robot, text, whole, counts);
  }
}

TEST(Mutated, Urdf) {
  Random random(swivel::test::seed("Mutated.Urdf"));
  const std::set<std::string> names{"link",     "joint", "collision", "origin",
                                    "geometry", "box",   "sphere",    "cylinder",
                                    "capsule",  "mesh",  "parent",    "child",
                                    "axis",     "limit", "mimic",     "safety_controller"};
  std::vector<std::string> texts = robots(".urdf");
  texts.insert(texts.end(), texts.size(), kEveryWord);  // half of the trials
  ASSERT_GE(texts.size(), 18u);
  std::map<std::string, std::shared_ptr<const RobotModel>> wholes;
  for (const std::string& text : texts) wholes[text] = read(text);
  UrdfCounts counts;
  const int wanted = trials(2000);
  for (int trial = 0; trial < wanted;) {
    const std::string& text =
        texts[static_cast<std::size_t>(random.below(static_cast<int>(texts.size())))];
    const auto mutation = mutated(text, names, random);
    if (!mutation) continue;
    ++trial;
    expect_nothing_passed_over(*mutation, text, *wholes.at(text), counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d refused, %d warned of, %d bodies doubled, %d removed, of these %d as with the default, "
      "%d as urdfdom reads them\n",
      counts.refused, counts.warned, counts.doubled_bodies, counts.removed, counts.defaults,
      counts.compared);
  EXPECT_GE(counts.refused, at_least(1200));
  EXPECT_GE(counts.warned, at_least(15));
  EXPECT_GE(counts.doubled_bodies, at_least(5));
  EXPECT_GE(counts.removed, at_least(200));
  EXPECT_GE(counts.defaults, at_least(100));
#ifdef SWIVEL_URDFDOM
  EXPECT_GE(counts.compared, at_least(50));
#endif
}

/// Robots of the project, as they are.
TEST(Mutated, NothingOfTheProjectsRobotsIsWarnedOf) {
  int compared = 0;
  for (const std::string& text : robots(".urdf")) {
    const auto robot = read(text);
    ASSERT_TRUE(robot);
    EXPECT_TRUE(robot->warnings.empty()) << robot->warnings.front();
#ifdef SWIVEL_URDFDOM
    EXPECT_TRUE(agrees_with_urdfdom(text, *robot));
#endif
    ++compared;
  }
  EXPECT_GE(compared, 9);
}

/// Elements of SRDF with their attributes, about the robot of arm_urdf().
const char* const kEveryWordOfSrdf =
    R"(<robot name="arm"><group name="g"><link name="link_1"/><joint name="joint_1"/>
<chain base_link="base_link" tip_link="link_7"/>
<group name="h"/></group><group_state name="s" group="g">
<joint name="joint_2" value="0"/></group_state>
<end_effector name="e" parent_link="link_7" group="g"/>
<virtual_joint name="v" type="fixed" parent_frame="world" child_link="base_link"/>
<passive_joint name="finger_joint"/>
<joint_property joint_name="joint_1" property_name="p" value="1"/>
<disable_default_collisions link="link_2"/>
<enable_collisions link1="link_2" link2="link_5" reason="x"/>
<disable_collisions link1="link_3" link2="link_5" reason="x"/>
<link_sphere_approximation link="link_1">
<sphere center="0 0 0" radius="0.1"/></link_sphere_approximation></robot>)";

TEST(Mutated, Srdf) {
  Random random(swivel::test::seed("Mutated.Srdf"));
  const std::set<std::string> names{"group",
                                    "link",
                                    "joint",
                                    "chain",
                                    "group_state",
                                    "end_effector",
                                    "virtual_joint",
                                    "passive_joint",
                                    "joint_property",
                                    "disable_default_collisions",
                                    "enable_collisions",
                                    "disable_collisions",
                                    "link_sphere_approximation",
                                    "sphere"};
  std::vector<std::pair<std::string, std::string>> robots_and_srdfs{{arm_urdf(), kEveryWordOfSrdf}};
  const std::vector<std::string> urdfs = robots(".urdf"), srdfs = robots(".srdf");
  ASSERT_EQ(urdfs.size(), srdfs.size());
  for (std::size_t k = 0; k < urdfs.size(); ++k) robots_and_srdfs.emplace_back(urdfs[k], srdfs[k]);
  for (const auto& [urdf, srdf] : robots_and_srdfs)
    EXPECT_TRUE(read(urdf, srdf)->warnings.empty()) << read(urdf, srdf)->warnings.front();
  int refused = 0, warned = 0, same = 0;
  const int wanted = trials(1000);
  for (int trial = 0; trial < wanted;) {
    const auto& [urdf, srdf] =
        robots_and_srdfs[random.coin() ? 0
                                       : static_cast<std::size_t>(random.below(
                                             static_cast<int>(robots_and_srdfs.size())))];
    const auto mutation = mutated(srdf, names, random);
    if (!mutation || mutation->what == What::kRemoveElement ||
        mutation->what == What::kRemoveAttribute)
      continue;
    ++trial;
    const auto robot = read(urdf, mutation->text);
    if (!robot) {
      ++refused;
    } else if (!robot->warnings.empty()) {
      ++warned;
    } else {  // what stands twice says nothing new
      ++same;
      EXPECT_EQ(static_cast<int>(mutation->what), static_cast<int>(What::kDoubleElement))
          << "passed over:\n"
          << mutation->text;
      EXPECT_EQ(robot->disabled_pairs, read(urdf, srdf)->disabled_pairs);
    }
  }
  std::printf("%d refused, %d warned of, %d doubled elements\n", refused, warned, same);
  EXPECT_GE(refused, at_least(300));
  EXPECT_GE(warned, at_least(150));
  EXPECT_GE(same, at_least(150));
}

/// Keys misspelt or doubled. Files that the problems name lie where they do in the data folder.
TEST(Mutated, Problems) {
  Random random(swivel::test::seed("Mutated.Problems"));
  const TempFolder folder;
  std::vector<std::string> texts;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(SWIVEL_DATA_DIR)) {
    if (!entry.is_directory()) continue;
    if (entry.path().filename() != "problems") {
      fs::create_directory_symlink(entry.path(), folder.path() / entry.path().filename());
      continue;
    }
    for (const auto& problem : fs::directory_iterator(entry.path()))
      files.push_back(problem.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files)
    if (file.extension() == ".yaml")
      texts.push_back(std::regex_replace(TempFolder::read(file), std::regex("#[^\n]*"), ""));
  ASSERT_GE(texts.size(), 10u);
  const std::regex key("(^|[{,\n])( *(?:- )?)([a-z_]+)(: )");
  int misspelt_keys = 0, doubled = 0;
  const int wanted = trials(300);
  for (int trial = 0; trial < wanted; ++trial) {
    std::string text =
        texts[static_cast<std::size_t>(random.below(static_cast<int>(texts.size())))];
    std::vector<std::smatch> found;
    const std::string before = text;
    for (auto at = std::sregex_iterator(before.begin(), before.end(), key);
         at != std::sregex_iterator(); ++at)
      found.push_back(*at);
    const std::smatch& one =
        found[static_cast<std::size_t>(random.below(static_cast<int>(found.size())))];
    const std::string name = one[3];
    const auto at = static_cast<std::size_t>(one.position(3));
    const std::size_t end = before.find_first_of(",}\n", at);
    const std::string value = before.substr(at + name.size() + 2, end - at - name.size() - 2);
    if (random.coin() || value.find_first_of("[{") != std::string::npos ||
        before[one.position(0)] != '{') {
      ++misspelt_keys;
      text.replace(at, name.size(), misspelt(name, random));
    } else {
      ++doubled;
      text.insert(at, name + ": " + value + ", ");
    }
    const std::string message =
        input_error([&] { (void)load_path_problem(folder.write("problems/problem.yaml", text)); });
    EXPECT_NE(message.find("problem.yaml"), std::string::npos) << message << '\n' << text;
  }
  std::printf("%d misspelt, %d doubled\n", misspelt_keys, doubled);
  EXPECT_GE(misspelt_keys, at_least(200));
  EXPECT_GE(doubled, at_least(15));
}

}  // namespace
}  // namespace swivel::io::test
