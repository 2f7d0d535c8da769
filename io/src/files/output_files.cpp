// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "files/bad_input.hpp"
#include "files/files.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

const char* const kWritable = "a file in an existing, writable folder";

FileIdentity identity_of(const struct stat& status) {
  return {status.st_dev, status.st_ino, ""};
}

/// Returns the end of a chain of links, whether it exists or not.
fs::path follow(fs::path file) {
  std::error_code error;
  for (int links = 0; links < 40 && fs::is_symlink(file, error); ++links)
    file = file.parent_path() / fs::read_symlink(file, error);
  return file;
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// Creates a new file beside the target, under a name that no other process or thread uses, and
/// returns its descriptor; -1 with errno if that fails.
int open_beside(const fs::path& target, fs::path& name) {
  static std::atomic<unsigned> count{0};
  int descriptor = -1;
  do {  // a killed process of the same number may have left one
    name = target.parent_path() /
           (".swivel-" + std::to_string(getpid()) + "-" + std::to_string(count++) + ".tmp");
    descriptor = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor < 0 && errno == EEXIST);
  if (descriptor < 0) name.clear();
  return descriptor;
}

/// Writes the text and closes the file. Returns the number of the first error, else 0.
int write_and_close(int descriptor, const std::string& text) {
  int error = write_all(descriptor, text);
  if (close(descriptor) != 0 && error == 0) error = errno;
  return error;
}

std::string place(const std::string& option, const fs::path& file) {
  return option.empty() ? file.string() : option + ": " + file.string();
}

}  // namespace

int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count < 0 && errno != EINTR) return errno;
    if (count > 0) text.remove_prefix(count);
  }
  return 0;
}

FileIdentity identity_of(const fs::path& file, const std::string& where) {
  struct stat status {};
  if (stat(file.c_str(), &status) == 0) return identity_of(status);
  const fs::path target = follow(file);
  if (stat(folder_of(target).c_str(), &status) != 0)
    bad_input(where, std::strerror(errno), kWritable);
  FileIdentity identity = identity_of(status);
  identity.name = target.filename().string();
  return identity;
}

bool reader_has_left() {
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  return poll(&output, 1, 0) > 0 && (output.revents & POLLERR) != 0;
}

OutputFiles::~OutputFiles() {
  for (Output& output : outputs_) unstage(output);
}

void OutputFiles::unstage(Output& output) {
  std::error_code ignored;
  if (!output.staged.empty()) fs::remove(output.staged, ignored);
  output.staged.clear();
}

void OutputFiles::add(const std::string& option, const fs::path& file) {
  if (file.empty()) return;
  const std::string where = place(option, file);
  Output output{option, file, follow(file), {}, {}, false, -1, {}, false};
  struct stat status {};
  const bool standard = file == "-";
  const bool exists = (standard ? fstat(STDOUT_FILENO, &status) : stat(file.c_str(), &status)) == 0;
  if (!exists && errno != ENOENT) bad_input(where, std::strerror(errno), kWritable);
  // A file that is one of the process's own streams, as /dev/stdout may be, also holds what is
  // printed: it is not replaced.
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    struct stat own {};
    if (exists && output.descriptor < 0 && fstat(descriptor, &own) == 0 &&
        identity_of(own) == identity_of(status))
      output.descriptor = descriptor;
  }
  output.stream =
      output.descriptor >= 0 || (exists && (S_ISCHR(status.st_mode) || S_ISFIFO(status.st_mode)));
  if (exists && !output.stream && !S_ISREG(status.st_mode))
    bad_input(where, S_ISDIR(status.st_mode) ? "is a folder" : "is a block device or a socket",
              "a file, a pipe or a character device");
  if (!exists && fs::is_symlink(file) && !fs::is_directory(folder_of(output.target)))
    bad_input(where, "is a link to " + output.target.string() + ", whose folder is not there",
              kWritable);
  output.identity = exists ? identity_of(status) : identity_of(output.target, where);

  const auto same = [&](const auto& other) { return other.identity == output.identity; };
  if (std::any_of(inputs_.begin(), inputs_.end(), same))
    bad_input(where, "is one of the files that are read", "a file of its own");
  const auto twice = std::find_if(outputs_.begin(), outputs_.end(), same);
  if (twice != outputs_.end() && !S_ISCHR(status.st_mode))
    bad_input(where, "is the file of " + twice->option + " as well", "a file of its own");

  if (output.stream) {
    if (output.descriptor < 0 && access(file.c_str(), W_OK) != 0)
      bad_input(where, std::strerror(errno), kWritable);
  } else {  // tried, and not left there: whatever ends the work, nothing stays behind
    fs::path beside;
    const int descriptor = open_beside(output.target, beside);
    if (descriptor < 0) bad_input(where, std::strerror(errno), kWritable);
    close(descriptor);
    fs::remove(beside);
  }
  outputs_.push_back(std::move(output));
}

void OutputFiles::add_folder(const std::string& option, const fs::path& folder,
                             const std::function<bool(const std::string&)>& is_one) const {
  const std::string where = place(option, folder);
  const auto taken_by = [&](const FileIdentity& identity) {
    for (const InputFiles::File& input : inputs_)
      if (input.identity == identity) return std::string("is one of the files that are read");
    for (const Output& output : outputs_)
      if (!output.stream && output.identity == identity)
        return "is the file of " + output.option + " as well";
    return std::string();
  };
  const auto refuse = [&](const fs::path& file, const std::string& what) {
    bad_input(where, "its " + file.filename().string() + " " + what, "a folder of its own");
  };
  std::error_code error;
  if (!fs::exists(folder, error)) {
    const fs::path target = follow(folder);
    if (fs::is_directory(folder_of(target), error))
      if (const std::string what = taken_by(identity_of(target, where)); !what.empty())
        bad_input(where, what, "a folder of its own");
    return;
  }
  if (!fs::is_directory(folder, error))
    bad_input(where, "is not a folder", "a folder, or a name for a new one");
  for (const Output& output : outputs_)
    if (!output.stream && is_one(output.target.filename().string()) &&
        fs::equivalent(folder_of(output.target), folder, error))
      refuse(output.target, "is the file of " + output.option + " as well");
  // what is there may be linked to others
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (!is_one(entry.path().filename().string()) ||
        !fs::is_directory(folder_of(follow(entry.path())), error))
      continue;
    if (const std::string what = taken_by(identity_of(entry.path(), where)); !what.empty())
      refuse(entry.path(), what);
  }
  if (error) bad_input(where, error.message(), "a folder that can be read");
}

bool OutputFiles::takes_standard_output() const {
  return std::any_of(outputs_.begin(), outputs_.end(),
                     [](const Output& output) { return output.descriptor == STDOUT_FILENO; });
}

bool OutputFiles::wants(const std::string& option) const {
  return std::any_of(outputs_.begin(), outputs_.end(),
                     [&](const Output& output) { return output.option == option; });
}

void OutputFiles::write(const std::string& option, const std::string& text) {
  write_each(option, [&](const fs::path&) { return text; });
}

void OutputFiles::write_each(const std::string& option,
                             const std::function<std::string(const fs::path&)>& text_of) {
  for (Output& output : outputs_) {
    if (output.option != option) continue;
    unstage(output);
    output.text = text_of(output.name);
    output.remove = false;
  }
}

void OutputFiles::remove(const std::string& option) {
  for (Output& output : outputs_) {
    if (output.option != option) continue;
    unstage(output);
    output.text.reset();
    output.remove = !output.stream;
  }
}

void OutputFiles::stage() {
  for (Output& output : outputs_) {
    if (output.stream || !output.text || !output.staged.empty()) continue;
    struct stat status {};
    const bool exists = stat(output.target.c_str(), &status) == 0;
    const int descriptor = open_beside(output.target, output.staged);
    // where there are such things
    if (descriptor >= 0 && exists) static_cast<void>(fchmod(descriptor, status.st_mode & 0777));
    const int error = descriptor < 0 ? errno : write_and_close(descriptor, *output.text);
    if (error != 0) bad_input(place(output.option, output.name), std::strerror(error), kWritable);
  }
  for (Output& output : outputs_) {
    if (!output.stream || !output.text) continue;
    int error = 0;
    if (output.descriptor >= 0) {
      std::fflush(output.descriptor == STDOUT_FILENO ? stdout : stderr);
      error = write_all(output.descriptor, *output.text);
    } else {
      const int descriptor = open(output.name.c_str(), O_WRONLY | O_CLOEXEC);
      error = descriptor < 0 ? errno : write_and_close(descriptor, *output.text);
    }
    if (error == EPIPE && output.descriptor == STDOUT_FILENO) throw ReaderLeft();
    if (error != 0)
      bad_input(place(output.option, output.name), std::strerror(error),
                "a pipe or device that takes the text");
    output.text.reset();
  }
}

std::vector<fs::path> OutputFiles::commit() {
  std::vector<fs::path> removed;
  for (Output& output : outputs_) {
    std::error_code error;
    if (!output.staged.empty()) {
      fs::rename(output.staged, output.target, error);
      if (!error) output.staged.clear();
    } else if (output.remove && fs::remove(output.target, error)) {
      removed.push_back(output.name);
    }
    if (error) bad_input(place(output.option, output.name), error.message(), kWritable);
  }
  return removed;
}

void write_file(const fs::path& file, const std::string& text) {
  OutputFiles outputs;
  outputs.add("", file);
  outputs.write("", text);
  outputs.stage();
  outputs.commit();
}

}  // namespace swivel::io
