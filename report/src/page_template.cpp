// SPDX-License-Identifier: BSD-3-Clause
#include "page_template.hpp"

#ifdef SWIVEL_PAGE_TEMPLATE
// GCC's and Clang's way to a file as bytes; C++20 has no #embed.
asm(".section .rodata\n"
    "swivel_page_begin:\n"
    ".incbin \"" SWIVEL_PAGE_TEMPLATE
    "\"\n"
    "swivel_page_end:\n"
    ".byte 0\n"
    ".previous\n");
extern "C" const char swivel_page_begin[];
extern "C" const char swivel_page_end[];
#endif

namespace swivel {

std::string_view page_template() {
#ifdef SWIVEL_PAGE_TEMPLATE
  return {swivel_page_begin, static_cast<std::size_t>(swivel_page_end - swivel_page_begin)};
#else
  return {};
#endif
}

}  // namespace swivel
