// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// Physical memory of this machine, bytes.
[[nodiscard]] double machine_memory();
/// Whether as many bytes leave the machine room to live: a plan that needs more would be killed rather than refused.
[[nodiscard]] bool fits_in_memory(double bytes);

}  // namespace swivel
