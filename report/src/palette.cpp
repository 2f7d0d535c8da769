// SPDX-License-Identifier: BSD-3-Clause
#include "palette.hpp"

#include <algorithm>
#include <cmath>

#include "swivel/core/messages/formatted.hpp"

namespace swivel::detail {

namespace {

/// Returns red, green and blue of "#rrggbb", 0 to 255 each.
std::array<int, 3> parts_of_colour(const std::string& colour) {
  const int value = std::stoi(colour.substr(1), nullptr, 16);
  return {value >> 16, value >> 8 & 255, value & 255};
}

/// Returns the relative luminance of WCAG 2.
double luminance(const std::string& colour) {
  constexpr std::array<double, 3> kWeight{0.2126, 0.7152, 0.0722};
  const std::array<int, 3> rgb = parts_of_colour(colour);
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double v = rgb[k] / 255.0;
    sum += kWeight[k] * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  return sum;
}

double contrast(const std::string& one, const std::string& other) {
  const auto [low, high] = std::minmax({luminance(one), luminance(other)});
  return (high + 0.05) / (low + 0.05);
}

}  // namespace

std::string ramp_colour(double share) {
  const double at = std::clamp(share, 0.0, 0.9999) * (palette::kRamp.size() - 1);
  const auto k = static_cast<std::size_t>(at);
  const std::array<int, 3> low = parts_of_colour(palette::kRamp[k]),
                           high = parts_of_colour(palette::kRamp[k + 1]);
  std::array<int, 3> mixed{};
  for (std::size_t c = 0; c < 3; ++c)
    mixed[c] =
        static_cast<int>(std::lround(low[c] + (at - static_cast<double>(k)) * (high[c] - low[c])));
  return formatted("#%02x%02x%02x", mixed[0], mixed[1], mixed[2]);
}

const char* line_between(const std::string& one, const std::string& other) {
  constexpr double kEnough = 3;
  if (contrast(one, other) >= kEnough) return nullptr;
  for (const char* const line : {"#5b6673", "#000000", "#ffffff"})
    if (std::min(contrast(line, one), contrast(line, other)) >= kEnough) return line;
  return "#000000";
}

AnsiColour ansi_colour(const std::string& colour) {
  const std::array<int, 3> wanted = parts_of_colour(colour);
  AnsiColour best;
  int least = 1 << 20;
  const auto offer = [&](int number, int r, int g, int b) {
    const int dr = r - wanted[0], dg = g - wanted[1], db = b - wanted[2],
              away = 2 * dr * dr + 4 * dg * dg + 3 * db * db;
    if (away < least) least = away, best.background = number;
  };
  const auto level = [](int k) { return k == 0 ? 0 : 55 + 40 * k; };
  for (int k = 0; k < 216; ++k) offer(16 + k, level(k / 36), level(k / 6 % 6), level(k % 6));
  for (int k = 0; k < 24; ++k) offer(232 + k, 8 + 10 * k, 8 + 10 * k, 8 + 10 * k);
  best.ink = contrast(colour, "#000000") >= contrast(colour, "#ffffff") ? 16 : 231;
  return best;
}

std::string on_colour(const AnsiColour& colour, const std::string& text) {
  return "\x1b[48;5;" + std::to_string(colour.background) + ";38;5;" + std::to_string(colour.ink) +
         "m" + text + "\x1b[0m";
}

}  // namespace swivel::detail
