// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>

#include "swivel/core/messages/input_error.hpp"

namespace swivel {

/// A robot's file and what a key of `robot` says do not suit each other: "<URDF>: robot.<key>:
/// <fault>". Who reads the key from a file, or from a command line, says where it stands there.
class RobotKeyError : public InputError {
 public:
  RobotKeyError(const std::string& source, std::string key, std::string fault,
                std::string entry = {})
      : InputError(source, "robot." + key + ": " + fault),
        key_(std::move(key)),
        entry_(std::move(entry)),
        fault_(std::move(fault)) {}
  /// "base_link", "tip_link", "hold" or "without".
  [[nodiscard]] const std::string& key() const { return key_; }
  /// Of `hold` the joint, of `without` the link.
  [[nodiscard]] const std::string& entry() const { return entry_; }
  /// What is wrong, and what is allowed.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  std::string key_, entry_, fault_;
};

}  // namespace swivel
