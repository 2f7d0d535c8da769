// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <exception>
#include <optional>
#include <string>
#include <vector>

namespace swivel::cli {

/// Returns the advice that `seek()` finds. The answer is known by then and must not be lost: an
/// error becomes a warning, and there is no advice.
template <class Seek>
auto advice_or_warning(std::vector<std::string>& warnings, const Seek& seek)
    -> std::optional<decltype(seek())> {
  try {
    return seek();
  } catch (const std::exception& error) {
    warnings.push_back(std::string("--advise: ended by an error, there is no advice: ") +
                       error.what());
    return std::nullopt;
  }
}

}  // namespace swivel::cli
