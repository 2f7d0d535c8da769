// SPDX-License-Identifier: BSD-3-Clause
// The colours of maps, drawings and terminal: those of the pages (report/web/palette.js, which says
// what they keep to). tests/report/palette_test.mjs compares the two.
#pragma once
#include <array>
#include <string>

namespace swivel::detail {

namespace palette {

inline constexpr const char* kNothing = "#ffffff";
inline constexpr const char* kUnseen = "#ced2d9";
inline constexpr const char* kLimit = "#a8d7f8";  ///< hatched with kHatch
inline constexpr const char* kHatch = "#1d5e8a";
inline constexpr const char* kProved = "#62caa9";
inline constexpr const char* kFound = "#0f8064";
inline constexpr const char* kSingular = "#c779a6";
inline constexpr const char* kSelf = "#6a4d94";
inline constexpr std::array<const char*, 6> kObjects{"#e0691b", "#ebc121", "#762200",
                                                     "#f39868", "#765c00", "#c3473f"};
inline constexpr std::array<const char*, 4> kLimits{"#4fb2ea", "#1d5e8a", "#a7d7f9", "#486fcf"};
inline constexpr std::array<const char*, 2> kOthers{"#cb79b9", "#8b8991"};
inline constexpr std::array<const char*, 5> kRamp{"#002d6e", "#5a606e", "#8f8b78", "#cbba69",
                                                  "#fde737"};

}  // namespace palette

/// Returns the colour at a share of the ramp, from 0 (little) to 1 (much), as "#rrggbb".
[[nodiscard]] std::string ramp_colour(double share);

/// Returns the colour of the line that parts two areas, or null where their own contrast is enough.
/// Colours are "#rrggbb".
[[nodiscard]] const char* line_between(const std::string& one, const std::string& other);

/// A background of the terminal's 256 colours, and what is written on it: black or white.
struct AnsiColour {
  int background = 231, ink = 16;
};
/// Returns the colour of the terminal that is nearest to "#rrggbb".
[[nodiscard]] AnsiColour ansi_colour(const std::string& colour);

/// Returns `text` on a background, by ANSI escapes.
[[nodiscard]] std::string on_colour(const AnsiColour& colour, const std::string& text);

}  // namespace swivel::detail
