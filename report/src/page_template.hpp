// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string_view>

namespace swivel {

/// report/web bundled into one HTML file, where "@@DATA@@" stands for the data; empty with SWIVEL_REPORT=OFF.
[[nodiscard]] std::string_view page_template();

}  // namespace swivel
