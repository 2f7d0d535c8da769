// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>

namespace swivel::detail {

/// The bundled pages of report/web, with "@@DATA@@" where the data goes; empty where they were left out of the build.
[[nodiscard]] std::string_view page_template();
[[nodiscard]] std::string_view overview_template();
[[nodiscard]] std::string_view placement_template();

/// The page with its data, a JSON text.
[[nodiscard]] std::string fill(std::string_view page, const std::string& json);

}  // namespace swivel::detail
