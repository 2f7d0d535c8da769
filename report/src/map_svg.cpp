// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdio>

#include "map_cells.hpp"
#include "swivel/core/bounds.hpp"

namespace swivel {

using namespace detail;

namespace {

// Okabe & Ito's palette, told apart by all kinds of colour vision; shades for joints and for bodies.
constexpr std::array<const char*, kDof> kJointColour{"#cfe8f7", "#b3daf2", "#97cced", "#7bbee8", "#5fb0e2", "#4a9bd0", "#3a83b5"};
constexpr std::array<const char*, 6> kBlockerColour{"#d55e00", "#a34700", "#e69f00", "#8c2d04", "#f0902f", "#5e2400"};

std::string colour_of(const LatticeMap::Node& node) {
  switch (node.state) {
    case NodeState::kNoIk:
      return "#ffffff";
    case NodeState::kSingular:
      return "#cc79a7";
    case NodeState::kJointLimit:
      return kJointColour[node.cause];
    case NodeState::kNotLookedAt:
      return "#dcdcdc";
    case NodeState::kFree:
      return node.certified ? "#7ed0b4" : "#00795a";
    case NodeState::kBlocked:
      return kBlockerColour[node.cause % kBlockerColour.size()];
  }
  return "#ffffff";
}

std::string escaped(const std::string& text) {
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
    print("<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"", x, y, width, height);
    body_ += fill + "\"/>\n";
  }
  void frame(double x, double y, double width, double height) {
    print("<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"none\" stroke=\"#444\"/>\n", x, y, width, height);
  }
  void text(double x, double y, const char* anchor, const std::string& what) {
    print("<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"", x, y);
    body_ += std::string(anchor) + "\">" + escaped(what) + "</text>\n";
  }
  void line(const std::vector<std::pair<double, double>>& points, const char* stroke, double width) {
    body_ += "<polyline fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke=\"" + std::string(stroke) + "\"";
    print(" stroke-width=\"%.1f\" points=\"", width);
    for (const auto& [x, y] : points) print("%.2f,%.2f ", x, y);
    body_ += "\"/>\n";
  }
  void circle(double x, double y, double radius, const char* fill) {
    print("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" stroke=\"#fff\" fill=\"", x, y, radius);
    body_ += std::string(fill) + "\"/>\n";
  }
  [[nodiscard]] std::string document(double width, double height) const {
    char head[200];
    std::snprintf(head, sizeof head,
                  "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\" "
                  "font-family=\"sans-serif\" font-size=\"11\">\n<style>rect { shape-rendering: crispEdges }</style>\n",
                  width, height, width, height);
    return head + body_ + "</svg>\n";
  }

 private:
  template <class... Values>
  void print(const char* format, Values... values) {
    char text[256];
    std::snprintf(text, sizeof text, format, values...);
    body_ += text;
  }
  std::string body_;
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

std::string to_svg(const LatticeMap& map) {
  constexpr double kLeft = 52, kPanelWidth = 620, kPanelHeight = 190, kTop = 24, kGap = 52, kRight = 24;
  const MapCells cells(map, 620, 252);
  Drawing drawing;
  const std::vector<int> labels = map.inhabited_labels();
  const double height_of_legend = 18.0 * static_cast<double>(5 + kDof + map.blockers.size());
  const double width = kLeft + kPanelWidth + kRight;
  drawing.rectangle(0, 0, width, kTop + static_cast<double>(labels.size()) * (kPanelHeight + kGap) + height_of_legend, "#ffffff");
  // A node stands for the stretch halfway to its neighbours, so the first and last layer are half as wide.
  const auto x_of = [&](double layer) { return kLeft + kPanelWidth * std::clamp(layer, 0.0, map.layers - 1.0) / (map.layers - 1); };
  MapLegend seen(map);
  double top = kTop;
  for (const int label : labels) {
    const auto y_of = [&](double angle) { return top + kPanelHeight * (1 - angle / map.angles); };
    for (int row = 0; row < cells.rows; ++row) {
      const double low = row * cells.angles_each, high = std::min(map.angles, (row + 1) * cells.angles_each);
      for (int column = 0; column < cells.columns;) {
        const LatticeMap::Node node = cells.node(label, column, row);
        seen.see(node);
        int end = column + 1;  // cells alike are one rectangle
        for (; end < cells.columns; ++end) {
          const LatticeMap::Node other = cells.node(label, end, row);
          if (other != node) break;
        }
        const double from = x_of(column * cells.layers_each - 0.5), to = x_of(end * cells.layers_each - 0.5);
        if (node.state != NodeState::kNoIk) drawing.rectangle(from, y_of(high), to - from, y_of(low) - y_of(high), colour_of(node));
        column = end;
      }
    }
    std::vector<std::pair<double, double>> line;
    const auto flush = [&] {
      if (line.size() > 1) {
        drawing.line(line, "#ffffff", 4);
        drawing.line(line, "#000000", 2);
      }
      line.clear();
    };
    for (std::size_t i = 0; i < map.path.size(); ++i) {
      const int slot = map.path[i], angle = slot % map.angles;
      const bool here = slot / map.angles == label;
      const bool changes = i > 0 && map.path[i - 1] / map.angles != slot / map.angles;
      if (here && i > 0 && !changes && std::abs(map.path[i - 1] % map.angles - angle) > map.angles / 2) flush();  // through pi
      if (!here) {
        flush();
        continue;
      }
      line.emplace_back(x_of(static_cast<double>(i)), y_of(angle + 0.5));
      if (changes || (i + 1 < map.path.size() && map.path[i + 1] / map.angles != label))
        drawing.circle(line.back().first, line.back().second, 4, "#000000");
    }
    flush();
    drawing.frame(kLeft, top, kPanelWidth, kPanelHeight);
    drawing.text(kLeft, top - 7, "start", map.label_name(label));
    for (const auto& [angle, name] : {std::pair{0.0, "-π"}, {0.25, "-π/2"}, {0.5, "0"}, {0.75, "π/2"}, {1.0, "π"}})
      drawing.text(kLeft - 6, y_of(angle * map.angles) + 4, "end", name);
    drawing.text(14, top + kPanelHeight / 2, "middle", "φ");
    for (int k = 0; k <= 5; ++k) {
      const double layer = (map.layers - 1) * k / 5.0;
      drawing.text(x_of(layer), top + kPanelHeight + 15, "middle", number(map.s[static_cast<std::size_t>(layer + 0.5)]));
    }
    drawing.text(kLeft + kPanelWidth / 2, top + kPanelHeight + 29, "middle", "s (m)");
    top += kPanelHeight + kGap;
  }
  const auto legend = [&](const std::string& colour, const std::string& meaning) {
    drawing.rectangle(kLeft, top - 10, 14, 12, colour);
    drawing.frame(kLeft, top - 10, 14, 12);
    drawing.text(kLeft + 22, top, "start", meaning);
    top += 18;
  };
  if (!map.path.empty()) legend("#000000", seen.path_meaning() + "; dots: change of branch");
  for (const auto& [node, meaning] : seen.entries()) legend(colour_of(node), meaning);
  if (cells.layers_each * cells.angles_each > 1) {
    drawing.text(kLeft, top, "start",
                 "A cell stands for up to " + std::to_string(cells.layers_each) + " x " + std::to_string(cells.angles_each) +
                     " nodes and shows a blocked one first, then a free one.");
    top += 18;
  }
  return drawing.document(width, top);
}

}  // namespace swivel
