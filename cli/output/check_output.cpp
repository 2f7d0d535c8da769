// SPDX-License-Identifier: BSD-3-Clause
#include "output/check_output.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "swivel/core/messages/formatted.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Returns the text of a failure without its numbers, in which failures of one kind differ. Numbers
/// within quoted names stay.
std::string kind_of(const std::string& failure) {
  std::string kind;
  bool quoted = false, number = false;
  for (const char c : failure) {
    if (c == '\'') quoted = !quoted;
    number = !quoted && (std::strchr("0123456789.+-", c) != nullptr || (number && c == 'e'));
    if (!number) kind += c;
  }
  return kind;
}

}  // namespace

void print_failures(const std::vector<std::string>& failures, std::int64_t count) {
  std::vector<std::pair<std::string, std::size_t>> kinds;  // and how many there are
  std::vector<const std::string*> first;
  for (const std::string& failure : failures) {
    const std::string kind = kind_of(failure);
    const auto known = std::find_if(kinds.begin(), kinds.end(),
                                    [&](const auto& one) { return one.first == kind; });
    if (known != kinds.end()) {
      ++known->second;
      continue;
    }
    kinds.emplace_back(kind, 1);
    first.push_back(&failure);
  }
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    say("  %s", first[k]->c_str());
    if (kinds[k].second > 1) say(" (and %zu more like it)", kinds[k].second - 1);
    say("\n");
  }
  const auto listed = static_cast<std::int64_t>(failures.size());
  if (count > listed)
    say("  and %lld more failure%s\n", static_cast<long long>(count - listed),
        count - listed == 1 ? "" : "s");
}

void print_contact(const CheckResult& result) {
  if (result.deepest_contact_status == Known::kNotMeasured) say(", depth of contact not measured");
  const auto& contact = result.deepest_contact;
  if (!contact) return;
  say(", %s - %s at least %.3f mm", contact->bodies[0].c_str(), contact->bodies[1].c_str(),
      1e3 * contact->depth);
  if (contact->at_most) say(" and at most %.3f mm", 1e3 * *contact->at_most);
  say(" deep in each other (%s)",
      contact->allowed ? formatted("allowed %.3f mm", 1e3 * *contact->allowed).c_str()
                       : "allowed however deep");
}

}  // namespace swivel::cli
