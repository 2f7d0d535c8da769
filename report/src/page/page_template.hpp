// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace swivel::detail {

/// The bundled pages of report/web, with marks like "@@DATA@@" for what is put in; empty where they
/// were left out of the build.
[[nodiscard]] std::string_view page_template();
[[nodiscard]] std::string_view overview_template();
[[nodiscard]] std::string_view placement_template();

/// Returns the text with its lines escaped for HTML.
[[nodiscard]] std::string escaped_lines(const std::string& text);

/// Returns the page with its data in place of "@@DATA@@": a compressed JSON text, then, where
/// `data` has binary values, a byte 0 and these values one after the other, for which the text has
/// [number of the first byte, how many]. `besides`: other marks, in the order of the page and all
/// before the data, each with the HTML that takes its place.
[[nodiscard]] std::string fill(
    std::string_view page, nlohmann::ordered_json data,
    const std::vector<std::pair<std::string_view, std::string>>& besides = {});

}  // namespace swivel::detail
