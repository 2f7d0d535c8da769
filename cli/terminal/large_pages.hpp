// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel::cli {

/// Reserves many megabytes of address space for the heap at once and asks the system for pages of 2
/// MB. A fresh page of 4 kB costs 0.3 us of system time, up to 25 us on virtual machines, and a
/// plan that meets obstacles takes thousands of them. All threads then take memory from this one
/// heap. Must be called before any thread begins.
void use_large_pages();

/// Gives each further thread a heap of its own, with small pages. A thread that makes whole plans,
/// one after the other, meets fresh pages seldom, and threads that share a heap wait for its lock
/// often. Must be called before any thread begins.
void use_heaps_of_threads();

}  // namespace swivel::cli
