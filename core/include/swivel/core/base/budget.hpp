// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

namespace swivel {

/// Thrown by Budget::poll() where work is to end at once. plan() turns it into a status; it never reaches the caller of plan().
struct Stopped {};

/// What a plan is at.
enum class Stage {
  kPreparing,  ///< the robot's bodies, trees of meshes, pairs that touch by design
  kLattice,    ///< layers of the path
  kBounds,     ///< lower bounds of costs
  kSweep,      ///< cost-to-go without obstacles
  kSearch,     ///< layers of the present candidate that are proved
  kReach,      ///< no path: how far one goes
  kMeasuring,  ///< rows of the trajectory
  kDiagnosis,  ///< why there is none
  kDrawing,
};
[[nodiscard]] const char* to_string(Stage stage);

struct Progress {
  Stage stage = Stage::kPreparing;
  std::int64_t done = 0, of = 0;  ///< of the stage; of = 0: not known
};
using ProgressFunction = std::function<void(const Progress&)>;

/// How long work may go on: until a deadline, until another thread or a signal handler says stop, until the earlier of all, or
/// without an end; and whom to tell how far it is. Every stage of a plan polls it, in strides of a millisecond or less.
class Budget {
 public:
  Budget() = default;
  /// The deadline is `seconds` from now. Every positive number holds; what no clock can measure never passes. `cancel` and
  /// `progress`, null or not, must outlive the budget and its copies.
  explicit Budget(std::optional<double> seconds, const std::atomic<bool>* cancel = nullptr, std::stop_token stop = {},
                  const ProgressFunction* progress = nullptr)
      : cancel_(cancel), stop_(std::move(stop)), progress_(progress && *progress ? progress : nullptr) {
    constexpr double kFar = 1e9;  // 30 years; the clock counts nanoseconds in 64 bits
    if (seconds && *seconds < kFar)
      deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*seconds));
  }
  [[nodiscard]] bool cancelled() const {
    return (cancel_ != nullptr && cancel_->load(std::memory_order_relaxed)) || stop_.stop_requested();
  }
  [[nodiscard]] bool spent() const { return cancelled() || (deadline_ && Clock::now() >= *deadline_); }
  /// Throws Stopped once it is spent.
  void poll() const {
    if (spent()) throw Stopped();
  }
  /// The same, from the planning thread alone: it also tells how far the stage is.
  void poll(Stage stage, std::int64_t done, std::int64_t of) const {
    poll();
    tell(stage, done, of);
  }
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
