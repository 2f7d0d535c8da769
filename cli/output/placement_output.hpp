// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "options/placement_options.hpp"
#include "swivel/io/files/files.hpp"
#include "swivel/io/tables/shards.hpp"
#include "swivel/report/placement_map.hpp"

namespace swivel::cli {

/// Which placements are asked for, and by what they are ranked. The command line of `place` says
/// it; `merge` reads it from the shards.
struct PlacementRequest {
  PlacementOptions placement;
  std::optional<std::uint64_t> sample;
  std::uint64_t seed = 1;
  std::vector<std::string> best{"cost"};

  /// criteria() returns by what placements are ranked, axes() which coordinates are varied. Both
  /// throw InputError, which names the option.
  [[nodiscard]] std::vector<PlacementCriterion> criteria() const;
  [[nodiscard]] std::vector<PlacementAxis> axes() const;
  /// Returns the indices of the axes of the grid that take more than one value. If there are two or
  /// more, a map can be drawn over them.
  [[nodiscard]] std::vector<std::size_t> varied_axes() const;
  [[nodiscard]] bool drawable() const { return !sample && varied_axes().size() >= 2; }
  /// Returns the number of placements, of all shards together.
  [[nodiscard]] std::uint64_t total() const;

  /// note() adds the request to the settings of a run; from() reads it back from the record of a
  /// shard.
  void note(io::RunSettings& settings) const;
  static PlacementRequest from(const io::ShardRecord& record);
};

/// Throws InputError if `svg` names a map that cannot be drawn for this request.
void require_drawable(const PlacementRequest& request, const std::string& svg);

/// Writes the page (--report) and the map (--svg) of placements; all other outputs must have been
/// written before. Then, if no output goes to standard output, prints a headline that ends with
/// `remark`, the map, and the `top` best placements. Commits the outputs, and tells which ones were
/// removed if no placement has a path. `scene` is for the page.
void show_placements(io::OutputFiles& outputs, const std::vector<PlacementRow>& rows,
                     const PlacementRequest& request, const io::ShardRecord& record,
                     std::size_t top, const std::string& remark, const PlacementScene& scene = {});

/// Returns the exit code for these rows. Prints an internal error that they report.
[[nodiscard]] int placement_exit_code(const std::vector<PlacementRow>& rows);

}  // namespace swivel::cli
