// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel::cli {

/// Reserves many megabytes of address space for the heap at once and asks the system for pages of 2
/// MB. A fresh page of 4 kB costs 0.3 us of system time, up to 25 us on virtual machines, and a
/// plan that meets obstacles takes thousands of them. Must be called before any thread begins.
void use_large_pages();

}  // namespace swivel::cli
