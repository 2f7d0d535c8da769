// SPDX-License-Identifier: BSD-3-Clause
// Preloaded into the program by faults_test.py: a large allocation throws what no part of the
// program expects, as a bug would.
#include <cstdlib>
#include <new>
#include <stdexcept>

namespace {
std::size_t least = static_cast<std::size_t>(-1);
/// Preloaded libraries come last: those before have made what they need.
__attribute__((constructor)) void arm() {
  if (const char* const bytes = std::getenv("SWIVEL_FAULT_BYTES"))
    least = std::strtoull(bytes, nullptr, 10);
}
}  // namespace

void* operator new(std::size_t size) {
  if (size >= least) throw std::runtime_error("injected");
  if (void* const block = std::malloc(size)) return block;
  throw std::bad_alloc();
}
