// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>
#include <set>

#include "swivel/io/results/result.hpp"

namespace swivel::io {

std::string to_trace_json(const Timeline& timeline) {
  using nlohmann::json;
  json events = json::array();
  std::set<int> threads;
  for (const Timeline::Event& event : timeline.events()) {
    const auto begin = static_cast<double>(event.begin_ns), end = static_cast<double>(event.end_ns);
    json entry{{"name", event.name},         {"ph", "X"}, {"ts", begin / 1e3},
               {"dur", (end - begin) / 1e3}, {"pid", 1},  {"tid", event.thread}};
    if (event.count_name != nullptr) entry["args"] = {{event.count_name, event.count}};
    events.push_back(std::move(entry));
    threads.insert(event.thread);
  }
  for (const int thread : threads)
    events.push_back({{"name", "thread_name"},
                      {"ph", "M"},
                      {"pid", 1},
                      {"tid", thread},
                      {"args", {{"name", "thread " + std::to_string(thread)}}}});
  return json{{"traceEvents", std::move(events)}, {"displayTimeUnit", "ms"}}.dump();
}

}  // namespace swivel::io
