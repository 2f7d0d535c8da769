// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "io_support.hpp"

namespace swivel::test {

using io::test::TempFolder;

/// A format: good files, pieces of its syntax, and what reads it.
struct Reader {
  const char* name;
  std::vector<std::string> seeds, words;
  std::function<void(const std::string&)> read;
};

/// A problem about the iiwa with everything in it, for the folder "problems" that prepare()
/// makes.
extern const char* const kProblem;
extern const std::vector<std::string> kXmlWords, kYamlWords;

/// Returns the contents of a file of the data folder.
std::string data(const std::string& name);

/// Puts into an empty folder what problems/*.yaml name: links to the data, problems/box.stl,
/// problems/good.yaml.
void prepare(const TempFolder& folder);

/// Returns a reader of every format. Files are written into `folder`, which prepare() has filled.
std::vector<Reader> readers(const TempFolder& folder);

}  // namespace swivel::test
