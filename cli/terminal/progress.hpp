// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>

#include "swivel/core/base/budget.hpp"

namespace swivel::cli {

/// Returns how long work will go on, in words such as ", about 40 s to go", from how much of it is
/// done after some time; "" where nothing is done yet, or all.
inline std::string time_to_go(std::uint64_t done, std::uint64_t of, double seconds) {
  if (done == 0 || done >= of) return "";
  const double left = seconds * static_cast<double>(of - done) / static_cast<double>(done);
  char text[48];
  if (left < 100)
    std::snprintf(text, sizeof text, ", about %.0f s to go", left);
  else if (left < 6000)
    std::snprintf(text, sizeof text, ", about %.0f min to go", left / 60);
  else
    std::snprintf(text, sizeof text, ", about %.1f h to go", left / 3600);
  return text;
}

/// Shows the progress of work that takes more than half a second as one line on the terminal
/// (standard error). A thread of its own redraws the line five times a second, so that stages which
/// report nothing are seen to run too.
class ProgressLine {
 public:
  explicit ProgressLine(bool enabled) {
    if (enabled) painter_ = std::jthread([this](const std::stop_token& stop) { paint(stop); });
  }
  void show(const std::string& phrase) {
    const std::lock_guard lock(mutex_);
    phrase_ = phrase;
  }
  void show(const Progress& progress) {
    const std::lock_guard lock(mutex_);
    progress_ = progress;
    phrase_.clear();
  }
  /// Returns how long ago the line was made, s.
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
  }
  /// Erases the line; nothing is shown afterwards.
  void clear() { painter_ = {}; }

 private:
  void paint(const std::stop_token& stop) {
    bool shown = false;
    std::unique_lock lock(mutex_);
    for (auto wait = std::chrono::milliseconds(500);
         !wake_.wait_for(lock, stop, wait, [&] { return stop.stop_requested(); });
         wait = std::chrono::milliseconds(200)) {
      std::fprintf(stderr, "\r\033[K%.1f s: %s", seconds(), phrase().c_str());
      shown = true;
    }
    if (shown) std::fprintf(stderr, "\r\033[K");
  }

  [[nodiscard]] std::string phrase() const {
    if (!phrase_.empty()) return phrase_;
    std::string text = to_string(progress_.stage);
    if (progress_.of > 0)
      text += ", " + std::to_string(progress_.done) + " of " + std::to_string(progress_.of) +
              (progress_.stage == Stage::kMeasuring ? " rows" : " layers");
    return text;
  }

  const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  Progress progress_;
  std::condition_variable_any wake_;
  std::string phrase_ = "planning";
  std::jthread painter_;
};

}  // namespace swivel::cli
