// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// Returns the physical memory of this machine, in bytes.
[[nodiscard]] double machine_memory();
/// Returns true if `bytes` are at most 80 % of the physical memory. A plan that needs more is
/// refused, since the system would kill it.
[[nodiscard]] bool fits_in_memory(double bytes);

}  // namespace swivel
