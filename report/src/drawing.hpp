// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel::detail {

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
  /// Draws slanted lines over a rectangle. `colour`: of the lines.
  void hatch(double x, double y, double width, double height, const std::string& colour) {
    rectangle(x, y, width, height, hatching(colour));
  }
  /// Fills the inside of a path of SVG without softening its edges.
  void area(const std::string& d, const std::string& fill) {
    body_ += "<path class=\"area\" fill=\"" + fill + "\" d=\"" + d + "\"/>\n";
  }
  /// Returns the fill of slanted lines of a colour.
  std::string hatching(const std::string& colour) {
    std::size_t k = 0;
    while (k < hatches_.size() && hatches_[k] != colour) ++k;
    if (k == hatches_.size()) hatches_.push_back(colour);
    return "url(#hatch-" + colour.substr(1) + ")";
  }
  /// Draws a path of SVG, such as "M0,0H10", without a fill.
  void path(const std::string& d, const std::string& stroke, double width) {
    body_ += "<path fill=\"none\" stroke=\"" + stroke + "\"";
    print(" stroke-width=\"%.1f\" d=\"", width);
    body_ += d + "\"/>\n";
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
        "font-family=\"sans-serif\" font-size=\"11\">\n<style>rect, .area { shape-rendering: "
        "crispEdges }</style>\n",
        width, height, width, height);
    std::string patterns;
    for (const std::string& colour : hatches_)
      patterns += "<pattern id=\"hatch-" + colour.substr(1) +
                  "\" width=\"5\" height=\"5\" patternUnits=\"userSpaceOnUse\" "
                  "patternTransform=\"rotate(45)\"><path d=\"M0.6,0V5\" stroke-width=\"1.2\" "
                  "stroke=\"" +
                  colour + "\"/></pattern>\n";
    return head + patterns + body_ + "</svg>\n";
  }

 private:
  template <class... Values>
  void print(const char* format, Values... values) {
    body_ += formatted(format, values...);
  }
  std::string body_;
  std::vector<std::string> hatches_;  ///< colours of the patterns that are used
};

inline std::string number(double value) {
  return formatted("%.3g", value);
}

}  // namespace swivel::detail
