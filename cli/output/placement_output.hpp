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

/// Which placements are asked for, and by what they are ranked: `place` as its command line says
/// it, `merge` as shards do.
struct PlacementRequest {
  PlacementOptions placement;
  std::optional<std::uint64_t> sample;
  std::uint64_t seed = 1;
  std::vector<std::string> best{"cost"};

  /// Throw InputError in the names of the options.
  [[nodiscard]] std::vector<PlacementCriterion> criteria() const;
  [[nodiscard]] std::vector<PlacementAxis> axes() const;
  /// Those of the grid that take more than one value, which a map is drawn over where they are two
  /// or more.
  [[nodiscard]] std::vector<std::size_t> varied_axes() const;
  [[nodiscard]] bool drawable() const { return !sample && varied_axes().size() >= 2; }
  /// How many placements in all.
  [[nodiscard]] std::uint64_t total() const;

  /// As settings of a run, and back.
  void note(io::RunSettings& settings) const;
  static PlacementRequest from(const io::ShardRecord& record);
};

/// Throws InputError for an --svg that cannot be drawn.
void require_drawable(const PlacementRequest& request, const std::string& svg);

/// Writes page (--report) and map (--svg) of placements. What else is to be written must have been.
/// Then prints a headline, which ends with `remark`, the map and the `top` best where standard
/// output is free, and commits the outputs; says which ones are gone since no placement has a path.
/// `scene`: for the page.
void show_placements(io::OutputFiles& outputs, const std::vector<PlacementRow>& rows,
                     const PlacementRequest& request, const io::ShardRecord& record,
                     std::size_t top, const std::string& remark, const PlacementScene& scene = {});

/// The exit code that the rows deserve; an internal error is told.
[[nodiscard]] int placement_exit_code(const std::vector<PlacementRow>& rows);

}  // namespace swivel::cli
