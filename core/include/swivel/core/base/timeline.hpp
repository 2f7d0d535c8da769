// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

namespace swivel {

/// Records which spans of work (TraceSpan) ran when and on which thread, while it lives. At most
/// one timeline lives in a process: it is meant for looking at one plan.
class Timeline {
 public:
  /// One span of work that has ended.
  struct Event {
    const char* name = nullptr;             ///< name of the span, a string literal
    std::int64_t begin_ns = 0, end_ns = 0;  ///< in ns since the timeline began
    /// 0, 1, ... in the order in which threads ended their first span.
    int thread = 0;
    /// Name of `count`, a string literal; null: no count was given.
    const char* count_name = nullptr;
    /// a number that belongs to the span, see TraceSpan::count().
    std::int64_t count = 0;
  };

  /// Begins to record. Throws std::logic_error if another timeline lives.
  Timeline();
  /// Ends the recording.
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  /// Returns the events by thread, each thread's in the order in which its spans ended. No other
  /// thread may have an open span meanwhile.
  [[nodiscard]] std::vector<Event> events() const;

  /// Returns the timeline that lives, or null.
  [[nodiscard]] static Timeline* active() { return active_.load(std::memory_order_relaxed); }

 private:
  friend class TraceSpan;
  struct Impl;
  [[nodiscard]] std::int64_t now() const;
  void add(const Event& event);

  static inline std::atomic<Timeline*> active_{nullptr};
  std::unique_ptr<Impl> impl_;
};

/// Records the time from its construction to its destruction as an event of the living timeline.
/// Where no timeline lives it costs one predicted branch at either end.
class TraceSpan {
 public:
  /// Begins a span; `name` must be a string literal.
  explicit TraceSpan(const char* name) {
    if (Timeline::active() != nullptr) [[unlikely]]
      begin(name);
  }
  ~TraceSpan() {
    if (event_.name != nullptr) [[unlikely]]
      end();
  }
  TraceSpan(const TraceSpan&) = delete;
  TraceSpan& operator=(const TraceSpan&) = delete;
  /// Attaches a number to the span, shown beside it as `name`, a string literal.
  void count(const char* name, std::int64_t n) {
    event_.count_name = name;
    event_.count = n;
  }

 private:
  void begin(const char* name);
  void end();
  Timeline::Event event_;
};

}  // namespace swivel
