// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/base/timeline.hpp"

#include <chrono>
#include <deque>
#include <mutex>
#include <stdexcept>

namespace swivel {

namespace {

using Clock = std::chrono::steady_clock;

/// Numbers timelines, so that a thread knows whether its buffer belongs to the living one: two
/// timelines may live at the same address one after the other.
std::atomic<std::int64_t> born{0};

}  // namespace

struct Timeline::Impl {
  Clock::time_point start = Clock::now();
  std::int64_t number = ++born;
  std::mutex mutex;  // guards `threads`, not the events in them
  // a thread writes to its own vector alone; a deque does not move them
  std::deque<std::vector<Event>> threads;
};

Timeline::Timeline() : impl_(std::make_unique<Impl>()) {
  Timeline* none = nullptr;
  if (!active_.compare_exchange_strong(none, this))
    throw std::logic_error("a timeline is being recorded already");
}
Timeline::~Timeline() {
  active_ = nullptr;
}

std::int64_t Timeline::now() const {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - impl_->start).count();
}

void Timeline::add(const Event& event) {
  struct Place {
    std::int64_t timeline = 0;
    int thread = 0;
    std::vector<Event>* events = nullptr;
  };
  thread_local Place place;
  if (place.timeline != impl_->number) {
    const std::lock_guard lock(impl_->mutex);
    place = {impl_->number, static_cast<int>(impl_->threads.size()),
             &impl_->threads.emplace_back()};
  }
  place.events->push_back(event);
  place.events->back().thread = place.thread;
}

std::vector<Timeline::Event> Timeline::events() const {
  const std::lock_guard lock(impl_->mutex);
  std::vector<Event> all;
  for (const std::vector<Event>& events : impl_->threads)
    all.insert(all.end(), events.begin(), events.end());
  return all;
}

void TraceSpan::begin(const char* name) {
  const Timeline* const timeline = Timeline::active();
  if (timeline == nullptr) return;
  event_.name = name;
  event_.begin_ns = timeline->now();
}

void TraceSpan::end() {
  Timeline* const timeline = Timeline::active();
  if (timeline == nullptr) return;
  event_.end_ns = timeline->now();
  timeline->add(event_);
}

}  // namespace swivel
