// SPDX-License-Identifier: BSD-3-Clause
// Notes the files that are read, and writes the files of a command: all of them, or none.
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

/// Writes text to a file beside the target and renames it over the target; a device or pipe is
/// written to directly. Throws InputError if it cannot be written.
void write_file(const std::filesystem::path& file, const std::string& text);

/// Identifies the file that a name means, through links and from any folder: by device and inode,
/// or, for a file that does not exist yet, by its folder's device and inode and its own name.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0;
  std::string name;  ///< empty for a file that exists
  friend auto operator<=>(const FileIdentity&, const FileIdentity&) = default;
};

/// Notes every file that the loaders of this library read on this thread while it lives: files that
/// no output may replace, and that determine the rows of a campaign. There may be one at a time on
/// a thread; the constructor throws std::logic_error for a second.
class InputFiles {
 public:
  /// Whether to hash the contents of the files too, which costs a pass over every file.
  enum class Contents { kIgnore, kHash };
  explicit InputFiles(Contents contents = Contents::kIgnore);
  ~InputFiles();
  InputFiles(const InputFiles&) = delete;
  InputFiles& operator=(const InputFiles&) = delete;

  /// A file that was read.
  struct File {
    std::filesystem::path name;            ///< as it was opened
    std::optional<FileIdentity> identity;  ///< unset for pipes and devices
    std::uint64_t hash = 0;                ///< FNV-1a, 64 bits; 0 with Contents::kIgnore
  };
  /// Returns the files in the order in which they were first read; a file that was read twice is
  /// listed once.
  [[nodiscard]] const std::vector<File>& files() const { return files_; }

  /// Notes that a file was read, whose contents are `text`. Loaders call it.
  static void note(const std::filesystem::path& file, std::string_view text);

 private:
  std::vector<File> files_;
  Contents contents_;
};

/// Thrown when standard output is a pipe that nobody reads any more, as behind `| head`. A program
/// then ends silently.
class ReaderLeft : public InputError {
 public:
  ReaderLeft()
      : InputError(
            "standard output: nobody reads it any more: allowed is one that takes what is "
            "printed") {}
};
/// Returns true if standard output is a pipe or socket whose reader has closed it.
[[nodiscard]] bool reader_has_left();

/// The files that a command writes: all of them, or none. Names are tested before the work begins.
/// Afterwards stage() writes the texts beside their targets and to pipes and devices, so that a
/// full disk shows, and commit() renames. A link is followed and its target replaced. Pipes and
/// character devices are written to, never replaced nor removed. The name - means standard output.
class OutputFiles {
 public:
  /// Creates an empty list of outputs. `inputs` are the files that no output may replace.
  explicit OutputFiles(std::vector<InputFiles::File> inputs = {}) : inputs_(std::move(inputs)) {}
  /// Removes the files that were staged and not committed.
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Adds an output. `option` names it here and in messages, and may have several outputs; an empty
  /// file name means no output. Throws InputError if the file cannot be written, is one of the
  /// inputs, or is an output already.
  void add(const std::string& option, const std::filesystem::path& file);
  /// Tests a folder, which need not exist, for files that are written outside of this class while
  /// the work goes on. `is_one` tells by name which files these are. Call it after every add().
  /// Throws InputError if it is not a folder, or if one of these files is, or would be, one of the
  /// inputs or outputs.
  void add_folder(const std::string& option, const std::filesystem::path& folder,
                  const std::function<bool(const std::string&)>& is_one) const;
  /// Returns true if the option has an output.
  [[nodiscard]] bool wants(const std::string& option) const;
  /// Returns true if an output goes to standard output, by whatever name, so that nothing else
  /// should be printed there.
  [[nodiscard]] bool takes_standard_output() const;
  /// Sets the text of an option's outputs; does nothing if the option has none. A file without a
  /// text stays as it is.
  void write(const std::string& option, const std::string& text);
  /// Sets the text of each of an option's outputs: what `text_of` returns for the name of its file.
  void write_each(const std::string& option,
                  const std::function<std::string(const std::filesystem::path&)>& text_of);
  /// Marks earlier files of an option's names for removal, because they would be mistaken for the
  /// answer. Pipes and devices stay.
  void remove(const std::string& option);

  /// Writes the texts: those of files beside their targets, then those of pipes and devices. Throws
  /// InputError if one cannot be written, and ReaderLeft.
  void stage();
  /// Renames the staged files to their targets, and removes the files marked for removal, whose
  /// names it returns. Call it after stage(). Throws InputError if that fails.
  std::vector<std::filesystem::path> commit();

 private:
  struct Output {
    std::string option;
    std::filesystem::path name, target, staged;
    FileIdentity identity;
    bool stream = false;  ///< a pipe or a device
    int descriptor = -1;  ///< the process's own, if it is standard output or error; else -1
    std::optional<std::string> text;
    bool remove = false;
  };
  static void unstage(Output& output);

  std::vector<InputFiles::File> inputs_;
  std::vector<Output> outputs_;
};

}  // namespace swivel::io
