// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/csv.hpp"

namespace swivel::io {

/// The name of a column, in small letters, and the unit behind it in brackets, if any: "X [mm]" is
/// {"x", "mm"}.
struct TableColumn {
  std::string name, unit;
};

/// Says, for the columns of a header and its place for messages, which of them are numbers that are
/// read, in the order in which rows have them. Throws InputError.
using ChooseColumns = std::function<std::vector<std::size_t>(const std::vector<TableColumn>&,
                                                             const std::string& where)>;

/// Reads a table as programs export them (docs/formats.md, "Tool path, CSV"): columns separated by
/// commas, semicolons, tabs or spaces, as the header has them, decimal points or commas, comments,
/// empty lines, any ends of lines. Calls `take` for each row with the numbers of the chosen
/// columns. Throws InputError, also for fewer than two rows or more than a million.
void read_path_table(const std::string& file, std::string_view text, const ChooseColumns& choose,
                     const std::function<void(const CsvPlace&, std::span<const double>)>& take);

}  // namespace swivel::io
