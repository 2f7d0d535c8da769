// SPDX-License-Identifier: BSD-3-Clause
#include <string_view>

#include "files/text_number.hpp"
#include "meshes/mesh_file.hpp"

namespace swivel::io {

namespace {

constexpr std::size_t kMostLineBytes = std::size_t{16} << 20;  // a face of millions of corners

}  // namespace

void read_obj(const MeshFile& file, const PlaceSurface& place) {
  Surface surface(file);
  std::string joined;
  std::vector<std::int64_t> corners;
  std::string_view rest = file.text;
  for (int line = 1; !rest.empty();) {
    const int here = line;
    joined.clear();
    // A backslash at the end of a line joins it with the next.
    for (bool more = true; more && !rest.empty(); ++line) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      std::string_view part = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (part.ends_with('\r')) part.remove_suffix(1);
      more = part.ends_with('\\');
      if (more) part.remove_suffix(1);
      if (joined.size() + part.size() > kMostLineBytes)
        file.fail(here, "is too long", "lines of at most 16 MiB");
      joined += part;
      joined += ' ';
    }
    Words words(joined);
    const std::string_view kind = words.next();
    if (kind == "v") {
      std::array<double, 3> x{};
      for (double& coordinate : x) {
        const std::string_view word = words.next();
        const auto value = to_number<double>(word);
        if (!value)
          file.fail(here, quoted(word) + " is no coordinate", "v with three finite numbers");
        coordinate = *value;
      }
      surface.add_point(x[0], x[1], x[2], here);
    } else if (kind == "f") {
      corners.clear();
      for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
        // vertex/texture/normal
        const auto number = to_number<std::int64_t>(word.substr(0, word.find('/')));
        const auto count = static_cast<std::int64_t>(surface.points().size());
        if (!number || *number == 0 || *number > count || *number < -count)
          file.fail(here, "a face names vertex " + quoted(word) + " of " + std::to_string(count),
                    "vertices before it, counted from 1, or from -1 backwards");
        corners.push_back(*number > 0 ? *number - 1 : count + *number);
      }
      surface.add_polygon(corners, here);
    }
  }
  place(surface, Eigen::Affine3d::Identity());
}

}  // namespace swivel::io
