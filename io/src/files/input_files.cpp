// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <stdexcept>

#include "files/files.hpp"
#include "swivel/core/base/fnv1a.hpp"
#include "swivel/io/files/files.hpp"

namespace swivel::io {

namespace {

thread_local InputFiles* listening = nullptr;

}  // namespace

InputFiles::InputFiles(Contents contents) : contents_(contents) {
  if (listening != nullptr)
    throw std::logic_error("the files that this thread reads are being noted already");
  listening = this;
}

InputFiles::~InputFiles() {
  listening = nullptr;
}

void InputFiles::note(const std::filesystem::path& file, std::string_view text) {
  if (listening == nullptr) return;
  auto& files = listening->files_;
  if (std::any_of(files.begin(), files.end(),
                  [&](const File& known) { return known.name == file; }))
    return;
  std::error_code error;
  std::optional<FileIdentity> identity;
  if (std::filesystem::is_regular_file(file, error)) identity = identity_of(file, file.string());
  files.push_back({file, identity, listening->contents_ == Contents::kHash ? fnv1a(text) : 0});
}

}  // namespace swivel::io
