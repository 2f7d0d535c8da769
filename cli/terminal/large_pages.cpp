// SPDX-License-Identifier: BSD-3-Clause
#include "terminal/large_pages.hpp"

#include <cstdint>
#include <cstdlib>
#include <limits>

#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace swivel::cli {

void use_large_pages() {
#ifdef __GLIBC__
  constexpr int kHeap = 256 << 20;    // addresses only: memory is taken as it is used
  constexpr int kLargest = 32 << 20;  // larger blocks have pages of their own; glibc allows no more
  constexpr int kStep = 1 << 20;      // the heap grows beyond kHeap by this
  constexpr std::uintptr_t kPage = 2 << 20;
  const auto heap_end = [] { return reinterpret_cast<std::uintptr_t>(sbrk(0)); };
  const std::uintptr_t before = heap_end();
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, 2 * kHeap);  // keep freed memory for further use
  mallopt(M_ARENA_MAX, 1);               // the heaps of other threads would have small pages
  mallopt(M_TOP_PAD, kHeap);
  // volatile, so that the compiler keeps malloc() and free()
  void* volatile grown = std::malloc(kStep);
  std::free(grown);
  // otherwise the last megabytes of a limited address space would be out of reach
  mallopt(M_TOP_PAD, kStep);
  // If the system has no large pages, or no room for the heap, small pages remain in use.
  const std::uintptr_t begin = (before + kPage - 1) / kPage * kPage, end = heap_end();
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
}

void use_heaps_of_threads() {
#ifdef __GLIBC__
  mallopt(M_ARENA_MAX, std::numeric_limits<int>::max());
#endif
}

}  // namespace swivel::cli
