// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/placement_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "drawing.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

using namespace detail;

namespace {

/// "cost 2.27", "clearance 9.9 mm more than asked", ...
std::string value_text(PlacementCriterion criterion, double merit) {
  using enum PlacementCriterion;
  const char* const format = criterion == kClearance ? "%.3g mm"
                             : criterion == kMargin  ? "%.3g deg"
                             : criterion == kSpeed   ? "%.3g m/s"
                                                     : "%.4g";
  const double scale = criterion == kClearance ? 1e3
                       : criterion == kMargin  ? 180 / kPi
                       : criterion == kCost    ? -1
                                               : 1;
  return formatted(format, scale * merit);
}

const char* unit_of(const PlacementAxis& axis) {
  return axis.coordinate < 3 ? "m" : "rad";
}

std::string title_of(const PlacementMap& map) {
  const PlacementCriterion criterion = map.criteria.front();
  std::string title = to_string(criterion);
  if (criterion == PlacementCriterion::kClearance) title = "least clearance less what must be kept";
  if (criterion == PlacementCriterion::kMargin) title = "distance from the nearest joint limit";
  if (criterion == PlacementCriterion::kSpeed) title = "top speed of the tool";
  return title + " from " + value_text(criterion, map.least) + " to " +
         value_text(criterion, map.most);
}

/// From the least to the most merit.
constexpr std::array<const char*, 10> kShade{"#dff3eb", "#c3e8da", "#a6dcc8", "#89cfb5", "#6cc1a2",
                                             "#4fb28e", "#34a17a", "#1c8e66", "#0b7953", "#005c3c"};
constexpr std::array<int, 10> kAnsiShade{194, 157, 121, 120, 84, 78, 72, 35, 29, 22};
const char* const kNothing = "#ffffff";

int step_of(const PlacementMap& map, const PlacementRow& row) {
  return std::min(9, static_cast<int>(10 * map.shade(row)));
}

std::size_t end_of(const PlacementMap& map, const PlacementRow& row) {
  return static_cast<std::size_t>(std::find(map.ends.begin(), map.ends.end(), ended_by(row)) -
                                  map.ends.begin());
}

}  // namespace

std::string ended_by(PlanStatus status, const std::string& cause, const std::string& by,
                     const std::string& reason) {
  if (status == PlanStatus::kSolved) return "";
  if (status == PlanStatus::kError) return "internal error";
  if (cause.empty()) return "not known";
  if (cause == "limit" && !by.empty()) return "limit of " + by;
  return by.empty() ? reason : by;
}

std::string ended_by(const PlacementRow& row) {
  return ended_by(row.status, row.cause, row.by, row.reason);
}

PlacementMap::PlacementMap(const PlacementGrid& grid, std::size_t across_axis, std::size_t up_axis,
                           const std::vector<PlacementRow>& rows,
                           std::vector<PlacementCriterion> by)
    : across(grid.axes()[across_axis]), up(grid.axes()[up_axis]), criteria(std::move(by)) {
  at.assign(static_cast<std::size_t>(across.count) * static_cast<std::size_t>(up.count), -1);
  best_of_several = grid.size() > at.size();
  bool any = false;
  std::map<std::string, int> count;
  for (const PlacementRow& row : rows) {
    const std::vector<int> index = grid.indices(row.cell);
    int& place =
        at[static_cast<std::size_t>(index[up_axis]) * static_cast<std::size_t>(across.count) +
           static_cast<std::size_t>(index[across_axis])];
    if (place < 0) {
      place = static_cast<int>(shown.size());
      shown.push_back(row);
    } else if (better(row, shown[static_cast<std::size_t>(place)], criteria)) {
      shown[static_cast<std::size_t>(place)] = row;
    }
  }
  for (const PlacementRow& row : shown) {
    if (row.status != PlanStatus::kSolved) ++count[ended_by(row)];
    const auto value = merit(row, criteria.front());
    if (!value) continue;
    least = any ? std::min(least, *value) : *value;
    most = any ? std::max(most, *value) : *value;
    any = true;
  }
  for (const auto& [name, times] : count) ends.push_back(name);
  std::stable_sort(ends.begin(), ends.end(),
                   [&](const auto& a, const auto& b) { return count[a] > count[b]; });
}

double PlacementMap::shade(const PlacementRow& row) const {
  const auto value = merit(row, criteria.front());
  if (!value) return 0;
  return most > least ? (*value - least) / (most - least) : 1;
}

std::string to_text(const PlacementMap& map, int columns, bool coloured) {
  constexpr int kMargin = 10, kMostRows = 60;
  const int each_across = (map.across.count + std::max(10, columns - kMargin) - 1) /
                          std::max(10, columns - kMargin),
            each_up = (map.up.count + kMostRows - 1) / kMostRows;
  const auto put = [&](std::string& text, char symbol, int background) {
    if (coloured)
      text += "\x1b[48;5;" + std::to_string(background) + ";38;5;16m" + symbol + "\x1b[0m";
    else
      text += symbol;
  };
  const auto look = [&](const PlacementRow* row) -> std::pair<char, int> {
    if (row == nullptr) return {'.', 231};
    if (row->status == PlanStatus::kSolved) {
      const int step = step_of(map, *row);
      return {static_cast<char>('0' + step), kAnsiShade[static_cast<std::size_t>(step)]};
    }
    const std::size_t end = end_of(map, *row);
    return {end < 26 ? static_cast<char>('a' + end) : '#',
            row->cause == "pair" || row->cause == "contact" ? 208 : 153};
  };
  std::string text;
  for (int top = (map.up.count - 1) / each_up * each_up; top >= 0; top -= each_up) {
    text += formatted("%8.4g  ", map.up.at(top));
    for (int left = 0; left < map.across.count; left += each_across) {
      const PlacementRow* row = nullptr;
      for (int j = top; j < std::min(map.up.count, top + each_up); ++j)
        for (int i = left; i < std::min(map.across.count, left + each_across); ++i) {
          const int k =
              map.at[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.across.count) +
                     static_cast<std::size_t>(i)];
          if (k < 0) continue;
          const PlacementRow& other = map.shown[static_cast<std::size_t>(k)];
          if (row == nullptr || better(other, *row, map.criteria)) row = &other;
        }
      const auto [symbol, background] = look(row);
      put(text, symbol, background);
    }
    text += '\n';
  }
  text += std::string(kMargin, ' ') + kCoordinates[static_cast<std::size_t>(map.across.coordinate)];
  text += formatted(" %.4g to %.4g %s to the right, ", map.across.at(0),
                    map.across.at(map.across.count - 1), unit_of(map.across)) +
          std::string(kCoordinates[static_cast<std::size_t>(map.up.coordinate)]) + " (" +
          unit_of(map.up) + ") upwards";
  if (each_across * each_up > 1)
    text += "; a letter stands for up to " + std::to_string(each_across) + " x " +
            std::to_string(each_up) + " placements, the best of them";
  if (map.best_of_several) text += "; each is the best over the other coordinates";
  text += '\n';
  const bool solved = std::any_of(map.shown.begin(), map.shown.end(), [](const auto& row) {
    return row.status == PlanStatus::kSolved;
  });
  if (solved) text += std::string(kMargin, ' ') + "0 to 9: " + title_of(map) + '\n';
  for (std::size_t k = 0; k < map.ends.size(); ++k)
    text += std::string(kMargin, ' ') + (k < 26 ? static_cast<char>('a' + k) : '#') +
            ": no path: " + printable(map.ends[k]) + '\n';
  if (std::find(map.at.begin(), map.at.end(), -1) != map.at.end())
    text += std::string(kMargin, ' ') + ".: not planned\n";
  return text;
}

std::string to_svg(const PlacementMap& map) {
  constexpr double kLeft = 64, kTop = 16, kMost = 620, kRight = 24;
  const double cell =
      std::max(1.0, std::min(24.0, std::floor(kMost / std::max(map.across.count, map.up.count))));
  const double wide = cell * map.across.count, high = cell * map.up.count,
               width = std::max(460.0, kLeft + wide + kRight);
  const auto colour = [&](const PlacementRow& row) -> std::string {
    if (row.status == PlanStatus::kSolved)
      return kShade[static_cast<std::size_t>(step_of(map, row))];
    const std::size_t end = end_of(map, row);
    return row.cause == "pair" || row.cause == "contact"
               ? kBlockerColour[end % kBlockerColour.size()]
           : row.cause == "limit" ? kJointColour[end % kJointColour.size()]
                                  : "#b9b9c6";
  };
  Drawing drawing;
  const double below = kTop + high + 52;
  const double height = below + 18.0 * static_cast<double>(map.ends.size() + 3);
  drawing.rectangle(0, 0, width, height, kNothing);
  for (int j = 0; j < map.up.count; ++j)
    for (int i = 0; i < map.across.count;) {
      const auto colour_at = [&](int k) {
        const int row =
            map.at[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.across.count) +
                   static_cast<std::size_t>(k)];
        return row < 0 ? std::string() : colour(map.shown[static_cast<std::size_t>(row)]);
      };
      const std::string fill = colour_at(i);
      int end = i + 1;  // places alike are one rectangle
      while (end < map.across.count && colour_at(end) == fill) ++end;
      if (!fill.empty())
        drawing.rectangle(kLeft + cell * i, kTop + high - cell * (j + 1), cell * (end - i), cell,
                          fill);
      i = end;
    }
  drawing.frame(kLeft, kTop, wide, high);
  const auto marks = [](const PlacementAxis& axis) {
    std::vector<int> places;
    const int parts = std::min(5, axis.count - 1);
    for (int k = 0; k <= parts; ++k) places.push_back((axis.count - 1) * k / parts);
    return places;
  };
  for (const int k : marks(map.across))
    drawing.text(kLeft + cell * (k + 0.5), kTop + high + 15, "middle", number(map.across.at(k)));
  for (const int k : marks(map.up))
    drawing.text(kLeft - 6, kTop + high - cell * (k + 0.5) + 4, "end", number(map.up.at(k)));
  const auto name = [](const PlacementAxis& axis) {
    return std::string(kCoordinates[static_cast<std::size_t>(axis.coordinate)]) + " (" +
           unit_of(axis) + ")";
  };
  drawing.text(
      kLeft + wide / 2, kTop + high + 31, "middle",
      name(map.across) +
          (map.best_of_several ? "; each place: the best over the other coordinates" : ""));
  drawing.text(kLeft - 6, kTop - 4, "end", name(map.up));
  double top = below;
  const auto legend = [&](const std::string& fill, const std::string& meaning) {
    drawing.rectangle(kLeft, top - 10, 14, 12, fill);
    drawing.frame(kLeft, top - 10, 14, 12);
    drawing.text(kLeft + 22, top, "start", meaning);
    top += 18;
  };
  for (std::size_t k = 0; k < kShade.size(); ++k)
    drawing.rectangle(kLeft + 14.0 * static_cast<double>(k), top - 10, 14, 12, kShade[k]);
  drawing.frame(kLeft, top - 10, 14.0 * kShade.size(), 12);
  drawing.text(kLeft + 14.0 * kShade.size() + 8, top, "start", title_of(map));
  top += 18;
  for (const std::string& end : map.ends) {
    const auto row = std::find_if(map.shown.begin(), map.shown.end(), [&](const auto& r) {
      return r.status != PlanStatus::kSolved && ended_by(r) == end;
    });
    legend(colour(*row), "no path: " + end);
  }
  if (std::find(map.at.begin(), map.at.end(), -1) != map.at.end()) legend(kNothing, "not planned");
  return drawing.document(width, height);
}

}  // namespace swivel
