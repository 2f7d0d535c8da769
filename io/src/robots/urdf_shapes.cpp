// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>

#include "files/csv.hpp"
#include "files/xml.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"

namespace swivel::io {

namespace {

std::string numbers(const Vector3d& v) {
  return csv_number(v.x()) + " " + csv_number(v.y()) + " " + csv_number(v.z());
}

/// Writes collision shapes into a link, one after the other.
class ShapeWriter {
 public:
  /// Writes into `link`, after the element `after`.
  ShapeWriter(tinyxml2::XMLElement& link, tinyxml2::XMLElement& after)
      : link_(link), last_(&after) {}

  void add(const PlacedShape& placed) {
    if (const auto* sphere = std::get_if<Sphere>(&placed.shape))
      return add_sphere(placed.pose.translation(), sphere->radius);
    const auto* capsule = std::get_if<Capsule>(&placed.shape);
    if (capsule == nullptr)
      throw std::logic_error("urdf_with_shapes: a shape that is no sphere or capsule");
    const Vector3d axis = placed.pose.linear().col(2);
    const double pitch = std::atan2(std::hypot(axis.x(), axis.y()), axis.z()),
                 yaw = std::atan2(axis.y(), axis.x());
    tinyxml2::XMLElement& cylinder =
        add_shape("cylinder", placed.pose.translation(), Vector3d(0, pitch, yaw));
    cylinder.SetAttribute("radius", csv_number(capsule->radius).c_str());
    cylinder.SetAttribute("length", csv_number(capsule->length).c_str());
    for (const double side : {-1.0, 1.0})
      add_sphere(placed.pose.translation() + side * capsule->length / 2 * axis, capsule->radius);
  }

  /// Adds a visual shape as a collision shape.
  void copy(const tinyxml2::XMLElement& visual) {
    tinyxml2::XMLElement& collision = add_collision();
    for (const char* part : {"origin", "geometry"})
      if (const auto* const child = visual.FirstChildElement(part))
        collision.InsertEndChild(child->DeepClone(link_.GetDocument()));
  }

 private:
  void add_sphere(const Vector3d& centre, double radius) {
    add_shape("sphere", centre, Vector3d::Zero())
        .SetAttribute("radius", csv_number(radius).c_str());
  }
  tinyxml2::XMLElement& add_collision() {
    last_ =
        link_.InsertAfterChild(last_, link_.GetDocument()->NewElement("collision"))->ToElement();
    return *last_;
  }
  tinyxml2::XMLElement& add_shape(const char* kind, const Vector3d& xyz, const Vector3d& rpy) {
    tinyxml2::XMLElement* const collision = &add_collision();
    tinyxml2::XMLElement* const origin = collision->InsertNewChildElement("origin");
    origin->SetAttribute("xyz", numbers(xyz).c_str());
    origin->SetAttribute("rpy", numbers(rpy).c_str());
    return *collision->InsertNewChildElement("geometry")->InsertNewChildElement(kind);
  }

  tinyxml2::XMLElement& link_;
  tinyxml2::XMLElement* last_;
};

/// Rewrites the relative mesh names of a link for another folder.
void move_names(tinyxml2::XMLElement& link, const std::filesystem::path& from,
                const std::filesystem::path& to) {
  for (const char* kind : {"visual", "collision"})
    for (auto* shape = link.FirstChildElement(kind); shape != nullptr;
         shape = shape->NextSiblingElement(kind)) {
      auto* const geometry = shape->FirstChildElement("geometry");
      auto* const mesh = geometry == nullptr ? nullptr : geometry->FirstChildElement("mesh");
      const char* const name = mesh == nullptr ? nullptr : mesh->Attribute("filename");
      if (name == nullptr || std::string_view(name).find("://") != std::string_view::npos) continue;
      const std::filesystem::path file(name);
      if (file.is_relative())
        mesh->SetAttribute("filename", std::filesystem::proximate(from / file, to).c_str());
    }
}

}  // namespace

std::string urdf_with_shapes(const std::filesystem::path& urdf, const ShapesInstead& instead,
                             const std::filesystem::path& folder, ShapesOf of) {
  const bool visual = of == ShapesOf::kVisual;
  const char* const kind = visual ? "visual" : "collision";
  tinyxml2::XMLDocument document;
  tinyxml2::XMLElement& robot = load_robot_xml({urdf}, "URDF", document);
  const std::filesystem::path from = std::filesystem::weakly_canonical(urdf).parent_path(),
                              to = std::filesystem::weakly_canonical(folder.empty() ? "." : folder);
  for (auto* link = robot.FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    const char* const name = link->Attribute("name");
    if (from != to) move_names(*link, from, to);
    const auto shapes = instead.find(name == nullptr ? "" : name);
    if (shapes == instead.end()) continue;
    tinyxml2::XMLElement* element = link->FirstChildElement(kind);
    for (const auto& others : shapes->second) {
      if (element == nullptr) break;
      tinyxml2::XMLElement* const next = element->NextSiblingElement(kind);
      ShapeWriter writer(*link, *element);
      if (visual && others.empty()) writer.copy(*element);
      for (const PlacedShape& other : others) writer.add(other);
      if (!visual && !others.empty()) link->DeleteChild(element);
      element = next;
    }
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace swivel::io
