// SPDX-License-Identifier: BSD-3-Clause
// Tables of many plans: placements, campaigns, and problems that are given one by one
// (plan_many.cpp).
#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/archive.hpp"
#include "base/bindings.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/core/study/placement.hpp"
#include "swivel/io/files/files.hpp"
#include "swivel/io/tables/campaign.hpp"
#include "swivel/io/tables/placement.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::python {

/// Returns the number by which a table is ordered.
inline std::uint64_t number_of(const PlacementRow& row) {
  return row.cell;
}
inline std::uint64_t number_of(const EpisodeRow& row) {
  return row.episode;
}

/// Rows of many plans, in the order of their numbers.
template <class R>
struct Table {
  using Row = R;
  static constexpr const char* kSaving = "As CSV, docs/formats.md: what the program writes.";

  std::shared_ptr<const std::vector<Row>> rows;  // shared with arrays
  std::vector<std::string> coordinates;          // for episodes: names of the offsets in the rows

  [[nodiscard]] Row at(std::size_t k) const { return (*rows)[k]; }
  [[nodiscard]] std::string to_csv() const {
    if constexpr (std::is_same_v<Row, EpisodeRow>)
      return io::to_csv(*rows, coordinates);
    else
      return io::to_csv(*rows);
  }
  /// Throws InputError if the file cannot be written.
  void save(const std::filesystem::path& file) const { io::write_file(file, to_csv()); }
  /// Returns the rows of several tables as one.
  [[nodiscard]] static Table joined(const std::vector<Table>& parts) {
    std::vector<Row> all;
    for (const Table& part : parts) all.insert(all.end(), part.rows->begin(), part.rows->end());
    std::sort(all.begin(), all.end(),
              [](const Row& a, const Row& b) { return number_of(a) < number_of(b); });
    return {std::make_shared<const std::vector<Row>>(std::move(all)),
            parts.empty() ? std::vector<std::string>() : parts.front().coordinates};
  }
};
using Placements = Table<PlacementRow>;
using Episodes = Table<EpisodeRow>;

template <class Row>
Table<Row> to_table(std::vector<Row> rows, std::vector<std::string> coordinates = {}) {
  return {std::make_shared<const std::vector<Row>>(std::move(rows)), std::move(coordinates)};
}

// Columns of a table, whose `rows` point at Rows.

/// Returns an array with one number for each row, NaN for a row that has none.
template <class Rows, class Row>
py::array_t<double> numbers(const Rows& table, std::optional<double> Row::*member) {
  py::array_t<double> array(static_cast<py::ssize_t>(table.rows->size()));
  double* out = array.mutable_data();
  for (const Row& row : *table.rows)
    *out++ = (row.*member).value_or(std::numeric_limits<double>::quiet_NaN());
  return array;
}
/// Returns a read-only view of the numbers of all rows.
template <class Rows, class Row, class Number>
py::array_t<Number> plain(const Rows& table, Number Row::*member) {
  return column(table.rows, table.rows->empty() ? nullptr : &(table.rows->front().*member));
}
/// Returns an array that says of each row whether `holds(row)`.
template <class Rows, class Holds>
py::array_t<bool> where(const Rows& table, const Holds& holds) {
  py::array_t<bool> array(static_cast<py::ssize_t>(table.rows->size()));
  bool* out = array.mutable_data();
  for (const auto& row : *table.rows) *out++ = holds(row);
  return array;
}
template <class Rows, class Row>
std::vector<std::string> texts(const Rows& table, std::string Row::*member) {
  std::vector<std::string> all;
  for (const Row& row : *table.rows) all.push_back(row.*member);
  return all;
}

/// Returns words such as "12, of which 7 have a path; cost 1.9 to 2.4".
template <class Rows>
std::string table_words(const Rows& table) {
  std::size_t solved = 0;
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const auto& row : *table.rows) {
    if (row.status != PlanStatus::kSolved || !row.cost) continue;
    ++solved;
    least = std::min(least, *row.cost);
    most = std::max(most, *row.cost);
  }
  std::string text = formatted("%zu, of which %zu have a path", table.rows->size(), solved);
  if (solved > 0) text += formatted("; cost %.6g to %.6g", least, most);
  return text;
}

/// Binds what every table has. Rows is Table, or a struct with the same members but for
/// `coordinates`.
template <class Rows>
py::class_<Rows> bind_table(py::module_& m, const char* type, const char* doc) {
  using Row = typename Rows::Row;
  py::class_<Rows> table(m, type, doc);
  table.def(pickling<Rows>())
      .def("__len__", [](const Rows& t) { return t.rows->size(); })
      .def(
          "__getitem__",
          [](const Rows& t, py::ssize_t k) {
            const auto size = static_cast<py::ssize_t>(t.rows->size());
            if (k < -size || k >= size)
              throw py::index_error("row " + std::to_string(k) + " of " + std::to_string(size));
            return t.at(static_cast<std::size_t>(k < 0 ? k + size : k));
          },
          py::arg("k"), "The k-th row.")
      .def_property_readonly(
          "status",
          [](const Rows& t) {
            std::vector<PlanStatus> all;
            for (const Row& row : *t.rows) all.push_back(row.status);
            return all;
          },
          "Status of each row.")
      .def_property_readonly(
          "solved",
          [](const Rows& t) {
            return where(t, [](const Row& row) { return row.status == PlanStatus::kSolved; });
          },
          "(n,) bool.")
      .def_property_readonly(
          "cost", [](const Rows& t) { return numbers(t, &Row::cost); },
          "(n,); NaN where there is no path.")
      .def_property_readonly(
          "failed_s", [](const Rows& t) { return numbers(t, &Row::failed_s); },
          "(n,), m, where every path ends; NaN where there is one, and where not even the first "
          "layer has a node.")
      .def_property_readonly(
          "reason", [](const Rows& t) { return texts(t, &Row::reason); },
          "What ends them, in words; '' where there is a path.")
      .def("save", &Rows::save, py::arg("file"), Rows::kSaving)
      .def(
          "to_csv", [](const Rows& t) { return t.to_csv(); }, "All rows as CSV, docs/formats.md.")
      .def_static("_joined", &Rows::joined)  // used by runs.py of the package
      .def("__repr__", [name = std::string(type)](const Rows& t) {
        return "<" + name + ": " + table_words(t) + ">";
      });
  return table;
}

/// Returns a robot for all plans of a problem of one arm; null for two arms, each plan of which
/// prepares both. Throws what PreparedRobot throws, and Stopped.
[[nodiscard]] std::shared_ptr<const PreparedRobot> prepare_robot(const swivel::Problem& planned,
                                                                 const Budget& budget);

}  // namespace swivel::python
