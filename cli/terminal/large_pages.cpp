// SPDX-License-Identifier: BSD-3-Clause
#include "terminal/large_pages.hpp"

#include <cstdint>
#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace swivel::cli {

void use_large_pages() {
#ifdef __GLIBC__
  constexpr int kHeap = 256 << 20;    // addresses: memory comes with use
  constexpr int kLargest = 32 << 20;  // larger blocks have pages of their own; glibc takes no more
  constexpr int kStep = 1 << 20;      // by which the heap grows beyond
  constexpr std::uintptr_t kPage = 2 << 20;
  const auto heap_end = [] { return reinterpret_cast<std::uintptr_t>(sbrk(0)); };
  const std::uintptr_t before = heap_end();
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, 2 * kHeap);  // what is freed is used again
  mallopt(M_ARENA_MAX, 1);               // other threads' heaps would have small pages
  mallopt(M_TOP_PAD, kHeap);
  void* volatile grown = std::malloc(kStep);  // volatile: or the compiler leaves both out
  std::free(grown);
  mallopt(M_TOP_PAD, kStep);  // or the last megabytes of a limited address space could not be had
  // Where the system has no such pages, or no room for the heap, small pages do.
  const std::uintptr_t begin = (before + kPage - 1) / kPage * kPage, end = heap_end();
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
}

}  // namespace swivel::cli
