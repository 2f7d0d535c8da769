// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

namespace swivel {

/// What ran when on which thread, recorded by Spans while it lives. One at a time in a process: it is for looking at one plan.
class Timeline {
 public:
  struct Event {
    const char* name = nullptr;             ///< of the span; a literal
    std::int64_t begin_ns = 0, end_ns = 0;  ///< since the timeline began
    int thread = 0;                         ///< 0, 1, ... in the order in which threads came
    const char* count_name = nullptr;       ///< null: nothing was counted
    std::int64_t count = 0;
  };

  /// Throws std::logic_error where another one lives.
  Timeline();
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  /// By thread, then in the order in which the spans ended. Not while other threads have open spans.
  [[nodiscard]] std::vector<Event> events() const;

  /// The one that lives, or null.
  [[nodiscard]] static Timeline* active() { return active_.load(std::memory_order_relaxed); }

 private:
  friend class TraceSpan;
  struct Impl;
  [[nodiscard]] std::int64_t now() const;
  void add(const Event& event);

  static inline std::atomic<Timeline*> active_{nullptr};
  std::unique_ptr<Impl> impl_;
};

/// A stretch of work, from construction to destruction. Costs one predicted branch at either end where no timeline lives.
class TraceSpan {
 public:
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
  /// A number to show with it; `name` is a literal.
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
