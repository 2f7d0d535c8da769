// SPDX-License-Identifier: BSD-3-Clause
#include "urdf.hpp"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <mutex>
#include <string_view>

#include "bad_input.hpp"
#include "files.hpp"
#include "srdf.hpp"
#include "swivel/core/bounds.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/io/io.hpp"
#include "text_number.hpp"
#include "xml.hpp"

namespace swivel::io {

namespace {

constexpr std::size_t kMostLinks = 10'000;  // the largest real ones have hundreds
constexpr std::size_t kMostShapes = 10'000;

/// Collects what urdfdom would print to stderr.
class MessageCollector : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    text_ += (text_.empty() ? "" : "; ") + text;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string replaced(std::string_view text, std::string_view what, std::string_view by) {
  std::string result;
  for (std::size_t at; (at = text.find(what)) != std::string_view::npos; text.remove_prefix(at + what.size()))
    result.append(text.substr(0, at)).append(by);
  return result.append(text);
}

constexpr std::string_view kPercent = "\xEE\x80\xA5";  // U+E025, which no file has a use for

urdf::ModelInterfaceSharedPtr parse_quietly(const std::string& xml, const std::string& file) {
  static std::mutex one_at_a_time;  // console_bridge has one output handler for the whole process
  const std::lock_guard lock(one_at_a_time);
  MessageCollector messages;
  console_bridge::useOutputHandler(&messages);
  urdf::ModelInterfaceSharedPtr model;
  std::string thrown;
  const console_bridge::LogLevel level = console_bridge::getLogLevel();
  try {
    // It hands text of the file to printf as a format: what is wrong is said of one without '%'.
    model = urdf::parseURDF(replaced(xml, "%", kPercent));
    if (model && xml.find('%') != std::string::npos) {
      console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
      model = urdf::parseURDF(xml);
    }
  } catch (const std::exception& error) {
    thrown = error.what();
  }
  console_bridge::setLogLevel(level);
  console_bridge::restorePreviousOutputHandler();
  // A complaint counts even where urdfdom goes on: it drops collision geometry that it cannot read.
  if (!model || !messages.text().empty())
    bad_input(file, "not a valid robot (" + replaced(thrown.empty() ? messages.text() : thrown, kPercent, "%") + ")",
              "a URDF 1.0 robot, xacro expanded");
  return model;
}

/// Removes comments, text and the like, at any depth: printed and read again they may turn into something else.
void keep_elements(tinyxml2::XMLElement& element) {
  for (tinyxml2::XMLNode* child = element.FirstChild(); child != nullptr;) {
    tinyxml2::XMLNode* const next = child->NextSibling();
    if (tinyxml2::XMLElement* const inner = child->ToElement())
      keep_elements(*inner);
    else
      element.DeleteChild(child);
    child = next;
  }
}

/// Removes children that are not in `kept`.
void keep_children(tinyxml2::XMLElement& element, std::initializer_list<std::string_view> kept) {
  for (tinyxml2::XMLNode* child = element.FirstChild(); child != nullptr;) {
    tinyxml2::XMLNode* const next = child->NextSibling();
    const tinyxml2::XMLElement* const child_element = child->ToElement();
    if (child_element == nullptr || std::find(kept.begin(), kept.end(), child_element->Name()) == kept.end())
      element.DeleteChild(child);
    child = next;
  }
}

/// Calls `visit` for every child element of that name.
template <class Visit>
void for_each_child(tinyxml2::XMLElement& element, const char* name, const Visit& visit) {
  for (auto* child = element.FirstChildElement(name); child != nullptr; child = child->NextSiblingElement(name)) visit(*child);
}

/// Leaves only what a planner reads: urdfdom rejects whole files for materials used twice or an odd inertia, and older ones for
/// version 1.2, whose limits of acceleration and jerk are read here.
void strip(tinyxml2::XMLElement& robot) {
  robot.DeleteAttribute("version");
  keep_children(robot, {"link", "joint"});
  for_each_child(robot, "link", [](tinyxml2::XMLElement& link) {
    keep_children(link, {"collision"});
    for_each_child(link, "collision", [](tinyxml2::XMLElement& collision) { keep_children(collision, {"origin", "geometry"}); });
  });
  for_each_child(robot, "joint", [](tinyxml2::XMLElement& joint) {
    keep_children(joint, {"parent", "child", "origin", "axis", "limit", "mimic"});
    for_each_child(joint, "limit", [](tinyxml2::XMLElement& limit) {
      for (const char* name : {"effort", "velocity"})  // urdfdom insists on both; a planner can do without
        if (limit.Attribute(name) == nullptr) limit.SetAttribute(name, "0");
    });
  });
}

Vector3d to_eigen(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Pose origin(const urdf::Pose& pose, const std::string& at) {
  Pose result = Pose::Identity();
  result.translation() = to_eigen(pose.position);
  const urdf::Rotation& r = pose.rotation;
  result.linear() = Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
  if (!(result.translation().array().abs() <= kMostMetres).all() || !result.linear().allFinite())
    bad_input(at, "origin is not finite or too far away", "numbers, those of xyz from -1000 to 1000");
  return result;
}

/// Turns urdfdom's model into ours, in the order of the file, and checks what urdfdom leaves unchecked.
class ModelBuilder {
 public:
  /// With `missing_meshes` links get no shapes, and the names of meshes are looked up alone.
  ModelBuilder(const XmlSource& source, const Packages& packages, std::vector<std::string>* missing_meshes)
      : source_(source), urdf_(source.file), packages_(packages), missing_meshes_(missing_meshes) {}

  std::shared_ptr<RobotModel> build() {
    tinyxml2::XMLDocument document;
    tinyxml2::XMLElement& robot = load_robot_xml(source_, "URDF", document);
    strip(robot);
    keep_elements(robot);
    check_name(robot);
    check_names(robot, "link", links_);
    check_names(robot, "joint", joints_);
    check_tree(robot);
    tinyxml2::XMLPrinter printer(nullptr, true);
    robot.Accept(&printer);  // alone: what stands around it may read otherwise once it is printed
    parsed_ = parse_quietly(printer.CStr(), urdf_.string());
    model_->name = parsed_->getName();
    model_->source = urdf_.string();
    for_each_child(robot, "link", [&](tinyxml2::XMLElement& element) { add_link(element); });
    for_each_child(robot, "joint", [&](tinyxml2::XMLElement& element) { add_joint(element); });
    for_each_child(robot, "joint", [&](tinyxml2::XMLElement& element) { add_mimic(element); });
    model_->root_link = links_.at(parsed_->getRoot()->name);
    return model_;
  }

 private:
  [[nodiscard]] std::string where(const tinyxml2::XMLElement& element) const {
    return at_line(urdf_.string(), element.GetLineNum()) + ": " + element.Name() + " '" + element.Attribute("name") + "'";
  }

  void check_name(const tinyxml2::XMLElement& element) const {
    const char* const name = element.Attribute("name");
    if (name == nullptr || !is_valid_name(name))
      bad_input(
          at_line(urdf_.string(), element.GetLineNum()),
          std::string("<") + element.Name() + "> " + (name == nullptr ? "has no name" : "has the name '" + std::string(name) + "'"),
          kValidName);
  }

  /// urdfdom drops a link without a name and goes on. `index`: where each will stand in the model.
  void check_names(tinyxml2::XMLElement& robot, const char* kind, std::map<std::string, int, std::less<>>& index) const {
    for_each_child(robot, kind, [&](const tinyxml2::XMLElement& element) {
      check_name(element);
      if (!index.emplace(element.Attribute("name"), static_cast<int>(index.size())).second)
        bad_input(where(element), "name is taken", "a name of its own");
      if (index.size() > kMostLinks)
        bad_input(where(element), "too many of its kind", "at most " + std::to_string(kMostLinks) + " links and joints");
    });
  }

  /// urdfdom takes a link with two parents, and loops that hang on nothing. What is left to it is that there is one root.
  void check_tree(tinyxml2::XMLElement& robot) const {
    struct Up {
      std::string parent;
      const tinyxml2::XMLElement* joint;
      int walk = -1;  ///< which walk towards the root came here first
    };
    std::map<std::string, Up, std::less<>> up_of;  // by child
    for_each_child(robot, "joint", [&](tinyxml2::XMLElement& element) {
      const auto link = [&](const char* kind) -> std::string {
        const auto* const end = element.FirstChildElement(kind);
        const char* const name = end == nullptr ? nullptr : end->Attribute("link");
        return name == nullptr ? "" : name;
      };
      const std::string child = link("child");
      if (!up_of.emplace(child, Up{link("parent"), &element}).second)
        bad_input(where(element), "link '" + child + "' has another parent joint already", "a tree: one parent joint a link");
    });
    int walk = 0;
    for (auto& [child, start] : up_of) {
      std::string_view link = child;
      for (auto up = up_of.find(link); up != up_of.end(); up = up_of.find(link)) {
        if (up->second.walk == walk)
          bad_input(where(*up->second.joint), "closes a loop at link '" + up->first + "'", "a tree: no link above itself");
        if (up->second.walk >= 0) break;
        up->second.walk = walk;
        link = up->second.parent;
      }
      ++walk;
    }
  }

  void add_link(const tinyxml2::XMLElement& element) {
    Link link;
    link.name = element.Attribute("name");
    for (const urdf::CollisionSharedPtr& collision : parsed_->getLink(link.name)->collision_array) {
      if (++shapes_ > kMostShapes)
        bad_input(where(element), "too many collision shapes", "at most " + std::to_string(kMostShapes) + " of a robot");
      if (missing_meshes_ != nullptr) {
        look_up_mesh(*collision->geometry, where(element));
        continue;
      }
      link.collision.push_back({shape(*collision->geometry, where(element)), origin(collision->origin, where(element))});
    }
    model_->links.push_back(std::move(link));
  }

  void look_up_mesh(const urdf::Geometry& geometry, const std::string& at) const {
    if (geometry.type != urdf::Geometry::MESH) return;
    try {
      static_cast<void>(resolve_mesh_name(static_cast<const urdf::Mesh&>(geometry).filename, urdf_, packages_, at));
    } catch (const InputError& error) {
      missing_meshes_->push_back(error.what());
    }
  }

  Shape shape(const urdf::Geometry& geometry, const std::string& at) {
    const auto positive = [&](double length, const char* what) {
      if (!(length > 0 && length <= kMostMetres)) bad_input(at, std::string(what) + " is " + format_double(length), kLengthAllowed);
      return length;
    };
    switch (geometry.type) {
      case urdf::Geometry::SPHERE:
        return Sphere{positive(static_cast<const urdf::Sphere&>(geometry).radius, "sphere radius")};
      case urdf::Geometry::BOX: {
        const Vector3d size = to_eigen(static_cast<const urdf::Box&>(geometry).dim);
        for (const double length : size) positive(length, "box size");
        return Box{size};
      }
      case urdf::Geometry::CYLINDER: {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        return Cylinder{positive(cylinder.radius, "cylinder radius"), positive(cylinder.length, "cylinder length")};
      }
      case urdf::Geometry::MESH: {
        const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
        const std::filesystem::path file = resolve_mesh_name(mesh.filename, urdf_, packages_, at);
        try {
          return load_mesh(file, to_eigen(mesh.scale), meshes_);
        } catch (const InputError& error) {
          throw InputError(at + ": " + error.what());
        }
      }
    }
    bad_input(at, "unknown geometry", "box, sphere, cylinder or mesh");
  }

  void add_joint(const tinyxml2::XMLElement& element) {
    const urdf::Joint& parsed = *parsed_->getJoint(element.Attribute("name"));
    const std::string at = where(element);
    Joint joint;
    joint.name = parsed.name;
    joint.type = type(parsed, at);
    joint.parent_link = links_.at(parsed.parent_link_name);
    joint.child_link = links_.at(parsed.child_link_name);
    joint.origin = origin(parsed.parent_to_joint_origin_transform, at);
    if (joint.movable()) {
      const double length = to_eigen(parsed.axis).norm();
      if (!(length > 1e-9)) bad_input(at, "axis is zero", "an axis of positive length on a joint that moves");
      joint.axis = to_eigen(parsed.axis) / length;
      read_limits(parsed, at, joint);
      read_rates(element, at, joint);
    }
    model_->links[joint.child_link].parent_joint = static_cast<int>(model_->joints.size());
    model_->joints.push_back(std::move(joint));
  }

  static Joint::Type type(const urdf::Joint& parsed, const std::string& at) {
    switch (parsed.type) {
      case urdf::Joint::FIXED:
        return Joint::Type::kFixed;
      case urdf::Joint::REVOLUTE:
        return Joint::Type::kRevolute;
      case urdf::Joint::CONTINUOUS:
        return Joint::Type::kContinuous;
      case urdf::Joint::PRISMATIC:
        return Joint::Type::kPrismatic;
      default:
        bad_input(at,
                  parsed.type == urdf::Joint::FLOATING ? "floating joint"
                  : parsed.type == urdf::Joint::PLANAR ? "planar joint"
                                                       : "unknown joint type",
                  "fixed, revolute, continuous or prismatic");
    }
  }

  static void read_limits(const urdf::Joint& parsed, const std::string& at, Joint& joint) {
    if (!parsed.limits) {
      if (joint.type != Joint::Type::kContinuous) bad_input(at, "no <limit>", "a <limit> with lower and upper");
      return;
    }
    joint.velocity = parsed.limits->velocity;
    if (!(joint.velocity >= 0)) bad_input(at, "limit velocity is negative", "a number >= 0");
    if (joint.type == Joint::Type::kContinuous) return;
    joint.lower = parsed.limits->lower;
    joint.upper = parsed.limits->upper;
    if (!(joint.lower <= joint.upper)) bad_input(at, "limit lower is above upper", "lower <= upper");
  }

  /// Attributes of URDF 1.2, whatever version the file says it is. What slows down a joint is not told from what speeds it up: the
  /// smaller of acceleration and deceleration holds for both.
  static void read_rates(const tinyxml2::XMLElement& element, const std::string& at, Joint& joint) {
    const auto* const limit = element.FirstChildElement("limit");
    if (limit == nullptr) return;
    const auto rate = [&](const char* name) {
      const char* const text = limit->Attribute(name);
      if (text == nullptr) return 0.0;
      const auto value = to_number<double>(text);
      if (!value || !(*value > 0)) bad_input(at, std::string("limit ") + name + " is '" + text + "'", "a number > 0");
      return std::isinf(*value) ? 0.0 : *value;
    };
    joint.acceleration = rate("acceleration");
    if (const double slowing = rate("deceleration"); slowing > 0)
      joint.acceleration = joint.acceleration > 0 ? std::min(joint.acceleration, slowing) : slowing;
    joint.jerk = rate("jerk");
  }

  void add_mimic(const tinyxml2::XMLElement& element) {
    const std::string name = element.Attribute("name");
    const urdf::JointMimicSharedPtr& mimic = parsed_->getJoint(name)->mimic;
    Joint& joint = model_->joints[joints_.at(name)];
    if (!mimic || !joint.movable()) return;
    const auto found = joints_.find(mimic->joint_name);
    if (found == joints_.end())
      bad_input(where(element), "mimics unknown joint '" + mimic->joint_name + "'", "the name of another joint");
    const int leader = found->second;
    // Leaders come before or after in the file, so follow the chain as far as it is known.
    for (int k = leader; k >= 0;) {
      const Joint& next = model_->joints[k];
      if (&next == &joint) bad_input(where(element), "mimics itself", "the name of another joint");
      k = next.mimic ? next.mimic->joint : -1;
    }
    joint.mimic = Joint::Mimic{leader, mimic->multiplier, mimic->offset};
  }

  const XmlSource& source_;
  const std::filesystem::path& urdf_;
  const Packages& packages_;
  std::vector<std::string>* missing_meshes_;
  urdf::ModelInterfaceSharedPtr parsed_;
  std::shared_ptr<RobotModel> model_ = std::make_shared<RobotModel>();
  MeshCache meshes_;
  std::size_t shapes_ = 0;
  std::map<std::string, int, std::less<>> links_, joints_;  ///< where each stands in the model
};

}  // namespace

std::shared_ptr<RobotModel> load_urdf(const std::filesystem::path& urdf, const Packages& packages) {
  const XmlSource source{urdf};
  return ModelBuilder(source, packages, nullptr).build();
}

std::shared_ptr<const RobotModel> load_kinematics(const std::filesystem::path& urdf,
                                                  const std::map<std::string, std::filesystem::path>& packages,
                                                  std::vector<std::string>& missing_meshes) {
  const XmlSource source{urdf};
  return ModelBuilder(source, packages, &missing_meshes).build();
}

std::shared_ptr<const RobotModel> load_robot(const std::filesystem::path& urdf, const std::filesystem::path& srdf,
                                             const std::map<std::string, std::filesystem::path>& packages) {
  const std::shared_ptr<RobotModel> robot = load_urdf(urdf, packages);
  if (!srdf.empty()) load_srdf({srdf}, *robot);
  return robot;
}

std::shared_ptr<const RobotModel> parse_robot(const std::string& urdf, const std::string& srdf,
                                              const std::map<std::string, std::filesystem::path>& packages) {
  const XmlSource source{"URDF text", urdf};
  const std::shared_ptr<RobotModel> robot = ModelBuilder(source, packages, nullptr).build();
  if (!srdf.empty()) load_srdf({"SRDF text", srdf}, *robot);
  return robot;
}

}  // namespace swivel::io
