// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <bit>
#include <cmath>
#include <string_view>

#include "files/text_number.hpp"
#include "meshes/mesh_file.hpp"

namespace swivel::io {

namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct Property {
  std::string_view name;
  Type type{};
  std::optional<Type> count;  ///< of a list
};
struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

class PlyReader {
 public:
  explicit PlyReader(const MeshFile& file) : file_(file), words_(file.text), surface_(file) {}

  Surface read() {
    read_header();
    for (const PlyElement& element : elements_) {
      // Every element of a binary file takes bytes, and of a text file a word, unless it has no
      // property.
      if (element.count > (element.properties.empty() ? 0 : file_.text.size()))
        fail("has " + std::to_string(element.count) + " of " +
                 std::string(element.name.substr(0, 400)) + ", more than the file holds",
             "the number that follows the header");
      for (std::uint64_t k = 0; k < element.count; ++k) read_element(element);
    }
    return std::move(surface_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& allowed) const {
    file_.fail(text_ ? words_.line() : 0, what, allowed);
  }

  Type type_of(std::string_view word) const {
    constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
    for (std::size_t k = 0; k < kNames.size(); ++k)
      if (word == kNames[k][0] || word == kNames[k][1]) return static_cast<Type>(k);
    fail(quoted(word) + " is no type", "char, uchar, short, ushort, int, uint, float, double");
  }

  void read_header() {
    const char* const allowed = "a PLY header";
    constexpr std::size_t kMostProperties = 1000;
    std::size_t properties = 0;
    if (words_.next() != "ply") fail("does not begin with 'ply'", allowed);
    for (std::string_view word = words_.next(); word != "end_header"; word = words_.next()) {
      if ((properties += word == "element" || word == "property") > kMostProperties)
        fail("too many elements and properties", "at most " + std::to_string(kMostProperties));
      if (word == "format") {
        const std::string_view format = words_.next();
        binary_ = format != "ascii";
        big_ = format == "binary_big_endian";
        if (binary_ && !big_ && format != "binary_little_endian")
          fail("unknown format " + quoted(format),
               "ascii, binary_little_endian, binary_big_endian");
        (void)words_.rest_of_line();
      } else if (word == "element") {
        PlyElement element{words_.next(), 0, {}};
        const std::string_view count = words_.next();
        const auto value = to_number<std::uint64_t>(count);
        if (!value) fail(quoted(count) + " is no number of elements", "a whole number");
        element.count = *value;
        elements_.push_back(std::move(element));
      } else if (word == "property") {
        if (elements_.empty()) fail("a property before the first element", allowed);
        Property property;
        std::string_view type = words_.next();
        if (type == "list") {
          property.count = type_of(words_.next());
          type = words_.next();
        }
        property.type = type_of(type);
        property.name = words_.next();
        elements_.back().properties.push_back(property);
      } else if (word == "comment" || word == "obj_info") {
        (void)words_.rest_of_line();
      } else {
        fail(word.empty() ? "the header has no end" : quoted(word) + " in the header", allowed);
      }
    }
    (void)words_.rest_of_line();
    data_ = words_.rest();
    if (!data_.empty()) data_.remove_prefix(1);  // the line's end
    text_ = !binary_;
  }

  double value(Type type) {
    if (!binary_) {
      const std::string_view word = words_.next();
      if (word.empty()) fail("is cut short", "as many elements as the header says");
      const auto number = to_number<double>(word);
      if (!number) fail(quoted(word) + " is not a number", "numbers after the header");
      return *number;
    }
    const std::size_t size = size_of(type);
    if (data_.size() < size) fail("is cut short", "as many elements as the header says");
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < size; ++k)
      bits = bits << 8 | static_cast<unsigned char>(data_[big_ ? k : size - 1 - k]);
    data_.remove_prefix(size);
    switch (type) {
      case Type::kInt8:
        return static_cast<std::int8_t>(bits);
      case Type::kInt16:
        return static_cast<std::int16_t>(bits);
      case Type::kInt32:
        return static_cast<std::int32_t>(bits);
      case Type::kFloat:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case Type::kDouble:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  std::int64_t whole(Type type, std::int64_t most) {
    const double number = value(type);
    if (!(number >= 0 && number <= static_cast<double>(most)) || number != std::floor(number))
      fail("a list has length or index " + std::to_string(number),
           "whole numbers that the file can hold");
    return static_cast<std::int64_t>(number);
  }

  void read_element(const PlyElement& element) {
    const bool vertex = element.name == "vertex", face = element.name == "face";
    std::array<double, 3> x{};
    int found = 0;
    corners_.clear();
    for (const Property& property : element.properties) {
      if (property.count) {
        const bool corners =
            face && (property.name == "vertex_indices" || property.name == "vertex_index");
        const std::int64_t count =
            whole(*property.count, static_cast<std::int64_t>(file_.text.size()));
        if (corners && count > static_cast<std::int64_t>(kMostTriangles) + 2)
          fail("a face has " + std::to_string(count) + " corners",
               "at most " + std::to_string(kMostTriangles) + " triangles");
        for (std::int64_t k = 0; k < count; ++k) {
          if (corners)
            corners_.push_back(whole(property.type, INT32_MAX));
          else
            (void)value(property.type);
        }
      } else {
        const double number = value(property.type);
        if (!vertex || property.name.size() != 1 || property.name[0] < 'x' ||
            property.name[0] > 'z')
          continue;
        x[property.name[0] - 'x'] = number;
        ++found;
      }
    }
    if (vertex && found != 3) fail("vertices without x, y and z", "one property x, one y, one z");
    if (vertex) surface_.add_point(x[0], x[1], x[2], text_ ? words_.line() : 0);
    if (face) surface_.add_polygon(corners_, text_ ? words_.line() : 0);
  }

  const MeshFile& file_;
  Words words_;
  Surface surface_;
  std::string_view data_;
  std::vector<PlyElement> elements_;
  std::vector<std::int64_t> corners_;
  bool binary_ = false, big_ = false, text_ = true;
};

}  // namespace

void read_ply(const MeshFile& file, const PlaceSurface& place) {
  place(PlyReader(file).read(), Eigen::Affine3d::Identity());
}

}  // namespace swivel::io
