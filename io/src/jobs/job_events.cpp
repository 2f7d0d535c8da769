// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "jobs/job_rows.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel::io {

std::vector<std::optional<std::size_t>> strokes_of_parts(const ArmMotion& motion,
                                                         const Problem& job) {
  std::vector<std::optional<std::size_t>> strokes;
  if (!motion.part.empty()) strokes.resize(motion.part.back() + 1);
  std::size_t part = job.arm().home ? 1 : 0;
  for (const ProcessEvent& event : motion.events) {
    if (!event.on) continue;
    if (part < strokes.size()) strokes[part] = event.stroke;
    part += 2;
  }
  return strokes;
}

void require_samples_of_strokes(const ArmMotion& motion, const Problem& job) {
  for (std::size_t k = 1; k < motion.events.size(); ++k)
    if (motion.events[k].t <= motion.events[k - 1].t)
      throw InputError(job.source, "stroke '" + job.arm().strokes[motion.events[k].stroke].name +
                                       "' begins and ends between two samples: allowed are more "
                                       "samples a second");
}

std::vector<EventMessage> event_messages(const ArmMotion& motion, const Problem& job) {
  require_samples_of_strokes(motion, job);
  // Returns the fields of the run to which a part leads: its begin and its end, in time and place.
  const auto run_of = [&](std::size_t part, double piece) {
    const auto own = std::equal_range(motion.part.begin(), motion.part.end(), part);
    const auto first = static_cast<std::size_t>(own.first - motion.part.begin()),
               end = static_cast<std::size_t>(own.second - motion.part.begin());
    // The row between a transition and a run belongs to both.
    const TimedRow &from = motion.rows[first > 0 ? first - 1 : 0], &to = motion.rows[end - 1];
    return "{\"t\": [" + format_double(from.t) + ", " + format_double(to.t) + "], \"s\": [" +
           format_double(from.row.s + piece) + ", " + format_double(to.row.s + piece) + "]}";
  };
  std::vector<EventMessage> messages;
  std::size_t part = job.arm().home ? 1 : 0;
  for (const ProcessEvent& event : motion.events) {
    const Stroke& stroke = job.arm().strokes[event.stroke];
    const double piece = s_of_piece(stroke);
    messages.push_back({event.t, "{\"t\": " + format_double(event.t) +
                                     ", \"stroke\": " + nlohmann::json(stroke.name).dump() +
                                     ", \"s\": " + format_double(event.s + piece) +
                                     ", \"process\": \"" + (event.on ? "on" : "off") +
                                     "\", \"run\": " + run_of(part, piece) + "}"});
    if (!event.on) part += 2;
  }
  return messages;
}

namespace {

constexpr const char* kEventKeys =
    "t, stroke, s, process (on or off), and run with t and s of its begin and of its end, as "
    "`plan` "
    "and `time` write them";

/// An event of a job's process.
struct Event {
  double t = 0, s = 0;
  std::string stroke;
  bool on = false;
  std::array<double, 2> run_t{}, run_s{};  ///< where the rows of its run begin and end
};

/// Reads an event. Throws InputError, prefixed by `where`.
class EventReader {
 public:
  EventReader(const nlohmann::json& message, const std::string& where)
      : message_(message), where_(where) {}

  Event event() {
    if (!message_.is_object()) bad_input(where_, "is no map", kEventKeys);
    for (const auto& [key, value] : message_.items())
      if (std::none_of(kKnown.begin(), kKnown.end(),
                       [&](const char* known) { return key == known; }))
        bad_input(where_, "key '" + key + "' is unknown", kEventKeys);
    Event event;
    event.t = number(at(message_, "t"), "t");
    event.s = number(at(message_, "s"), "s");
    event.stroke = csv_line_field(text("stroke"));
    const std::string process = text("process");
    if (process != "on" && process != "off")
      bad_input(where_ + ": process", "is '" + process + "'", "on or off");
    event.on = process == "on";
    const nlohmann::json& run = at(message_, "run");
    if (!run.is_object()) bad_input(where_ + ": run", "is no map", kEventKeys);
    event.run_t = pair(at(run, "t"), "run: t");
    event.run_s = pair(at(run, "s"), "run: s");
    return event;
  }

 private:
  [[nodiscard]] const nlohmann::json& at(const nlohmann::json& map, const char* key) const {
    const auto found = map.find(key);
    if (found == map.end()) bad_input(where_, std::string("lacks the key ") + key, kEventKeys);
    return *found;
  }
  [[nodiscard]] double number(const nlohmann::json& value, const char* key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      bad_input(where_ + ": " + key, "is no number", "a finite number");
    return value.get<double>();
  }
  [[nodiscard]] std::string text(const char* key) const {
    const nlohmann::json& value = at(message_, key);
    if (!value.is_string()) bad_input(where_ + ": " + key, "is no text", kEventKeys);
    return value.get<std::string>();
  }
  [[nodiscard]] std::array<double, 2> pair(const nlohmann::json& value, const char* key) const {
    if (!value.is_array() || value.size() != 2)
      bad_input(where_ + ": " + key, "is no list of two numbers",
                "that of the begin and of the end");
    return {number(value[0], key), number(value[1], key)};
  }

  static constexpr std::array<const char*, 5> kKnown{"t", "stroke", "s", "process", "run"};
  const nlohmann::json& message_;
  const std::string& where_;
};

/// Gives the rows of a message or log what its events say of them.
class EventRows {
 public:
  explicit EventRows(FileRows& read) : read_(read) {}

  void label() {
    read_.job.resize(rows().size());
    const std::vector<nlohmann::json>& messages = *read_.events;
    std::vector<Event> events;
    for (std::size_t k = 0; k < messages.size(); ++k)
      events.push_back(EventReader(messages[k], where(k)).event());
    for (std::size_t k = 0; k < events.size(); k += 2) {
      const Event& on = events[k];
      const bool paired = k + 1 < events.size() && on.on && !events[k + 1].on &&
                          on.stroke == events[k + 1].stroke && on.run_t == events[k + 1].run_t &&
                          on.run_s == events[k + 1].run_s;
      if (!paired)
        bad_input(where(k), "does not belong to the one that follows",
                  "an event on and an event off of each run, by turns");
      label_run(k, on, events[k + 1]);
    }
  }

 private:
  [[nodiscard]] std::vector<TimedRow>& rows() const { return read_.arms.front().timed; }
  [[nodiscard]] std::string where(std::size_t event) const {
    return read_.file + ": events[" + std::to_string(event) + "]";
  }

  void label_run(std::size_t k, const Event& on, const Event& off) {
    const std::size_t begin = row_at(on.run_t[0], where(k) + ": run"),
                      end = row_at(on.run_t[1], where(k) + ": run"), first = row_at(on.t, where(k)),
                      last = row_at(off.t, where(k + 1));
    if (begin < free_ || !(begin <= first && first < last && last <= end))
      bad_input(where(k), "its times are not in order",
                "runs one after the other, and events within their run");
    free_ = end;
    for (std::size_t row = begin > 0 ? begin + 1 : 0; row <= end; ++row)
      read_.job[row].stroke = on.stroke;
    for (std::size_t row = first; row < last; ++row) read_.job[row].process = true;
    place(begin, on.run_s[0]);
    place(end, on.run_s[1]);
    place(first, on.s);
    place(last, off.s);
  }
  void place(std::size_t row, double s) {
    read_.job[row].placed = true;
    rows()[row].row.s = read_.arms.front().rows[row].s = s;
  }
  /// Returns the row at a time, of which messages have whole nanoseconds.
  [[nodiscard]] std::size_t row_at(double t, const std::string& where) const {
    const double same = 2e-9 + 4 * std::numeric_limits<double>::epsilon() * std::abs(t);
    const auto found =
        std::lower_bound(rows().begin(), rows().end(), t - same,
                         [](const TimedRow& row, double time) { return row.t < time; });
    if (found == rows().end() || found->t > t + same)
      bad_input(where + ": t", "is " + format_double(t), "the time of a row");
    return static_cast<std::size_t>(found - rows().begin());
  }

  FileRows& read_;
  std::size_t free_ = 0;  // the first row at which a run may begin
};

}  // namespace

FileRows read_rows_of_job(const std::filesystem::path& file, const JointNames& joint_names) {
  FileRows read = read_rows(file, {.arms = {ArmColumns{joint_names}}, .job = true});
  if (!read.lines.empty()) return read;
  if (!read.events)
    bad_input(
        read.file, "has no events of a process, which tell the parts of a job",
        "the motion of a job as `plan` and `time` write it, or CSV with the columns stroke and "
        "process");
  EventRows(read).label();
  return read;
}

}  // namespace swivel::io
