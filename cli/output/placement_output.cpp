// SPDX-License-Identifier: BSD-3-Clause
#include "output/placement_output.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <sstream>
#include <utility>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/report/placement_map.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

std::string count_text(const std::vector<PlacementRow>& rows) {
  std::map<std::string, int> subjects;
  int solved = 0;
  for (const PlacementRow& row : rows) {
    solved += row.status == PlanStatus::kSolved;
    if (row.status == PlanStatus::kInfeasible) ++subjects[ended_by(row)];
  }
  std::vector<std::pair<int, std::string>> order;
  for (const auto& [name, count] : subjects) order.emplace_back(-count, name);
  std::sort(order.begin(), order.end());
  std::string text = std::to_string(solved) + " with a path";
  if (!order.empty())
    text += ", " +
            std::to_string(
                std::count_if(rows.begin(), rows.end(),
                              [](const auto& r) { return r.status == PlanStatus::kInfeasible; })) +
            " without:";
  constexpr std::size_t kMostNames = 6;
  for (std::size_t k = 0; k < std::min(kMostNames, order.size()); ++k)
    text +=
        std::string(k == 0 ? " " : ", ") + order[k].second + " " + std::to_string(-order[k].first);
  if (order.size() > kMostNames) text += ", ...";
  return text;
}

std::string figures(const PlacementRow& row) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, "cost %.6g", *row.cost);
  std::string text = buffer;
  const auto add = [&](const char* format, const std::optional<double>& value, double scale) {
    if (!value) return;
    std::snprintf(buffer, sizeof buffer, format, scale * *value);
    text += buffer;
  };
  add(", clearance %.1f mm", row.clearance, 1e3);
  add(", %.1f deg from a joint limit", row.joint_margin, 180 / kPi);
  add(", %.1f mm from a slide's limit", row.slide_margin, 1e3);
  add(", tool speed up to %.3g m/s", row.tool_speed, 1);
  return text;
}

constexpr std::uint64_t kMostCells = 1'000'000;
constexpr const char* kHeldSetting = "hold ";  // before the joint's name

/// Returns the values of an axis as options have them.
std::string values_of(const PlacementAxis& axis) {
  std::string text = shortest(axis.from);
  if (axis.count != 1 || axis.to != axis.from) text += ":" + shortest(axis.to);
  return axis.step > 0 ? text + ":" + shortest(axis.step) : text;
}

/// Returns what is placed, for people: the thing that is moved, and the joints that are held.
std::string thing_of(const PlacementRequest& request, const std::vector<PlacementAxis>& axes) {
  std::string text = request.placement.path   ? "the path"
                     : request.placement.base ? "the robot"
                                              : request.placement.object;
  if (!request.placement.arm.empty()) text += " of " + request.placement.arm;
  for (const PlacementAxis& axis : axes)
    if (!axis.joint.empty()) text += (text.empty() ? "" : " and ") + axis.joint;
  return text;
}

}  // namespace

std::vector<PlacementCriterion> PlacementRequest::criteria() const {
  std::vector<PlacementCriterion> criteria;
  for (const std::string& name : best)
    criteria.push_back(
        in_the_name_of("--best", [&] { return placement_criterion_from_string(name); }));
  return criteria;
}

std::vector<PlacementAxis> PlacementRequest::axes() const {
  std::vector<PlacementAxis> axes = placement.axes();
  if (axes.empty())
    throw InputError(
        "--x, --y, --z, --roll, --pitch, --yaw, --hold: none is given: allowed are one or more of "
        "them");
  for (PlacementAxis& axis : axes) {
    if (sample)
      axis.count = 1;
    else if (axis.count == 0)
      throw InputError("--" + (axis.joint.empty() ? "" : std::string("hold ")) + axis.name() +
                       ": a range without a step: allowed is FROM:TO:STEP, or --sample N");
  }
  return axes;
}

std::vector<std::size_t> PlacementRequest::varied_axes() const {
  const std::vector<PlacementAxis> all = axes();
  std::vector<std::size_t> varied;
  for (std::size_t a = 0; a < all.size(); ++a)
    if (all[a].count > 1) varied.push_back(a);
  return varied;
}

std::uint64_t PlacementRequest::total() const {
  const std::uint64_t count = sample ? *sample : PlacementGrid(axes()).size();
  if (count < 1 || count > kMostCells)
    throw InputError((sample ? "--sample: " : "the grid: ") + std::to_string(count) +
                     " placements: allowed are 1 to " + std::to_string(kMostCells));
  return count;
}

void PlacementRequest::note(io::RunSettings& settings) const {
  const auto add = [&](const std::string& name, const std::string& value) {
    if (!value.empty()) settings.values.emplace_back(name, value);
  };
  add("object", placement.object);
  add("path", placement.path ? "yes" : "");
  add("base", placement.base ? "yes" : "");
  add("arm", placement.arm);
  for (const PlacementAxis& axis : placement.axes())
    if (!axis.joint.empty())
      add(kHeldSetting + axis.joint, values_of(axis) + (axis.slides ? " m" : " rad"));
  for (std::size_t k = 0; k < kCoordinates.size(); ++k)
    add(kCoordinates[k], placement.coordinates[k]);
  add("sample", sample ? std::to_string(*sample) : "");
  add("seed", sample ? std::to_string(seed) : "");
  std::string names;
  for (const std::string& name : best) names += (names.empty() ? "" : ",") + name;
  add("best", names);
}

PlacementRequest PlacementRequest::from(const io::ShardRecord& record) {
  PlacementRequest request;
  request.placement.object = record.setting("object");
  request.placement.path = !record.setting("path").empty();
  request.placement.base = !record.setting("base").empty();
  request.placement.arm = record.setting("arm");
  for (const auto& [name, value] : record.settings.values) {
    if (!name.starts_with(kHeldSetting)) continue;
    const std::string joint = name.substr(std::string(kHeldSetting).size());
    request.placement.hold.push_back(joint + "=" + value.substr(0, value.find(' ')));
    if (value.ends_with(" m")) request.placement.slides.insert(joint);
  }
  for (std::size_t k = 0; k < kCoordinates.size(); ++k)
    request.placement.coordinates[k] = record.setting(kCoordinates[k]);
  if (const std::string sample = record.setting("sample"); !sample.empty())
    request.sample = record.total;
  request.best.clear();
  std::istringstream names(record.setting("best"));
  for (std::string name; std::getline(names, name, ',');) request.best.push_back(name);
  return request;
}

void require_drawable(const PlacementRequest& request, const std::string& svg) {
  if (!svg.empty() && !request.drawable())
    throw InputError(
        "--svg: fewer than two coordinates take more than one value: allowed is a grid over two or "
        "more");
}

void show_placements(io::OutputFiles& outputs, const std::vector<PlacementRow>& rows,
                     const PlacementRequest& request, const io::ShardRecord& record,
                     std::size_t top, const std::string& remark, const PlacementScene& scene) {
  const std::vector<PlacementCriterion> criteria = request.criteria();
  const std::vector<PlacementRow> best =
      best_placements(rows, criteria, std::max<std::size_t>(1, top));
  const PlacementGrid grid(request.axes());
  std::optional<PlacementMap> map;
  if (request.drawable()) {
    const std::vector<std::size_t> varied = request.varied_axes();
    map.emplace(grid, varied[0], varied[1], rows, criteria);
  }
  if (outputs.wants("--report")) {
    std::string answer = count_text(rows) + '\n';
    if (!best.empty()) answer += std::string("the best by ") + to_string(criteria[0]) + ":\n";
    for (const PlacementRow& row : best)
      answer += "  " + figures(row) + ":\n    " + record.plan_command +
                request.placement.words(row.offset, row.hold) + '\n';
    outputs.write("--report",
                  to_placement_page(rows,
                                    {record.problem, thing_of(request, grid.axes()), grid.axes(),
                                     request.sample.has_value(), record.total, criteria,
                                     record.setting("planner"),
                                     record.plan_command + request.placement.words({}, {}), answer,
                                     map ? to_svg(*map) : ""},
                                    scene));
  }
  if (map && outputs.wants("--svg")) outputs.write("--svg", to_svg(*map));
  outputs.stage();
  if (!outputs.takes_standard_output()) {
    say("%zu of %llu placements planned, %s%s%s\n", rows.size(),
        static_cast<unsigned long long>(record.shard.size(record.total)), count_text(rows).c_str(),
        record.held.empty() ? "" : (", held: " + words(record.held)).c_str(), remark.c_str());
    if (map) std::fputs(to_text(*map, terminal_columns(), coloured()).c_str(), stdout);
    if (!best.empty() && top > 0) say("best by %s:\n", to_string(criteria[0]));
    for (std::size_t k = 0; k < std::min(best.size(), top); ++k)
      say("  %s:\n    %s%s\n", figures(best[k]).c_str(), record.plan_command.c_str(),
          request.placement.words(best[k].offset, best[k].hold).c_str());
  }
  flush_standard_output();
  report_removed(outputs.commit(), "no placement has a path");
}

int placement_exit_code(const std::vector<PlacementRow>& rows) {
  const auto with = [&](PlanStatus status) {
    return std::find_if(rows.begin(), rows.end(),
                        [&](const PlacementRow& row) { return row.status == status; });
  };
  if (const auto error = with(PlanStatus::kError); error != rows.end()) {
    complain("swivel: internal error in cell %llu: %s\n",
             static_cast<unsigned long long>(error->cell), error->reason.c_str());
    return kInternalError;
  }
  return with(PlanStatus::kSolved) == rows.end() ? kNo : kOk;
}

}  // namespace swivel::cli
