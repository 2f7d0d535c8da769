// SPDX-License-Identifier: BSD-3-Clause
#include "page_template.hpp"

#include <stdexcept>

#ifdef SWIVEL_PAGES
// GCC's and Clang's way to a file as bytes; C++20 has no #embed.
#define SWIVEL_EMBED(name)               \
  asm(".section .rodata\n"               \
      "swivel_" name                     \
      "_begin:\n"                        \
      ".incbin \"" SWIVEL_PAGES "/" name \
      ".html\"\n"                        \
      "swivel_" name                     \
      "_end:\n"                          \
      ".byte 0\n"                        \
      ".previous\n")
SWIVEL_EMBED("report");
SWIVEL_EMBED("overview");
SWIVEL_EMBED("placements");
extern "C" const char swivel_report_begin[], swivel_report_end[], swivel_overview_begin[], swivel_overview_end[],
    swivel_placements_begin[], swivel_placements_end[];
#endif

namespace swivel::detail {

std::string_view page_template() {
#ifdef SWIVEL_PAGES
  return {swivel_report_begin, static_cast<std::size_t>(swivel_report_end - swivel_report_begin)};
#else
  return {};
#endif
}

std::string_view overview_template() {
#ifdef SWIVEL_PAGES
  return {swivel_overview_begin, static_cast<std::size_t>(swivel_overview_end - swivel_overview_begin)};
#else
  return {};
#endif
}

std::string_view placement_template() {
#ifdef SWIVEL_PAGES
  return {swivel_placements_begin, static_cast<std::size_t>(swivel_placements_end - swivel_placements_begin)};
#else
  return {};
#endif
}

std::string fill(std::string_view page, const std::string& json) {
  constexpr std::string_view kMark = "@@DATA@@";
  const std::size_t mark = page.find(kMark);
  if (mark == std::string_view::npos) throw std::logic_error("the page has no place for its data");
  std::string filled(page.substr(0, mark));
  // "</script" would end the element that holds the data, "<!--" and "<script" hide its end.
  for (const char c : json) filled += c == '<' ? "\\u003c" : std::string(1, c);
  filled += page.substr(mark + kMark.size());
  return filled;
}

}  // namespace swivel::detail
