// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <bit>
#include <cstring>
#include <string_view>

#include "files/text_number.hpp"
#include "meshes/mesh_file.hpp"

namespace swivel::io {

namespace {

constexpr std::size_t kHead = 84, kEach = 50;

std::uint32_t word_at(const std::string& text, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<unsigned char>(text[at + k]);
  return value;
}

void add_triangle(Surface& surface, int line) {
  const auto next = static_cast<std::int64_t>(surface.points().size());
  surface.add_polygon(std::array{next - 3, next - 2, next - 1}, line);
}

void read_binary(const MeshFile& file, std::size_t count, Surface& surface) {
  for (std::size_t k = 0; k < count; ++k) {
    std::array<double, 9> x{};
    for (std::size_t j = 0; j < 9; ++j)
      x[j] = std::bit_cast<float>(word_at(file.text, kHead + kEach * k + 12 + 4 * j));
    for (std::size_t j = 0; j < 9; j += 3) surface.add_point(x[j], x[j + 1], x[j + 2], 0);
    add_triangle(surface, 0);
  }
}

void read_text(const MeshFile& file, Surface& surface) {
  Words words(file.text);
  const auto expect = [&](std::string_view wanted) {
    if (const std::string_view word = words.next(); word != wanted)
      file.fail(words.line(), word.empty() ? "is cut short" : quoted(word),
                "'" + std::string(wanted) + "'");
  };
  const auto coordinate = [&] {
    const std::string_view word = words.next();
    const auto value = to_number<double>(word);
    if (!value) file.fail(words.line(), quoted(word) + " is no coordinate", "a finite number");
    return *value;
  };
  while (!words.peek().empty()) {
    expect("solid");
    (void)words.rest_of_line();  // its name
    while (words.peek() == "facet") {
      expect("facet");
      (void)words.rest_of_line();  // its normal, which many programs get wrong
      expect("outer");
      expect("loop");
      for (int k = 0; k < 3; ++k) {
        expect("vertex");
        const double x = coordinate(), y = coordinate(), z = coordinate();
        surface.add_point(x, y, z, words.line());
      }
      expect("endloop");
      expect("endfacet");
      add_triangle(surface, words.line());
    }
    expect("endsolid");
    (void)words.rest_of_line();
  }
}

}  // namespace

void read_stl(const MeshFile& file, const PlaceSurface& place) {
  const std::size_t size = file.text.size();
  Surface surface(file);
  const std::size_t count = size < kHead ? 0 : word_at(file.text, 80),
                    expected = kHead + kEach * count;
  // Binary files may begin with "solid" as well.
  const bool text = std::string_view(file.text).starts_with("solid") && size != expected;
  if (!text && (size < kHead || size < expected))
    file.fail(0,
              "is cut short: " + std::to_string(size) + " bytes of " +
                  std::to_string(size < kHead ? kHead : expected),
              "an STL file, binary or text");
  if (text)
    read_text(file, surface);
  else
    read_binary(file, count, surface);
  place(surface, Eigen::Affine3d::Identity());
}

}  // namespace swivel::io
