// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/placement_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "drawing.hpp"
#include "palette.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

using namespace detail;

namespace {

/// Returns a merit as the value of its criterion with its unit, such as "9.9 mm" of clearance.
std::string value_text(PlacementCriterion criterion, double merit) {
  using enum PlacementCriterion;
  const bool is_length = criterion == kClearance || criterion == kSlide;
  const char* const format = is_length              ? "%.3g mm"
                             : criterion == kMargin ? "%.3g deg"
                             : criterion == kSpeed  ? "%.3g m/s"
                                                    : "%.4g";
  const double scale = is_length              ? 1e3
                       : criterion == kMargin ? 180 / kPi
                       : criterion == kCost   ? -1
                                              : 1;
  return formatted(format, scale * merit);
}

/// Returns the unit of an axis: m for a shift, degrees for a turn; of a joint that is held what its
/// position is given in, m or rad.
const char* unit_of(const PlacementAxis& axis) {
  if (!axis.joint.empty()) return axis.slides ? "m" : "rad";
  return axis.coordinate < 3 ? "m" : "deg";
}

/// Returns place `k` of an axis in its unit.
double value_at(const PlacementAxis& axis, int k) {
  return axis.at(k) * (axis.joint.empty() && axis.coordinate >= 3 ? 180 / kPi : 1);
}

/// Returns the words for what the shades mean: the first criterion, from its least to its best
/// value.
std::string title_of(const PlacementMap& map) {
  const PlacementCriterion criterion = map.criteria.front();
  std::string title = to_string(criterion);
  if (criterion == PlacementCriterion::kClearance) title = "least clearance less what must be kept";
  if (criterion == PlacementCriterion::kMargin) title = "distance from the nearest joint limit";
  if (criterion == PlacementCriterion::kSlide) title = "distance of the slide from its limit";
  if (criterion == PlacementCriterion::kSpeed) title = "top speed of the tool";
  return title + " from " + value_text(criterion, map.least) + " to " +
         value_text(criterion, map.most);
}

/// Returns the number of the shade of a row that has a path, from 0, the least merit, to 9.
int step_of(const PlacementMap& map, const PlacementRow& row) {
  return std::min(9, static_cast<int>(10 * map.shade(row)));
}

/// Returns the index in map.ends of what ended the paths of a row.
std::size_t end_of(const PlacementMap& map, const PlacementRow& row) {
  return static_cast<std::size_t>(std::find(map.ends.begin(), map.ends.end(), ended_by(row)) -
                                  map.ends.begin());
}

/// Returns a colour, "#rrggbb", for each of map.ends: bodies, limits of joints and the rest have
/// palettes of their own, whose last colour those share that are beyond it.
std::vector<std::string> colours_of_ends(const PlacementMap& map) {
  std::size_t bodies = 0, limits = 0, others = 0;
  std::vector<std::string> colours;
  const auto next = [](const auto& palette, std::size_t& used) {
    return palette[std::min(used++, palette.size() - 1)];
  };
  for (const std::string& end : map.ends) {
    const auto row = std::find_if(map.shown.begin(), map.shown.end(), [&](const auto& one) {
      return one.status != PlanStatus::kSolved && ended_by(one) == end;
    });
    const std::string& cause = row->cause;
    const bool of_bodies = cause == "pair" || cause == "contact" || cause == "transition" ||
                           cause == "conflict" || cause == "given_motion";
    colours.emplace_back(of_bodies          ? next(palette::kObjects, bodies)
                         : cause == "limit" ? next(palette::kLimits, limits)
                                            : next(palette::kOthers, others));
  }
  return colours;
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

namespace {

/// Returns true if some place of the map was not planned.
bool has_unplanned(const PlacementMap& map) {
  return std::find(map.at.begin(), map.at.end(), -1) != map.at.end();
}

/// Returns the row at a place of the map, across `i` and up `j`; null if nothing was planned there.
const PlacementRow* row_at(const PlacementMap& map, int i, int j) {
  const int k = map.at[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.across.count) +
                       static_cast<std::size_t>(i)];
  return k < 0 ? nullptr : &map.shown[static_cast<std::size_t>(k)];
}

/// How many places a letter of the map in text stands for.
struct TextCell {
  int across, up;
};

/// Returns the best row of the places that a letter stands for, of which (left, bottom) is the
/// first; null if nothing was planned there.
const PlacementRow* best_in(const PlacementMap& map, const TextCell& cell, int left, int bottom) {
  const PlacementRow* best = nullptr;
  for (int j = bottom; j < std::min(map.up.count, bottom + cell.up); ++j)
    for (int i = left; i < std::min(map.across.count, left + cell.across); ++i) {
      const PlacementRow* const row = row_at(map, i, j);
      if (row && (best == nullptr || better(*row, *best, map.criteria))) best = row;
    }
  return best;
}

/// Returns the letter that stands for a row; '.' for none.
char letter_of(const PlacementMap& map, const PlacementRow* row) {
  if (row == nullptr) return '.';
  if (row->status == PlanStatus::kSolved) return static_cast<char>('0' + step_of(map, *row));
  const std::size_t end = end_of(map, *row);
  return end < 26 ? static_cast<char>('a' + end) : '#';
}

/// Returns the colour of a row; `ends`: as of colours_of_ends().
std::string colour_of(const PlacementMap& map, const PlacementRow* row,
                      const std::vector<std::string>& ends) {
  if (row == nullptr) return palette::kNothing;
  return row->status == PlanStatus::kSolved ? ramp_colour(step_of(map, *row) / 9.0)
                                            : ends[end_of(map, *row)];
}

/// Returns the lines below the map in text: its axes, then what its letters mean.
std::string text_legend(const PlacementMap& map, const TextCell& cell, int margin) {
  const std::string indent(static_cast<std::size_t>(margin), ' ');
  std::string text = indent + printable(map.across.name());
  text += formatted(" %.4g to %.4g %s to the right, ", value_at(map.across, 0),
                    value_at(map.across, map.across.count - 1), unit_of(map.across)) +
          printable(map.up.name()) + " (" + unit_of(map.up) + ") upwards";
  if (cell.across * cell.up > 1)
    text += "; a letter stands for up to " + std::to_string(cell.across) + " x " +
            std::to_string(cell.up) + " placements, the best of them";
  if (map.best_of_several) text += "; each is the best over the other coordinates";
  text += '\n';
  const bool solved = std::any_of(map.shown.begin(), map.shown.end(), [](const auto& row) {
    return row.status == PlanStatus::kSolved;
  });
  if (solved) text += indent + "0 to 9: " + title_of(map) + '\n';
  for (std::size_t k = 0; k < map.ends.size(); ++k)
    text += indent + (k < 26 ? static_cast<char>('a' + k) : '#') +
            ": no path: " + printable(map.ends[k]) + '\n';
  if (has_unplanned(map)) text += indent + ".: not planned\n";
  return text;
}

}  // namespace

std::string to_text(const PlacementMap& map, int columns, bool coloured) {
  constexpr int kMargin = 10, kMostRows = 60;
  const int width = std::max(10, columns - kMargin);
  const TextCell cell{(map.across.count + width - 1) / width,
                      (map.up.count + kMostRows - 1) / kMostRows};
  const std::vector<std::string> ends = colours_of_ends(map);
  std::string text;
  for (int bottom = (map.up.count - 1) / cell.up * cell.up; bottom >= 0; bottom -= cell.up) {
    text += formatted("%8.4g  ", value_at(map.up, bottom));
    for (int left = 0; left < map.across.count; left += cell.across) {
      const PlacementRow* const row = best_in(map, cell, left, bottom);
      const std::string letter(1, letter_of(map, row));
      text += coloured ? on_colour(ansi_colour(colour_of(map, row, ends)), letter) : letter;
    }
    text += '\n';
  }
  return text + text_legend(map, cell, kMargin);
}

namespace {

/// Returns the places of an axis that get a mark: at most six, evenly spread.
std::vector<int> marked_places(const PlacementAxis& axis) {
  std::vector<int> places;
  const int parts = std::min(5, axis.count - 1);
  for (int k = 0; k <= parts; ++k) places.push_back((axis.count - 1) * k / parts);
  return places;
}

/// Returns the name of an axis with its unit.
std::string name_of(const PlacementAxis& axis) {
  return axis.name() + " (" + unit_of(axis) + ")";
}

/// Draws a map of placements: cells, axes, and below them the legend.
class PlacementDrawing {
 public:
  explicit PlacementDrawing(const PlacementMap& map) : map_(map) {}

  /// Returns the SVG document.
  std::string document() {
    const double width = std::max(460.0, kLeft + wide_ + kRight), below = kTop + high_ + 52,
                 height = below + 18.0 * static_cast<double>(map_.ends.size() + 3);
    drawing_.rectangle(0, 0, width, height, palette::kNothing);
    draw_cells();
    draw_axes();
    draw_legend(below);
    return drawing_.document(width, height);
  }

 private:
  static constexpr double kLeft = 64, kTop = 16, kMost = 620, kRight = 24;
  static constexpr int kSteps = 10;  ///< of the scale

  /// Draws the cells. Equal neighbours in a row become one rectangle; where there is no path, it is
  /// hatched.
  void draw_cells() {
    for (int j = 0; j < map_.up.count; ++j)
      for (int i = 0; i < map_.across.count;) {
        const PlacementRow* const row = row_at(map_, i, j);
        int end = i + 1;
        while (end < map_.across.count &&
               letter_of(map_, row_at(map_, end, j)) == letter_of(map_, row))
          ++end;
        if (row != nullptr)
          draw_area(kLeft + cell_ * i, kTop + high_ - cell_ * (j + 1), cell_ * (end - i), cell_,
                    colour_of(map_, row, ends_), row->status != PlanStatus::kSolved);
        i = end;
      }
  }
  void draw_area(double x, double y, double width, double height, const std::string& colour,
                 bool hatched) {
    drawing_.rectangle(x, y, width, height, colour);
    if (hatched) drawing_.hatch(x, y, width, height, line_between(colour, colour));
  }

  /// Draws the frame, the marks and the names of the axes.
  void draw_axes() {
    drawing_.frame(kLeft, kTop, wide_, high_);
    for (const int k : marked_places(map_.across))
      drawing_.text(kLeft + cell_ * (k + 0.5), kTop + high_ + 15, "middle",
                    number(value_at(map_.across, k)));
    for (const int k : marked_places(map_.up))
      drawing_.text(kLeft - 6, kTop + high_ - cell_ * (k + 0.5) + 4, "end",
                    number(value_at(map_.up, k)));
    drawing_.text(
        kLeft + wide_ / 2, kTop + high_ + 31, "middle",
        name_of(map_.across) +
            (map_.best_of_several ? "; each place: the best over the other coordinates" : ""));
    drawing_.text(kLeft - 6, kTop - 4, "end", name_of(map_.up));
  }

  /// Draws the scale of shades and what the other colours mean, from `top` downwards.
  void draw_legend(double top) {
    for (int k = 0; k < kSteps; ++k)
      drawing_.rectangle(kLeft + 14 * k, top - 10, 14, 12, ramp_colour(k / (kSteps - 1.0)));
    drawing_.frame(kLeft, top - 10, 14 * kSteps, 12);
    drawing_.text(kLeft + 14 * kSteps + 8, top, "start", title_of(map_));
    const auto explain = [&](const std::string& fill, const std::string& meaning, bool hatched) {
      top += 18;
      draw_area(kLeft, top - 10, 14, 12, fill, hatched);
      drawing_.frame(kLeft, top - 10, 14, 12);
      drawing_.text(kLeft + 22, top, "start", meaning);
    };
    for (std::size_t k = 0; k < ends_.size(); ++k)
      explain(ends_[k], "no path: " + map_.ends[k], true);
    if (has_unplanned(map_)) explain(palette::kNothing, "not planned", false);
  }

  const PlacementMap& map_;
  /// Edge of a cell, and size of the map.
  const double cell_ =
      std::max(1.0, std::min(24.0, std::floor(kMost / std::max(map_.across.count, map_.up.count))));
  const double wide_ = cell_ * map_.across.count, high_ = cell_ * map_.up.count;
  const std::vector<std::string> ends_ = colours_of_ends(map_);  ///< colours
  Drawing drawing_;
};

}  // namespace

std::string to_svg(const PlacementMap& map) {
  return PlacementDrawing(map).document();
}

}  // namespace swivel
