// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/base/types.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel::detail {

// Okabe & Ito's palette, told apart by all kinds of colour vision; shades for joints and for
// bodies.
inline constexpr std::array<const char*, kDof> kJointColour{
    "#cfe8f7", "#b3daf2", "#97cced", "#7bbee8", "#5fb0e2", "#4a9bd0", "#3a83b5"};
inline constexpr std::array<const char*, 6> kBlockerColour{"#d55e00", "#a34700", "#e69f00",
                                                           "#8c2d04", "#f0902f", "#5e2400"};

inline std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : printable(text)) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else
      result += c;
  }
  return result;
}

/// An SVG document written from top to bottom.
class Drawing {
 public:
  void rectangle(double x, double y, double width, double height, const std::string& fill) {
    print("<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"", x, y, width,
          height);
    body_ += fill + "\"/>\n";
  }
  void frame(double x, double y, double width, double height) {
    print(
        "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"none\" "
        "stroke=\"#444\"/>\n",
        x, y, width, height);
  }
  void text(double x, double y, const char* anchor, const std::string& what) {
    print("<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"", x, y);
    body_ += std::string(anchor) + "\">" + escaped(what) + "</text>\n";
  }
  void line(const std::vector<std::pair<double, double>>& points, const char* stroke,
            double width) {
    body_ +=
        "<polyline fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke=\"" +
        std::string(stroke) + "\"";
    print(" stroke-width=\"%.1f\" points=\"", width);
    for (const auto& [x, y] : points) print("%.2f,%.2f ", x, y);
    body_ += "\"/>\n";
  }
  void circle(double x, double y, double radius, const char* fill) {
    print("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" stroke=\"#fff\" fill=\"", x, y, radius);
    body_ += std::string(fill) + "\"/>\n";
  }
  [[nodiscard]] std::string document(double width, double height) const {
    const std::string head = formatted(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" "
        "height=\"%.0f\" "
        "font-family=\"sans-serif\" font-size=\"11\">\n<style>rect { shape-rendering: crispEdges "
        "}</style>\n",
        width, height, width, height);
    return head + body_ + "</svg>\n";
  }

 private:
  template <class... Values>
  void print(const char* format, Values... values) {
    body_ += formatted(format, values...);
  }
  std::string body_;
};

inline std::string number(double value) {
  return formatted("%.3g", value);
}

}  // namespace swivel::detail
