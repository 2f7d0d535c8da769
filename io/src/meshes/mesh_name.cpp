// SPDX-License-Identifier: BSD-3-Clause
#include "meshes/mesh_name.hpp"

#include <tinyxml2.h>

#include <optional>
#include <string_view>

#include "files/bad_input.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

bool is_file(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

/// Returns the file `rest` of a package in a folder; if `folder_is_package`, the folder itself may
/// be the package. None if there is no such file.
std::optional<fs::path> find_in(const fs::path& folder, const std::string& package,
                                const fs::path& rest, bool folder_is_package) {
  if (is_file(folder / package / rest)) return folder / package / rest;
  if (folder_is_package && is_file(folder / rest)) return folder / rest;
  return std::nullopt;
}

/// Returns the name of the package that package.xml in a folder states; none if there is none.
std::optional<std::string> name_of_package(const fs::path& folder) {
  tinyxml2::XMLDocument document;
  if (!is_file(folder / "package.xml") ||
      document.LoadFile((folder / "package.xml").c_str()) != tinyxml2::XML_SUCCESS)
    return std::nullopt;
  const tinyxml2::XMLElement* const root = document.RootElement();
  const tinyxml2::XMLElement* const name =
      root == nullptr ? nullptr : root->FirstChildElement("name");
  if (name == nullptr || name->GetText() == nullptr) return std::nullopt;
  return name->GetText();
}

fs::path resolve_package(const std::string& name, const std::string& path, const fs::path& urdf,
                         const Packages& packages, const std::string& where) {
  const std::string package = path.substr(0, path.find('/'));
  const auto rest_start = path.find_first_not_of('/', package.size());
  const std::string rest = rest_start == std::string::npos ? "" : path.substr(rest_start);
  const std::string what = "mesh '" + name + "' not found";
  if (package.empty() || rest.empty())
    bad_input(where, "mesh name '" + name + "' is incomplete", "package://<package>/<file>");
  if (const auto known = packages.find(package); known != packages.end()) {
    if (const auto file = find_in(known->second, package, rest, true)) return *file;
    bad_input(where,
              what + " in " + known->second.string() + ", given as package '" + package + "'",
              "a folder for the package that contains " + rest);
  }
  const fs::path start = fs::absolute(urdf).lexically_normal().parent_path();
  for (fs::path folder = start;; folder = folder.parent_path()) {
    if (const auto file = find_in(folder, package, rest, folder.filename() == package))
      return *file;
    if (folder == folder.parent_path()) break;
  }
  // The folder may have been renamed, as by a download. A folder that states the name of another
  // package does not count, and a bare file name is too weak a clue.
  for (fs::path folder = start; fs::path(rest).has_parent_path(); folder = folder.parent_path()) {
    if (is_file(folder / rest) && name_of_package(folder).value_or(package) == package)
      return folder / rest;
    if (folder == folder.parent_path()) break;
  }
  bad_input(where, what + " walking up from " + start.string(),
            "a file " + rest + " in a folder at or above the URDF, or robot.packages: {" + package +
                ": its folder}");
}

}  // namespace

fs::path resolve_mesh_name(const std::string& name, const fs::path& urdf, const Packages& packages,
                           const std::string& where) {
  constexpr std::string_view kPackage = "package://", kFile = "file://";
  if (name.starts_with(kPackage))
    return resolve_package(name, name.substr(kPackage.size()), urdf, packages, where);
  std::string path = name;
  if (name.starts_with(kFile))
    path = name.substr(kFile.size());
  else if (name.find("://") != std::string::npos)
    bad_input(where, "unknown scheme in mesh name '" + name + "'",
              "package://, file://, or a file name");
  // an absolute path stays as it is
  const fs::path file = (urdf.parent_path() / path).lexically_normal();
  if (!is_file(file))
    bad_input(where, "mesh '" + name + "' not found (" + file.string() + ")",
              "an existing STL, OBJ, DAE or PLY file");
  return file;
}

}  // namespace swivel::io
