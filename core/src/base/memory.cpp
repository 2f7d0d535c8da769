// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/base/memory.hpp"

#include <unistd.h>

namespace swivel {

double machine_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

bool fits_in_memory(double bytes) {
  return bytes <= 0.8 * machine_memory();
}

}  // namespace swivel
