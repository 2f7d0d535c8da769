// SPDX-License-Identifier: BSD-3-Clause
#include "page/page_template.hpp"

#include <sstream>
#include <stdexcept>

#include "drawing.hpp"
#include "page/packed.hpp"
#include "swivel/core/messages/bounds.hpp"

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
extern "C" const char swivel_report_begin[], swivel_report_end[], swivel_overview_begin[],
    swivel_overview_end[], swivel_placements_begin[], swivel_placements_end[];
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
  return {swivel_overview_begin,
          static_cast<std::size_t>(swivel_overview_end - swivel_overview_begin)};
#else
  return {};
#endif
}

std::string_view placement_template() {
#ifdef SWIVEL_PAGES
  return {swivel_placements_begin,
          static_cast<std::size_t>(swivel_placements_end - swivel_placements_begin)};
#else
  return {};
#endif
}

std::string escaped_lines(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) result += escaped(line) + '\n';
  return result;
}

namespace {

/// Moves the binary values of `json` behind `bytes`; [first, count] takes the place of each.
void take_out(nlohmann::ordered_json& json, std::string& bytes) {
  if (json.is_binary()) {
    const auto& value = json.get_binary();
    const std::size_t first = bytes.size();
    bytes.append(value.begin(), value.end());
    json = nlohmann::ordered_json::array({first, bytes.size() - first});
  } else if (json.is_structured()) {
    for (auto& part : json) take_out(part, bytes);
  }
}

}  // namespace

std::string fill(std::string_view page, nlohmann::ordered_json data,
                 const std::vector<std::pair<std::string_view, std::string>>& besides) {
  std::string filled;
  const auto copy_up_to = [&](std::string_view mark) {
    const std::size_t at = page.find(mark);
    if (at == std::string_view::npos)
      throw std::logic_error("the page has no place for " + std::string(mark));
    filled += page.substr(0, at);
    page.remove_prefix(at + mark.size());
  };
  for (const auto& [mark, html] : besides) {
    copy_up_to(mark);
    filled += html;
  }
  copy_up_to("@@DATA@@");
  std::string bytes;
  take_out(data, bytes);
  // What turns the direction of writing would turn that of the page as well.
  std::string text =
      printable(data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  if (!bytes.empty()) text += '\0' + bytes;
  filled += compressed(text);
  return filled += page;
}

}  // namespace swivel::detail
