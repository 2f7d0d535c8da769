// SPDX-License-Identifier: BSD-3-Clause
#include "robots/urdf.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "files/text_number.hpp"
#include "files/xml.hpp"
#include "robots/joint_limits.hpp"
#include "robots/srdf.hpp"
#include "robots/xml_words.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/nearest_name.hpp"
#include "swivel/core/messages/robot_key_error.hpp"
#include "swivel/io/meshes/mesh.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"

namespace swivel::io {

namespace {

constexpr std::size_t kMostLinks = 10'000;  // the largest real robots have hundreds
constexpr std::size_t kMostShapes = 10'000;

/// The elements of URDF 1.0 to 1.2 (https://wiki.ros.org/urdf/XML and
/// https://github.com/ros/urdfdom/tree/master/xsd) that state geometry, limits and moving joints.
/// Elements listed as `unread` describe looks, dynamics, drives and simulators; they come from the
/// same pages, from Gazebo (https://classic.gazebosim.org/tutorials?tut=ros_urdf), ros2_control
/// (https://control.ros.org), Bullet (<contact>), MuJoCo (<mujoco>), and from the time of the PR2
/// robot (<verbose>, <contact_coefficients>, <map>).
const XmlElement& urdf_format() {
  static const XmlElement origin{"origin", {"xyz", "rpy", "quat_xyzw"}};
  static const XmlElement geometry{"geometry",
                                   {},
                                   {{"box", {"size"}},
                                    {"sphere", {"radius"}},
                                    {"cylinder", {"radius", "length"}},
                                    {"capsule", {"radius", "length"}},
                                    {"mesh", {"filename", "scale"}}}};
  static const XmlElement collision{"collision",
                                    {"name"},
                                    {origin, geometry},
                                    {"material", "verbose", "contact_coefficients"},
                                    XmlElement::Unknown::kRefused,
                                    true};
  static const XmlElement link{"link",
                               {"name", "type"},
                               {collision},
                               {"visual", "inertial", "contact", "sensor", "gazebo"},
                               XmlElement::Unknown::kWarnedOf,
                               true};
  static const XmlElement joint{
      "joint",
      {"name", "type"},
      {{"parent", {"link"}},
       {"child", {"link"}},
       origin,
       {"axis", {"xyz"}},
       {"limit", {"lower", "upper", "velocity", "effort", "acceleration", "deceleration", "jerk"}},
       {"mimic", {"joint", "multiplier", "offset"}},
       {"safety_controller", {"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"}}},
      {"dynamics", "calibration"},
      XmlElement::Unknown::kRefused,
      true};
  static const XmlElement robot{
      "robot",
      {"name", "version"},
      {link, joint},
      {"material", "transmission", "gazebo", "ros2_control", "sensor", "mujoco"},
      XmlElement::Unknown::kWarnedOf};
  return robot;
}

/// Returns the format of a <visual> element that is read as a link's body: that of <collision>,
/// with its own unread elements.
XmlElement visual_format() {
  XmlElement visual = urdf_format().children.front().children.front();
  visual.name = "visual";
  visual.unread = {"material"};
  return visual;
}

/// Calls `visit` for every child element of this name.
template <class Visit>
void for_each_child(const tinyxml2::XMLElement& element, const char* name, const Visit& visit) {
  for (const auto* child = element.FirstChildElement(name); child != nullptr;
       child = child->NextSiblingElement(name))
    visit(*child);
}

/// Returns Rz(yaw) Ry(pitch) Rx(roll) for rpy in rad, computed by half angles so that it equals
/// urdfdom's result to the last bit.
Quaterniond from_urdf_rpy(const Vector3d& rpy) {
  const double phi = rpy.x() / 2, the = rpy.y() / 2, psi = rpy.z() / 2;
  const double x =
      std::sin(phi) * std::cos(the) * std::cos(psi) - std::cos(phi) * std::sin(the) * std::sin(psi);
  const double y =
      std::cos(phi) * std::sin(the) * std::cos(psi) + std::sin(phi) * std::cos(the) * std::sin(psi);
  const double z =
      std::cos(phi) * std::cos(the) * std::sin(psi) - std::sin(phi) * std::sin(the) * std::cos(psi);
  const double w =
      std::cos(phi) * std::cos(the) * std::cos(psi) + std::sin(phi) * std::sin(the) * std::sin(psi);
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  return {w / length, x / length, y / length, z / length};
}

/// Returns whether a text has a "${...}" or "$(...)" that xacro would have expanded.
bool is_xacro(const std::string& text) {
  return text.find("${") != std::string::npos || text.find("$(") != std::string::npos;
}

/// An XML element of a link or joint, which reads its attributes as numbers, names and poses.
/// Messages name the file, the line, and the link or joint.
class Element {
 public:
  Element(const tinyxml2::XMLElement& xml, const std::string& file, const std::string& owner)
      : xml_(xml), file_(file), owner_(owner) {}

  [[nodiscard]] std::string where() const {
    return at_line(file_, xml_.GetLineNum()) + ": " + owner_;
  }
  [[noreturn]] void fail(const std::string& what, const std::string& allowed) const {
    bad_input(where(), what, allowed);
  }
  [[nodiscard]] bool has(const char* attribute) const {
    return xml_.Attribute(attribute) != nullptr;
  }
  [[nodiscard]] Element with(const tinyxml2::XMLElement& child) const {
    return {child, file_, owner_};
  }

  [[nodiscard]] std::string text(const char* attribute,
                                 const std::string& allowed = "a name") const {
    const char* const value = xml_.Attribute(attribute);
    if (value == nullptr || *value == 0)
      fail(label(attribute) + (value == nullptr ? " is missing" : " is empty"), allowed);
    if (is_xacro(value))
      fail(label(attribute) + " is '" + value + "'", allowed + ", xacro expanded");
    return value;
  }
  /// Returns the number that an attribute states. It must be finite unless `infinite` allows
  /// otherwise.
  [[nodiscard]] double number(const char* attribute, bool infinite = false) const {
    const std::string allowed = "a number", all = text(attribute, allowed);
    Words words(all);
    const auto value = to_number<double>(words.next());
    if (!value || !words.next().empty() || std::isnan(*value) || (!infinite && std::isinf(*value)))
      fail(label(attribute) + " is '" + all + "'", allowed);
    return *value;
  }
  [[nodiscard]] double number_or(const char* attribute, double otherwise) const {
    return has(attribute) ? number(attribute) : otherwise;
  }
  template <int kCount>
  [[nodiscard]] Eigen::Matrix<double, kCount, 1> numbers(const char* attribute) const {
    const std::string allowed = std::to_string(kCount) + " numbers with spaces between",
                      all = text(attribute, allowed);
    Words words(all);
    Eigen::Matrix<double, kCount, 1> result;
    bool right = true;
    for (double& number : result) {
      const auto value = to_number<double>(words.next());
      right = right && value && std::isfinite(*value);
      if (right) number = *value;
    }
    if (!right || !words.next().empty()) fail(label(attribute) + " is '" + all + "'", allowed);
    return result;
  }
  [[nodiscard]] double length(const char* attribute) const {
    return positive(attribute, number(attribute));
  }
  [[nodiscard]] Vector3d lengths(const char* attribute) const {
    const Vector3d result = numbers<3>(attribute);
    for (const double one : result) positive(attribute, one);
    return result;
  }

  /// Returns the pose that a child <origin> states; the identity if there is none.
  [[nodiscard]] Pose origin() const {
    const auto* const child = xml_.FirstChildElement("origin");
    return child == nullptr ? Pose::Identity() : with(*child).pose();
  }

 private:
  [[nodiscard]] std::string label(const char* attribute) const {
    return std::string(xml_.Name()) + " " + attribute;
  }
  double positive(const char* attribute, double value) const {
    if (!(value > 0 && value <= kMostMetres))
      fail(label(attribute) + " is " + format_double(value), kLengthAllowed);
    return value;
  }
  [[nodiscard]] Pose pose() const {
    Pose result = Pose::Identity();
    if (has("xyz")) result.translation() = numbers<3>("xyz");
    if (!(result.translation().array().abs() <= kMostMetres).all())
      fail("origin is too far away", "numbers from -1000 to 1000 for xyz");
    if (has("rpy") && has("quat_xyzw")) fail("origin has rpy and quat_xyzw", "one of them");
    if (has("rpy"))
      result.linear() = from_urdf_rpy(numbers<3>("rpy")).normalized().toRotationMatrix();
    if (has("quat_xyzw")) {
      const Eigen::Vector4d q = numbers<4>("quat_xyzw");
      if (!(q.norm() > 1e-9) || !std::isfinite(q.norm()))
        fail("origin quat_xyzw has no direction", "a quaternion of length 1");
      result.linear() = Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
    }
    if (!result.linear().allFinite()) fail("origin is not finite", "angles in rad");
    return result;
  }

  const tinyxml2::XMLElement& xml_;
  const std::string& file_;
  const std::string& owner_;
};

/// Which elements give a link its shapes; with kNone no meshes are read. Of kVisual, shapes that
/// cannot be read are left out, and those of <collision> are not looked at.
enum class Shapes { kCollision, kVisualWhereNoCollision, kVisual, kNone };

/// Builds the model of a URDF; links and joints stay in the order of the file.
class ModelBuilder {
 public:
  ModelBuilder(const XmlSource& source, const Packages& packages, const RobotOptions& options,
               Shapes shapes = Shapes::kCollision)
      : source_(source),
        file_(source.file.string()),
        packages_(packages),
        options_(options),
        shapes_(shapes) {}

  UrdfRobot build() {
    tinyxml2::XMLDocument document;
    const tinyxml2::XMLElement& robot = load_robot_xml(source_, "URDF", document);
    check(robot);
    check_name(robot);
    check_names(robot, "link", links_);
    check_names(robot, "joint", joints_);
    check_tree(robot);
    leave_out(robot);
    model_->name = robot.Attribute("name");
    model_->source = file_;
    note_files();
    for_each_kept(robot, "link", links_,
                  [&](const auto& element, const std::string& owner) { add_link(element, owner); });
    for_each_kept(robot, "joint", joints_, [&](const auto& element, const std::string& owner) {
      add_joint(element, owner);
    });
    for_each_kept(robot, "joint", joints_, [&](const auto& element, const std::string& owner) {
      add_mimic(element, owner);
    });
    model_->root_link = links_.at(root_);
    model_->warnings = warnings_.list();
    return {model_, std::move(left_out_)};
  }

  [[nodiscard]] const ShapeSurvey& survey() const { return survey_; }
  /// Returns a message for each visual shape that was left out.
  [[nodiscard]] const std::vector<std::string>& unread() const { return unread_; }

 private:
  using Index = std::map<std::string, int, std::less<>>;

  [[nodiscard]] std::string at(const tinyxml2::XMLElement& element) const {
    return at_line(file_, element.GetLineNum());
  }
  [[nodiscard]] std::string where(const tinyxml2::XMLElement& element) const {
    return at(element) + ": " + owner(element);
  }
  [[nodiscard]] static std::string owner(const tinyxml2::XMLElement& element) {
    return std::string(element.Name()) + " '" + element.Attribute("name") + "'";
  }

  /// Notes what the model is made from, its file where that can be read once more.
  void note_files() {
    namespace fs = std::filesystem;
    std::error_code error;
    const auto absolute = [&](const fs::path& path) { return fs::absolute(path, error).string(); };
    ModelFiles& files = model_->files;
    if (!source_.text && fs::is_regular_file(source_.file, error))
      files.urdf = absolute(source_.file);
    for (const auto& [name, folder] : packages_) files.packages[name] = absolute(folder);
    files.without = options_.without;
    files.soft_limits = options_.soft_limits;
  }

  void check(const tinyxml2::XMLElement& robot) {
    XmlElement format = urdf_format();
    if (shapes_ == Shapes::kVisualWhereNoCollision) {
      XmlElement& link = format.children.front();
      link.children.push_back(visual_format());
      std::erase(link.unread, std::string_view("visual"));
    }
    check_words(robot, format, file_, warnings_);
    const char* const version = robot.Attribute("version");
    if (version == nullptr) return;
    for (const std::string_view known : {"1", "1.0", "1.1", "1.2"})
      if (version == known) return;
    warnings_.add(at(robot), "version '" + printable(std::string_view(version).substr(0, 20)) +
                                 "' of URDF is read as 1.2 is");
  }

  void check_name(const tinyxml2::XMLElement& element) const {
    const char* const name = element.Attribute("name");
    if (name == nullptr || !is_valid_name(name))
      bad_input(at(element),
                std::string("<") + element.Name() + "> " +
                    (name == nullptr ? "has no name" : "has the name '" + std::string(name) + "'"),
                kValidName);
    if (is_xacro(name))
      bad_input(at(element), std::string("<") + element.Name() + "> has the name '" + name + "'",
                "a name, xacro expanded");
  }

  void check_names(const tinyxml2::XMLElement& robot, const char* kind, Index& index) const {
    for_each_child(robot, kind, [&](const tinyxml2::XMLElement& element) {
      check_name(element);
      if (!index.emplace(element.Attribute("name"), static_cast<int>(index.size())).second)
        bad_input(where(element), "name is taken", "a name of its own");
      if (index.size() > kMostLinks)
        bad_input(where(element), "too many of its kind",
                  "at most " + std::to_string(kMostLinks) + " links and joints");
    });
    if (links_.empty())
      bad_input(at(robot), "has no link",
                "a robot of at least one; of a .xacro what `xacro FILE` prints");
  }

  /// Returns the name of the link that a joint's <parent> or <child> names. Throws InputError for
  /// an unknown one.
  [[nodiscard]] std::string end_of(const tinyxml2::XMLElement& joint, const char* kind) const {
    const auto* const end = joint.FirstChildElement(kind);
    const char* const name = end == nullptr ? nullptr : end->Attribute("link");
    if (name == nullptr)
      bad_input(where(joint), std::string("no <") + kind + " link=...>", "the names of two links");
    if (links_.contains(name)) return name;
    bad_input(where(joint),
              std::string(kind) + " names an unknown link '" + name + "', nearest is '" +
                  nearest(name, links_) + "'",
              "a link of this file");
  }

  [[nodiscard]] static std::string nearest(const std::string& name, const Index& index) {
    std::vector<std::string> known;
    for (const auto& [one, place] : index) known.push_back(one);
    return nearest_name(name.substr(0, 200), known);
  }

  /// Checks that the links are a tree: one root is above every link, and every other link has one
  /// parent joint.
  void check_tree(const tinyxml2::XMLElement& robot) {
    for_each_child(robot, "joint", [&](const tinyxml2::XMLElement& element) {
      const std::string parent = end_of(element, "parent"), child = end_of(element, "child");
      if (!up_of_.emplace(child, Up{parent, &element}).second)
        bad_input(where(element), "link '" + child + "' has another parent joint already",
                  "a tree: one parent joint a link");
    });
    int walk = 0;
    for (auto& [child, start] : up_of_) {
      std::string_view link = child;
      for (auto up = up_of_.find(link); up != up_of_.end(); up = up_of_.find(link)) {
        if (up->second.walk == walk)
          bad_input(where(*up->second.joint), "closes a loop at link '" + up->first + "'",
                    "a tree: no link above itself");
        if (up->second.walk >= 0) break;
        up->second.walk = walk;
        link = up->second.parent;
      }
      ++walk;
    }
    for_each_child(robot, "link", [&](const tinyxml2::XMLElement& element) {
      const std::string name = element.Attribute("name");
      if (up_of_.contains(name)) return;
      if (!root_.empty())
        bad_input(where(element), "is a second root beside '" + root_ + "'",
                  "a tree: one link alone without a parent joint");
      root_ = name;
    });
  }

  /// Removes the links of RobotOptions::without and all links below them, with the joints above
  /// each, from `links_` and `joints_`.
  void leave_out(const tinyxml2::XMLElement& robot) {
    if (options_.without.empty()) return;
    std::map<std::string, std::vector<std::string>, std::less<>> below;
    for (const auto& [child, up] : up_of_) below[up.parent].push_back(child);
    std::vector<std::string> open;
    for (const std::string& name : options_.without) {
      if (!links_.contains(name))
        throw RobotKeyError(file_, "without",
                            "unknown link '" + name + "', nearest is '" + nearest(name, links_) +
                                "': allowed is a link of the robot",
                            name);
      if (name == root_)
        throw RobotKeyError(file_, "without",
                            "'" + name + "' carries all others: allowed is a link below the root",
                            name);
      open.push_back(name);
    }
    while (!open.empty()) {
      const std::string name = std::move(open.back());
      open.pop_back();
      if (links_.erase(name) == 0) continue;
      const std::string joint = up_of_.find(name)->second.joint->Attribute("name");
      joints_.erase(joint);
      left_out_.insert({name, joint});
      open.insert(open.end(), below[name].begin(), below[name].end());
    }
    for (const auto& [kind, index] : {std::pair("link", &links_), std::pair("joint", &joints_)}) {
      int place = 0;
      for_each_kept(robot, kind, *index,
                    [&, &index = index](const auto& element, const std::string&) {
                      index->find(element.Attribute("name"))->second = place++;
                    });
    }
  }

  template <class Visit>
  void for_each_kept(const tinyxml2::XMLElement& robot, const char* kind, const Index& index,
                     const Visit& visit) const {
    for_each_child(robot, kind, [&](const tinyxml2::XMLElement& element) {
      if (index.contains(std::string_view(element.Attribute("name"))))
        visit(element, owner(element));
    });
  }

  void add_link(const tinyxml2::XMLElement& element, const std::string& owner) {
    Link link;
    link.name = element.Attribute("name");
    if (const auto up = up_of_.find(link.name); up != up_of_.end())
      link.parent_joint = joints_.at(up->second.joint->Attribute("name"));
    const bool has_collision = element.FirstChildElement("collision") != nullptr;
    for_each_child(element, "collision", [&](const tinyxml2::XMLElement& xml) {
      ++survey_.collision;
      if (shapes_ != Shapes::kVisual)
        add_shape(Element(xml, file_, owner), xml, shapes_ == Shapes::kCollision, link);
    });
    for_each_child(element, "visual", [&](const tinyxml2::XMLElement& xml) {
      const auto* const geometry = xml.FirstChildElement("geometry");
      survey_.visual_meshes +=
          geometry != nullptr && geometry->FirstChildElement("mesh") != nullptr;
      if (shapes_ == Shapes::kVisualWhereNoCollision && !has_collision)
        add_shape(Element(xml, file_, owner), xml, true, link);
      if (shapes_ != Shapes::kVisual) return;
      try {
        add_shape(Element(xml, file_, owner), xml, true, link);
      } catch (const InputError& error) {
        unread_.emplace_back(error.what());
      }
    });
    model_->links.push_back(std::move(link));
  }

  /// Reads a shape, and adds it to the link if it is `wanted`. An unwanted shape is checked too,
  /// except that of a mesh only the name is looked up.
  void add_shape(const Element& element, const tinyxml2::XMLElement& xml, bool wanted, Link& link) {
    if (++shape_count_ > kMostShapes)
      element.fail("too many collision shapes",
                   "at most " + std::to_string(kMostShapes) + " of a robot");
    PlacedShape placed;
    placed.pose = element.origin();
    const auto* const geometry = xml.FirstChildElement("geometry");
    const auto* const kind = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (kind == nullptr)
      element.fail("no geometry", "a <geometry> with a box, sphere, cylinder, capsule or mesh");
    if (const auto* const other = kind->NextSiblingElement())
      element.with(*other).fail(
          std::string("a second shape <") + other->Name() + "> in one <geometry>", "one");
    const Element shape = element.with(*kind);
    const std::string_view name = kind->Name();
    if (name == "sphere")
      placed.shape = Sphere{shape.length("radius")};
    else if (name == "box")
      placed.shape = Box{shape.lengths("size")};
    else if (name == "cylinder")
      placed.shape = Cylinder{shape.length("radius"), shape.length("length")};
    else if (name == "capsule")
      placed.shape = Capsule{shape.length("radius"), shape.length("length")};
    else if (!read_mesh(shape, wanted, placed.shape))
      return;
    if (wanted) link.collision.push_back(std::move(placed));
  }

  /// Reads a mesh. Returns whether there is one to place.
  bool read_mesh(const Element& element, bool wanted, Shape& shape) {
    const Vector3d scale =
        element.has("scale") ? Vector3d(element.numbers<3>("scale")) : Vector3d::Ones();
    const std::string name = element.text("filename");
    try {
      const std::filesystem::path file =
          resolve_mesh_name(name, source_.file, packages_, element.where());
      if (!wanted) return false;
      try {
        shape = load_mesh(file, scale, meshes_);
      } catch (const InputError& error) {
        throw InputError(element.where() + ": " + error.what());
      }
    } catch (const InputError& error) {
      if (wanted) throw;
      survey_.missing_meshes.emplace_back(error.what());
      return false;
    }
    return true;
  }

  void add_joint(const tinyxml2::XMLElement& xml, const std::string& owner) {
    const Element element(xml, file_, owner);
    Joint joint;
    joint.name = xml.Attribute("name");
    joint.line = xml.GetLineNum();
    joint.type = type(element);
    joint.parent_link = links_.at(end_of(xml, "parent"));
    joint.child_link = links_.at(end_of(xml, "child"));
    joint.origin = element.origin();
    if (joint.movable()) {
      if (const auto* const axis = xml.FirstChildElement("axis")) {
        const Element at = element.with(*axis);
        const Vector3d direction = at.numbers<3>("xyz");
        const double length = direction.norm();
        if (!(length > 1e-9) || !std::isfinite(length))
          at.fail("axis has no direction", "an axis of positive length");
        joint.axis = direction / length;
      }
      const auto* const limit = xml.FirstChildElement("limit");
      if (limit != nullptr)
        read_limits(element.with(*limit), joint);
      else if (joint.type != Joint::Type::kContinuous)
        element.fail("no <limit>", "a <limit> with lower and upper");
      if (const auto* const safety = xml.FirstChildElement("safety_controller"))
        read_soft_limits(element.with(*safety), joint);
    }
    model_->joints.push_back(std::move(joint));
  }

  Joint::Type type(const Element& element) {
    const std::string name = element.has("type") ? element.text("type") : "";
    if (name == "fixed") return Joint::Type::kFixed;
    if (name == "revolute") return Joint::Type::kRevolute;
    if (name == "continuous") return Joint::Type::kContinuous;
    if (name == "prismatic") return Joint::Type::kPrismatic;
    if (name == "floating" || name == "planar") {
      warnings_.add(element.where(), "is " + name + ": it is held at its origin");
      return Joint::Type::kFree;
    }
    element.fail(name.empty() ? "no joint type" : "unknown joint type '" + name + "'",
                 "fixed, revolute, continuous, prismatic, floating or planar");
  }

  /// Reads the limits of a joint. The rates of URDF 1.2 (acceleration, deceleration, jerk) count
  /// whatever version the file states. Swivel does not distinguish speeding up from slowing down,
  /// so that the smaller of acceleration and deceleration holds for both. A rate of 0 or infinity
  /// is no limit.
  void read_limits(const Element& limit, Joint& joint) {
    const auto rate = [&](const char* name, bool zero) {
      if (!limit.has(name)) return 0.0;
      const double value = limit.number(name, true);
      if (!(value > 0 || (zero && value == 0)))
        limit.fail(std::string("limit ") + name + " is " + format_double(value),
                   zero ? "a number >= 0" : "a number > 0");
      return std::isinf(value) ? 0.0 : value;
    };
    joint.velocity = rate("velocity", true);
    joint.acceleration = rate("acceleration", false);
    if (const double slowing = rate("deceleration", false); slowing > 0)
      joint.acceleration = joint.acceleration > 0 ? std::min(joint.acceleration, slowing) : slowing;
    joint.jerk = rate("jerk", false);
    const double lower = limit.number_or("lower", 0), upper = limit.number_or("upper", 0);
    if (!(lower <= upper)) limit.fail("limit lower is above upper", "lower <= upper");
    if (joint.type != Joint::Type::kContinuous) {
      joint.lower = lower;
      joint.upper = upper;
    } else if (lower < upper) {
      warnings_.add(limit.where(), "is continuous: its limits from " + format_double(lower) +
                                       " to " + format_double(upper) +
                                       " are not kept, a revolute joint's would be");
    }
  }

  /// Reads the soft limits of a <safety_controller>. If it states neither, as where it bounds the
  /// velocity alone, they do not bound the joint; if it states one, the other is 0.
  void read_soft_limits(const Element& safety, Joint& joint) {
    if (!safety.has("soft_lower_limit") && !safety.has("soft_upper_limit")) return;
    const double lower = safety.number_or("soft_lower_limit", 0),
                 upper = safety.number_or("soft_upper_limit", 0);
    if (!(lower <= upper))
      safety.fail("soft_lower_limit is above soft_upper_limit", "lower <= upper");
    if (!options_.soft_limits) return;
    if (joint.type == Joint::Type::kContinuous) {
      warnings_.add(safety.where(), "is continuous: its soft limits are not kept");
      return;
    }
    const Joint::Range hard{joint.lower, joint.upper};
    joint.lower = std::max(joint.lower, lower);
    joint.upper = std::min(joint.upper, upper);
    if (!(joint.lower <= joint.upper))
      safety.fail("soft limits lie outside of the <limit>",
                  "limits that overlap, or `limits.soft_limits: false`");
    if (joint.lower != hard.lower || joint.upper != hard.upper) joint.hard = hard;
  }

  void add_mimic(const tinyxml2::XMLElement& xml, const std::string& owner) {
    const auto* const child = xml.FirstChildElement("mimic");
    Joint& joint = model_->joints[static_cast<std::size_t>(joints_.at(xml.Attribute("name")))];
    if (child == nullptr || !joint.movable()) return;
    const Element mimic(*child, file_, owner);
    const std::string name = mimic.text("joint");
    const double multiplier = mimic.number_or("multiplier", 1),
                 offset = mimic.number_or("offset", 0);
    const auto found = joints_.find(name);
    if (found == joints_.end())
      mimic.fail(left_out_.contains(name)
                     ? "mimics joint '" + name + "', which robot.without leaves out"
                     : "mimics unknown joint '" + name + "'",
                 "the name of another joint");
    const int leader = found->second;
    // A leader may come later in the file than its follower, so follow the chain as far as it is
    // known.
    for (int k = leader; k >= 0;) {
      const Joint& next = model_->joints[static_cast<std::size_t>(k)];
      if (&next == &joint) mimic.fail("mimics itself", "the name of another joint");
      k = next.mimic ? next.mimic->joint : -1;
    }
    joint.mimic = Joint::Mimic{leader, multiplier, offset};
  }

  struct Up {
    std::string parent;
    const tinyxml2::XMLElement* joint;
    int walk = -1;  ///< number of the walk towards the root that came here first
  };

  const XmlSource& source_;
  const std::string file_;
  const Packages& packages_;
  const RobotOptions& options_;
  const Shapes shapes_;
  std::shared_ptr<RobotModel> model_ = std::make_shared<RobotModel>();
  MeshCache meshes_;
  std::size_t shape_count_ = 0;
  Index links_, joints_;                          ///< index of each in the model
  std::map<std::string, Up, std::less<>> up_of_;  ///< parent of each link but the root
  std::string root_;
  std::set<std::string> left_out_;
  XmlWarnings warnings_;
  ShapeSurvey survey_;
  std::vector<std::string> unread_;
};

std::shared_ptr<const RobotModel> with_srdf(UrdfRobot robot, const RobotOptions& options,
                                            const std::optional<XmlSource>& srdf) {
  keep_limits(options, *robot.model);
  if (srdf) load_srdf(*srdf, *robot.model, robot.left_out);
  return robot.model;
}

}  // namespace

UrdfRobot load_urdf(const std::filesystem::path& urdf, const Packages& packages,
                    const RobotOptions& options) {
  const XmlSource source{urdf};
  return ModelBuilder(source, packages, options).build();
}

std::shared_ptr<const RobotModel> load_kinematics(const std::filesystem::path& urdf,
                                                  const std::filesystem::path& srdf,
                                                  const Packages& packages,
                                                  const RobotOptions& options,
                                                  ShapeSurvey& shapes) {
  const XmlSource source{urdf};
  ModelBuilder builder(source, packages, options, Shapes::kNone);
  UrdfRobot robot = builder.build();
  shapes = builder.survey();
  return with_srdf(std::move(robot), options,
                   srdf.empty() ? std::nullopt : std::optional(XmlSource{srdf}));
}

std::shared_ptr<const RobotModel> load_visual_shapes(const std::filesystem::path& urdf,
                                                     const Packages& packages) {
  const XmlSource source{urdf};
  const RobotOptions options;
  return ModelBuilder(source, packages, options, Shapes::kVisualWhereNoCollision).build().model;
}

VisualRobot load_visuals(const RobotModel& robot) {
  const ModelFiles& files = robot.files;
  if (files.urdf.empty()) return {};
  const Packages packages(files.packages.begin(), files.packages.end());
  const XmlSource source{files.urdf};
  const RobotOptions options{.without = files.without};
  try {
    ModelBuilder builder(source, packages, options, Shapes::kVisual);
    const UrdfRobot shown = builder.build();
    VisualRobot visual{shown.model, builder.unread()};
    for (std::string& message : visual.left_out)  // names the file as other messages do
      if (message.starts_with(files.urdf)) message.replace(0, files.urdf.size(), robot.source);
    return visual;
  } catch (const InputError&) {
    return {};
  }
}

std::shared_ptr<const RobotModel> load_robot(const std::filesystem::path& urdf,
                                             const std::filesystem::path& srdf,
                                             const Packages& packages,
                                             const RobotOptions& options) {
  return with_srdf(load_urdf(urdf, packages, options), options,
                   srdf.empty() ? std::nullopt : std::optional(XmlSource{srdf}));
}

std::shared_ptr<const RobotModel> parse_robot(const std::string& urdf, const std::string& srdf,
                                              const Packages& packages,
                                              const RobotOptions& options) {
  const XmlSource source{"URDF text", urdf};
  return with_srdf(ModelBuilder(source, packages, options).build(), options,
                   srdf.empty() ? std::nullopt : std::optional(XmlSource{"SRDF text", srdf}));
}

}  // namespace swivel::io
