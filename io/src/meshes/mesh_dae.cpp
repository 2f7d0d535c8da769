// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <string_view>

#include "files/bad_input.hpp"
#include "files/text_number.hpp"
#include "files/xml.hpp"
#include "meshes/mesh_file.hpp"

namespace swivel::io {

namespace {

using Element = tinyxml2::XMLElement;
using Eigen::Affine3d;

/// Reads COLLADA 1.4 and 1.5: the triangles and polygons that the scene shows. Names of elements
/// are those of the specification.
class DaeReader {
 public:
  DaeReader(const MeshFile& file, const PlaceSurface& place) : file_(file), place_(place) {}

  void read() {
    parse_xml(file_.name, file_.text, "COLLADA", "COLLADA", document_);
    const Element& root = *document_.RootElement();
    index(root);
    double unit = 1;
    if (const Element* asset = root.FirstChildElement("asset"))
      if (const Element* element = asset->FirstChildElement("unit"))
        if (const char* meter = element->Attribute("meter")) {
          const auto value = to_number<double>(meter);
          if (!value || !(*value > 0) || !std::isfinite(*value))
            fail(*element, "meter is '" + std::string(meter) + "'", "a number > 0");
          unit = *value;
        }
    const Element* scene = root.FirstChildElement("scene");
    const Element* instance =
        scene == nullptr ? nullptr : scene->FirstChildElement("instance_visual_scene");
    if (instance == nullptr) fail(root, "shows no scene", "a <scene> with <instance_visual_scene>");
    place_node(target(*instance, "url", "visual_scene"), Affine3d(Eigen::Scaling(unit)), 0);
  }

 private:
  [[noreturn]] void fail(const Element& at, const std::string& what,
                         const std::string& allowed) const {
    file_.fail(at.GetLineNum(), std::string("<") + at.Name() + "> " + what, allowed);
  }

  /// Collects the elements that have an id. The parser bounds the depth of the recursion.
  void index(const Element& element) {
    if (const char* id = element.Attribute("id")) by_id_.emplace(id, &element);
    for (auto* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement())
      index(*child);
  }

  /// Returns the element that an attribute of the form "#id" names. Throws InputError if there is
  /// none of this name.
  const Element& target(const Element& from, const char* attribute, std::string_view name) const {
    const char* const url = from.Attribute(attribute);
    const auto found =
        url == nullptr || *url != '#' ? by_id_.end() : by_id_.find(std::string_view(url + 1));
    if (found == by_id_.end() || (!name.empty() && found->second->Name() != name))
      fail(from, std::string(attribute) + " is '" + (url == nullptr ? "" : url) + "'",
           "'#' and the id of a " + std::string(name.empty() ? "source" : name) + " of this file");
    return *found->second;
  }

  std::vector<double> numbers(const Element& element) const {
    std::vector<double> values;
    const char* const text = element.GetText();
    Words words(text == nullptr ? "" : text, element.GetLineNum());
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      const auto value = to_number<double>(word);
      if (!value || !std::isfinite(*value))
        fail(element, "holds '" + std::string(word) + "'", "finite numbers");
      values.push_back(*value);
    }
    return values;
  }

  Affine3d transform(const Element& element, std::string_view name) const {
    const std::vector<double> x = numbers(element);
    const std::size_t count = name == "matrix" ? 16 : name == "rotate" ? 4 : 3;
    if (x.size() != count)
      fail(element, "has " + std::to_string(x.size()) + " numbers",
           std::to_string(count) + " numbers");
    if (name == "translate") return Affine3d(Eigen::Translation3d(x[0], x[1], x[2]));
    if (name == "scale") return Affine3d(Eigen::Scaling(x[0], x[1], x[2]));
    if (name == "rotate") {
      const Vector3d axis(x[0], x[1], x[2]);
      if (!(axis.norm() > 0)) return Affine3d::Identity();
      return Affine3d(Eigen::AngleAxisd(x[3] * kPi / 180, axis.normalized()));
    }
    Affine3d result = Affine3d::Identity();
    for (int k = 0; k < 12; ++k) result.matrix()(k / 4, k % 4) = x[k];
    return result;
  }

  /// A part of a <node> or <visual_scene>, in their order: a transform of what follows, a node, or
  /// a surface.
  struct Part {
    Affine3d transform = Affine3d::Identity();
    const Element* node = nullptr;
    const Surface* surface = nullptr;
  };

  /// Returns the parts of a node, which are read once, however often the node is instanced.
  const std::vector<Part>& parts_of(const Element& node) {
    const auto [at, fresh] = parts_.try_emplace(&node);
    std::vector<Part>& parts = at->second;
    if (!fresh) return parts;
    const Element* unread = nullptr;
    for (auto* child = node.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const std::string_view name = child->Name();
      if (name == "matrix" || name == "rotate" || name == "scale" || name == "translate")
        parts.push_back({transform(*child, name)});
      if (name == "lookat" || name == "skew") unread = child;  // cameras have it
      if (name == "node") parts.push_back({.node = child});
      if (name == "instance_node") parts.push_back({.node = &target(*child, "url", "node")});
      if (name != "instance_geometry" && name != "instance_controller") continue;
      if (unread != nullptr) fail(*unread, "of a mesh", "matrix, rotate, scale, translate");
      if (const Element* geometry = geometry_of(*child))
        parts.push_back({.surface = &surface(*geometry)});
    }
    return parts;
  }

  void place_node(const Element& node, Affine3d pose, int depth) {
    constexpr int kMostParts = 300'000, kMostDepth = 200;
    if (depth > kMostDepth)
      fail(node, "is nested too deep, or in itself",
           "at most " + std::to_string(kMostDepth) + " levels");
    for (const Part& part : parts_of(node)) {
      if (++placed_parts_ > kMostParts)
        fail(node, "too many parts, those of instances counted each time",
             "at most " + std::to_string(kMostParts));
      if (part.node != nullptr)
        place_node(*part.node, pose, depth + 1);
      else if (part.surface != nullptr)
        place_(*part.surface, pose);
      else
        pose = pose * part.transform;
    }
  }

  /// Returns the geometry of an instance; for a skin or morph the one that it deforms, as it is
  /// stored. Null if there is none.
  const Element* geometry_of(const Element& instance) const {
    if (std::string_view(instance.Name()) == "instance_geometry")
      return &target(instance, "url", "geometry");
    const Element& controller = target(instance, "url", "controller");
    for (const char* kind : {"skin", "morph"})
      if (const Element* deformed = controller.FirstChildElement(kind))
        return &target(*deformed, "source", "geometry");
    return nullptr;
  }

  const Surface& surface(const Element& geometry) {
    const auto [at, fresh] = surfaces_.try_emplace(&geometry, file_);
    const Element* const mesh = geometry.FirstChildElement("mesh");
    if (!fresh || mesh == nullptr) return at->second;
    // Each <source> of positions is copied once, however many primitives use it.
    std::map<const Element*, std::pair<std::int64_t, std::int64_t>> placed;  // first point, number
    for (auto* child = mesh->FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const std::string_view name = child->Name();
      if (name == "triangles" || name == "polylist" || name == "polygons" || name == "tristrips" ||
          name == "trifans")
        read_faces(*child, name, at->second, placed);
    }
    return at->second;
  }

  /// The inputs of some faces: every `stride` indices of a <p> belong to one corner, and the one at
  /// `offset` names a point of the <source> of positions, which is null if there is none.
  struct Positions {
    std::size_t stride = 0, offset = 0;
    const Element* source = nullptr;
  };

  Positions positions_of(const Element& faces) const {
    Positions found;
    for (auto* input = faces.FirstChildElement("input"); input != nullptr;
         input = input->NextSiblingElement("input")) {
      constexpr std::size_t kMostInputs = 64;
      const std::size_t here = size_attribute(*input, "offset", 0);
      if (here >= kMostInputs)
        fail(*input, "has offset " + std::to_string(here),
             "at most " + std::to_string(kMostInputs - 1));
      found.stride = std::max(found.stride, here + 1);
      const char* const semantic = input->Attribute("semantic");
      if (semantic == nullptr || std::string_view(semantic) != "VERTEX") continue;
      found.offset = here;
      const Element& vertices = target(*input, "source", "vertices");
      for (auto* e = vertices.FirstChildElement("input"); e != nullptr;
           e = e->NextSiblingElement("input"))
        if (const char* s = e->Attribute("semantic");
            s != nullptr && std::string_view(s) == "POSITION")
          found.source = &target(*e, "source", "source");
    }
    return found;
  }

  /// Returns the numbers of corners of the polygons of a <polylist>.
  std::vector<double> polygon_sizes(const Element& faces) const {
    const Element* const vcount = faces.FirstChildElement("vcount");
    if (vcount == nullptr) fail(faces, "has no <vcount>", "<vcount> and <p>");
    std::vector<double> sizes = numbers(*vcount);
    const Element* const p = faces.FirstChildElement("p");
    if (p != nullptr && p->NextSiblingElement("p") != nullptr)
      fail(faces, "has several <p>", "one <p>, whose corners <vcount> counts");
    return sizes;
  }

  /// Reads the points of the surface that a <p> names, whose source has `points` points, from
  /// `first` on of the surface.
  void read_corners(const Element& p, const Positions& positions, std::int64_t first,
                    std::int64_t points, std::vector<std::int64_t>& corners) const {
    corners.clear();
    Words words(p.GetText() == nullptr ? "" : p.GetText(), p.GetLineNum());
    std::size_t k = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++k) {
      const auto value = to_number<std::int64_t>(word);
      if (!value) fail(p, "holds '" + std::string(word) + "'", "whole numbers");
      if (k % positions.stride != positions.offset) continue;
      if (*value < 0 || *value >= points)
        fail(p, "names vertex " + std::to_string(*value) + " of " + std::to_string(points),
             "an index of its source, from 0");
      corners.push_back(first + *value);
    }
    if (k % positions.stride != 0)
      fail(p, "has " + std::to_string(k) + " indices",
           "a multiple of " + std::to_string(positions.stride));
  }

  /// Adds the polygons of a <p> to a surface. Returns how many faces it has, as the attribute
  /// `count` counts them.
  std::size_t add_faces(const Element& faces, std::string_view kind, const Element& p,
                        const std::vector<std::int64_t>& corners, const std::vector<double>& sizes,
                        Surface& surface) const {
    if (kind == "triangles") return add_triangles(faces, p, corners, surface);
    if (kind == "polylist") return add_polygons(faces, p, corners, sizes, surface);
    if (kind == "polygons")
      surface.add_polygon(corners, p.GetLineNum());
    else
      add_strip_or_fan(faces, kind == "tristrips", corners, surface);
    return 1;
  }
  std::size_t add_triangles(const Element& faces, const Element& p,
                            const std::vector<std::int64_t>& corners, Surface& surface) const {
    if (corners.size() % 3 != 0)
      fail(p, "has " + std::to_string(corners.size()) + " corners", "three for each triangle");
    for (std::size_t k = 0; k < corners.size(); k += 3)
      surface.add_polygon(std::span(corners).subspan(k, 3), faces.GetLineNum());
    return corners.size() / 3;
  }
  std::size_t add_polygons(const Element& faces, const Element& p,
                           const std::vector<std::int64_t>& corners,
                           const std::vector<double>& sizes, Surface& surface) const {
    std::size_t next = 0;
    for (const double size : sizes) {
      if (!(size >= 0) || size != std::floor(size) ||
          !(size <= static_cast<double>(corners.size() - next)))
        fail(faces, "has a polygon of more corners than <p> holds",
             "the same number of corners in <vcount> and <p>");
      surface.add_polygon(std::span(corners).subspan(next, size), p.GetLineNum());
      next += size;
    }
    if (next != corners.size())
      fail(p, "has " + std::to_string(corners.size()) + " corners of " + std::to_string(next),
           "as many as <vcount> says");
    return sizes.size();
  }
  void add_strip_or_fan(const Element& faces, bool strip, const std::vector<std::int64_t>& corners,
                        Surface& surface) const {
    const auto add = [&](std::int64_t a, std::int64_t b, std::int64_t c) {
      surface.add_polygon(std::array{a, b, c}, faces.GetLineNum());
    };
    for (std::size_t k = 2; k < corners.size(); ++k) {
      const bool odd = k % 2 != 0;
      if (!strip)
        add(corners[0], corners[k - 1], corners[k]);
      else
        add(corners[odd ? k - 1 : k - 2], corners[odd ? k - 2 : k - 1], corners[k]);
    }
  }

  /// Adds the faces of a <triangles>, <polylist>, <polygons>, <tristrips> or <trifans>, its `kind`,
  /// to a surface, and their points unless they are `placed` already.
  void read_faces(const Element& faces, std::string_view kind, Surface& surface,
                  std::map<const Element*, std::pair<std::int64_t, std::int64_t>>& placed) {
    const Positions positions = positions_of(faces);
    const std::size_t count = size_attribute(faces, "count", 0);
    if (count == 0 && faces.FirstChildElement("p") == nullptr) return;
    const Element* const source = positions.source;
    if (source == nullptr)
      fail(faces, "has no positions", "an input VERTEX with vertices of POSITION");
    if (!placed.contains(source)) placed[source] = read_positions(*source, surface);
    const auto [first, points] = placed[source];
    if (faces.FirstChildElement("ph") != nullptr)
      fail(faces, "has polygons with holes", "polygons without");
    std::vector<double> sizes;
    if (kind == "polylist") sizes = polygon_sizes(faces);
    std::size_t found = 0;
    std::vector<std::int64_t> corners;
    for (auto* p = faces.FirstChildElement("p"); p != nullptr; p = p->NextSiblingElement("p")) {
      read_corners(*p, positions, first, points, corners);
      found += add_faces(faces, kind, *p, corners, sizes, surface);
    }
    if (faces.Attribute("count") != nullptr && found != count)
      fail(faces, "has " + std::to_string(found) + " of " + std::to_string(count),
           "as many as its count says");
  }

  std::size_t size_attribute(const Element& element, const char* name, std::size_t absent) const {
    const char* const text = element.Attribute(name);
    if (text == nullptr) return absent;
    const auto value = to_number<std::uint32_t>(text);
    if (!value) fail(element, std::string(name) + " is '" + text + "'", "a whole number");
    return *value;
  }

  /// Appends the points of a source; returns the index of the first and their number.
  std::pair<std::int64_t, std::int64_t> read_positions(const Element& source, Surface& surface) {
    const Element* const common = source.FirstChildElement("technique_common");
    const Element* const accessor =
        common == nullptr ? nullptr : common->FirstChildElement("accessor");
    if (accessor == nullptr) fail(source, "has no accessor", "<technique_common> with <accessor>");
    const Element& array = target(*accessor, "source", "float_array");
    // read once, however many sources name it
    const auto [found, fresh] = arrays_.try_emplace(&array);
    if (fresh) found->second = numbers(array);
    const std::vector<double>& values = found->second;
    const std::size_t stride = size_attribute(*accessor, "stride", 1),
                      offset = size_attribute(*accessor, "offset", 0),
                      count = size_attribute(*accessor, "count", 0);
    std::array<std::size_t, 3> at{0, 1, 2};
    std::size_t k = 0;
    for (auto* param = accessor->FirstChildElement("param"); param != nullptr;
         param = param->NextSiblingElement("param"), ++k)
      if (const char* name = param->Attribute("name");
          name != nullptr && std::strlen(name) == 1 && *name >= 'X' && *name <= 'Z')
        at[*name - 'X'] = k;
    const std::size_t last = *std::max_element(at.begin(), at.end());
    if (count == 0) return {static_cast<std::int64_t>(surface.points().size()), 0};
    if (stride < 1 || last >= stride || offset + (count - 1) * stride + last >= values.size())
      fail(*accessor, "reads past its array of " + std::to_string(values.size()),
           "count, stride and offset that fit the array, stride 3 or more");
    const auto first = static_cast<std::int64_t>(surface.points().size());
    for (std::size_t n = 0; n < count; ++n) {
      const double* const x = &values[offset + n * stride];
      surface.add_point(x[at[0]], x[at[1]], x[at[2]], source.GetLineNum());
    }
    return {first, static_cast<std::int64_t>(count)};
  }

  const MeshFile& file_;
  const PlaceSurface& place_;
  tinyxml2::XMLDocument document_;
  std::map<std::string_view, const Element*> by_id_;
  std::map<const Element*, Surface> surfaces_;
  std::map<const Element*, std::vector<double>> arrays_;
  std::map<const Element*, std::vector<Part>> parts_;
  int placed_parts_ = 0;
};

}  // namespace

void read_dae(const MeshFile& file, const PlaceSurface& place) {
  DaeReader(file, place).read();
}

}  // namespace swivel::io
