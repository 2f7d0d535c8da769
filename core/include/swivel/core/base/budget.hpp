// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

namespace swivel {

/// Thrown by Budget::poll() where work must end at once. plan() turns it into a status, so it never
/// reaches the caller of plan().
struct Stopped {};

/// The stage that a plan is in, for progress reports.
enum class Stage {
  kPreparing,  ///< builds the robot's bodies, mesh trees, pairs that touch by design
  kLattice,    ///< lays out the layers of the lattice
  kBounds,     ///< computes lower bounds on path costs
  kSweep,      ///< computes the cost-to-go without obstacles
  kSearch,     ///< searches; counts the layers of the candidate path proved so far
  kReach,      ///< no path exists: seeks the deepest layer that one reaches
  kProving,    ///< proves the answer that was found
  kMeasuring,  ///< measures the rows of the trajectory
  kDiagnosis,  ///< no path exists: finds out why
  /// Draws a map of the lattice.
  kDrawing,
};
/// Returns the stage in words for people, such as "sweeping the lattice".
[[nodiscard]] const char* to_string(Stage stage);

/// How far a stage of a plan has come.
struct Progress {
  Stage stage = Stage::kPreparing;
  /// Units of work done in the stage, and their total; of = 0: not known.
  std::int64_t done = 0, of = 0;
};
/// Receives progress reports, on the planning thread.
using ProgressFunction = std::function<void(const Progress&)>;

/// Says how long work may go on: until a deadline, until another thread or a signal handler cancels
/// it, whichever comes first, or without an end. It also forwards progress reports. Every stage of
/// a plan polls its budget about once a millisecond or more often.
class Budget {
 public:
  /// Makes a budget that never ends and reports to nobody.
  Budget() = default;
  /// Makes a budget whose deadline is `seconds` from now. `seconds` may be any positive number: one
  /// too large for the clock never passes. `cancel` ends the work once it is true, `stop` once a
  /// stop is requested; `progress` receives reports. `cancel` and `progress` may be null, else they
  /// must outlive the budget and its copies.
  explicit Budget(std::optional<double> seconds, const std::atomic<bool>* cancel = nullptr,
                  std::stop_token stop = {}, const ProgressFunction* progress = nullptr)
      : cancel_(cancel),
        stop_(std::move(stop)),
        progress_(progress && *progress ? progress : nullptr) {
    constexpr double kFar = 1e9;  // 30 years; the clock counts nanoseconds in 64 bits
    if (seconds && *seconds < kFar)
      deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(*seconds));
  }
  /// Returns true if the work was cancelled from outside, whatever the deadline.
  [[nodiscard]] bool cancelled() const {
    return (cancel_ != nullptr && cancel_->load(std::memory_order_relaxed)) ||
           stop_.stop_requested();
  }
  /// Returns true if the work was cancelled or the deadline has passed.
  [[nodiscard]] bool spent() const {
    return cancelled() || (deadline_ && Clock::now() >= *deadline_);
  }
  /// Returns the time until the deadline, s, a tiny one where it has passed; none without one. A
  /// time-out of that length ends with this budget.
  [[nodiscard]] std::optional<double> seconds_left() const {
    constexpr double kLeast = 1e-9;
    if (!deadline_) return std::nullopt;
    return std::max(kLeast, std::chrono::duration<double>(*deadline_ - Clock::now()).count());
  }
  /// Throws Stopped if the work was cancelled or the deadline has passed.
  void poll() const {
    if (spent()) throw Stopped();
  }
  /// Throws Stopped if the budget is spent, else reports that `done` of `of` units of the stage are
  /// done. Only the planning thread may call it.
  void poll(Stage stage, std::int64_t done, std::int64_t of) const {
    poll();
    tell(stage, done, of);
  }
  /// Reports that `done` of `of` units of the stage are done, without asking for the deadline. Only
  /// the planning thread may call it.
  void tell(Stage stage, std::int64_t done = 0, std::int64_t of = 0) const {
    if (progress_) (*progress_)({stage, done, of});
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> deadline_;
  const std::atomic<bool>* cancel_ = nullptr;
  std::stop_token stop_;
  const ProgressFunction* progress_ = nullptr;
};

}  // namespace swivel
