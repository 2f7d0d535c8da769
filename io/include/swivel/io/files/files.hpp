// SPDX-License-Identifier: BSD-3-Clause
// Files that are read, and files that a command writes: all of them, or none.
#pragma once
#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "swivel/core/messages/input_error.hpp"

namespace swivel::io {

/// Writes text beside the target and renames it over; a device or pipe is written to.
void write_file(const std::filesystem::path& file, const std::string& text);

/// Which file a name means, through links and whatever folder it is named from: by device and inode, and for a file that is not
/// there yet by its folder's and its own name.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0;
  std::string name;  ///< empty for a file that is there
  friend auto operator<=>(const FileIdentity&, const FileIdentity&) = default;
};

/// Notes every file that the loaders above read on this thread while it lives: what no output may replace, and what a campaign's
/// rows hang on. One at a time on a thread.
class InputFiles {
 public:
  /// Contents: whether to take them in as well, which costs a pass over every file.
  enum class Contents { kIgnore, kHash };
  explicit InputFiles(Contents contents = Contents::kIgnore);
  ~InputFiles();
  InputFiles(const InputFiles&) = delete;
  InputFiles& operator=(const InputFiles&) = delete;

  struct File {
    std::filesystem::path name;            ///< as it was opened
    std::optional<FileIdentity> identity;  ///< unset for pipes and devices
    std::uint64_t hash = 0;                ///< FNV-1a, 64 bits
  };
  /// In the order they were read; a file that was read twice is here once.
  [[nodiscard]] const std::vector<File>& files() const { return files_; }

  /// For loaders: the file was read, and this was in it.
  static void note(const std::filesystem::path& file, std::string_view text);

 private:
  std::vector<File> files_;
  Contents contents_;
};

/// Standard output is a pipe that nobody reads any more, as behind `| head`. Who prints ends then, silently.
class ReaderLeft : public InputError {
 public:
  ReaderLeft() : InputError("standard output: nobody reads it any more: allowed is one that takes what is printed") {}
};
/// True where standard output is a pipe or socket whose reader has left.
[[nodiscard]] bool reader_has_left();

/// The files that a command writes: all of them, or none. Names are judged before the work begins; afterwards stage() lays the
/// texts beside their targets and writes to pipes and devices, so that a full disk shows, and commit() renames. A link is followed
/// and what it points to is replaced. Pipes and character devices are written to, never replaced nor removed; the name - is
/// standard output.
class OutputFiles {
 public:
  /// `inputs`: what no output may replace.
  explicit OutputFiles(std::vector<InputFiles::File> inputs = {}) : inputs_(std::move(inputs)) {}
  /// Removes what was staged and not committed.
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// `option` names the output here and in messages; an empty file name is no output. Throws InputError where the file cannot be
  /// written, is one of the inputs, or is an output already.
  void add(const std::string& option, const std::filesystem::path& file);
  /// After all of these: a folder, which need not be there, for files that are written while the work goes on, outside of this
  /// class; `is_one` tells their names. Throws InputError where it is no folder, or where one of them is, or would be, one of the
  /// inputs or outputs.
  void add_folder(const std::string& option, const std::filesystem::path& folder,
                  const std::function<bool(const std::string&)>& is_one) const;
  [[nodiscard]] bool wants(const std::string& option) const;
  /// Whether one of them goes to standard output, by whatever name, so that nothing else should be printed there.
  [[nodiscard]] bool takes_standard_output() const;
  /// What the file is to hold; nothing where the option has no file. A file without a text is left as it is.
  void write(const std::string& option, std::string text);
  /// An earlier file of that name is to go: it would be taken for the answer.
  void remove(const std::string& option);

  void stage();
  /// After stage(). Returns the files that were removed. Throws InputError, like stage().
  std::vector<std::filesystem::path> commit();

 private:
  struct Output {
    std::string option;
    std::filesystem::path name, target, staged;
    FileIdentity identity;
    bool stream = false;  ///< a pipe or a device
    int descriptor = -1;  ///< one of the process's own, for a stream that is its standard output or error
    std::optional<std::string> text;
    bool remove = false;
  };
  [[nodiscard]] Output* find(const std::string& option);
  static void unstage(Output& output);

  std::vector<InputFiles::File> inputs_;
  std::vector<Output> outputs_;
};

}  // namespace swivel::io
