// SPDX-License-Identifier: BSD-3-Clause
#include "options/packages_option.hpp"

#include "swivel/core/messages/input_error.hpp"

namespace swivel::cli {

std::map<std::string, std::filesystem::path> parse_packages(const std::vector<std::string>& items) {
  std::map<std::string, std::filesystem::path> packages;
  for (const std::string& item : items) {
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos || equals == 0 ||
        !std::filesystem::is_directory(item.substr(equals + 1)))
      throw InputError("--packages: '" + item +
                       "': allowed is NAME=FOLDER with an existing folder");
    packages[item.substr(0, equals)] = item.substr(equals + 1);
  }
  return packages;
}

}  // namespace swivel::cli
