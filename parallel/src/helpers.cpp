// SPDX-License-Identifier: BSD-3-Clause
#include "helpers.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "swivel/core/base/timeline.hpp"
#include "swivel/parallel/executor.hpp"

namespace swivel::detail {

namespace {

using Clock = std::chrono::steady_clock;
/// How long a helper waits for the next loop: about the time of a plan between two batches of
/// collision queries.
constexpr Clock::duration kStay = std::chrono::milliseconds(2);
constexpr int kLooks = 16;  // between two looks at the clock
/// How often to look before yielding the core, which takes some microseconds: about the time
/// between two layers of a cost-to-go sweep. A yield takes about one microsecond.
constexpr int kSpins = 256;

/// Waits until there() returns true: spins first, then yields the core at most `yields` times.
template <class There>
void look_for(const There& there, int yields) {
  for (int spin = 0; spin < kSpins; ++spin) {
    if (there()) return;
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
  }
  for (int look = 0; look < yields && !there(); ++look) std::this_thread::yield();
}

/// The state of the open loop in one 64-bit word: how often a loop was opened, and the indices
/// first ... last - 1 that nobody has taken.
struct Open {
  static constexpr int kMost = 0xffff;
  std::uint64_t times = 0, first = 0, last = 0;
  explicit Open(std::uint64_t word)
      : times(word >> 32), first(word >> 16 & kMost), last(word & kMost) {}
  [[nodiscard]] std::uint64_t word() const { return times << 32 | first << 16 | last; }
  [[nodiscard]] bool any() const { return first < last; }
};

}  // namespace

struct Helpers::State {
  explicit State(int most) : there(static_cast<std::size_t>(most)) {}

  /// `open` is the word of an Open. While it has indices, `first` (the index to which they are
  /// relative) and `body` belong to them.
  std::atomic<std::uint64_t> open{0};
  std::atomic<int> first{0};
  std::atomic<const std::function<void(int, int)>*> body{nullptr};
  std::atomic<int> done{0};
  std::atomic<std::int64_t> helped{0};
  // entry k: the task of worker k + 1 was started and has not returned
  std::vector<std::atomic<bool>> there;
  std::atomic<int> running{0};
  std::atomic<bool> ended{false};
  std::mutex failure_mutex;
  std::exception_ptr failure;

  [[nodiscard]] bool any_open() const { return Open(open.load()).any(); }

  /// Runs the body for one open index; returns false if none is open. If another loop was opened
  /// meanwhile, the exchange fails, so that `first` and `body` belong to the index taken. The
  /// caller takes indices from the end and helpers from the beginning, so that from loop to loop
  /// each finds data in its cache that it wrote before.
  bool take_one(int worker) {
    std::uint64_t word = open.load();
    for (;;) {
      Open left(word);
      if (!left.any()) return false;
      const std::function<void(int, int)>& call = *body.load();
      const int index = first.load() + static_cast<int>(worker == 0 ? --left.last : left.first++);
      if (!open.compare_exchange_weak(word, left.word())) continue;
      try {
        // The span ends before `done` counts the index: none is open once the loop has ended.
        std::optional<TraceSpan> span;
        if (worker > 0) span.emplace(Executor::kHelperSpan);
        call(index, worker);
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
      }
      if (worker > 0) ++helped;
      ++done;
      return true;
    }
  }

  void help(int worker) {
    ++running;
    for (Clock::time_point last = Clock::now(); !ended.load();) {
      if (take_one(worker)) {
        while (take_one(worker)) {
        }
        last = Clock::now();
      }
      look_for([&] { return any_open(); }, kLooks);
      if (Clock::now() - last < kStay) continue;
      // A loop that the caller opened before it could see that this task leaves is noticed here.
      // The caller may also have started another task for this worker since; then this one ends.
      std::atomic<bool>& here = there[static_cast<std::size_t>(worker - 1)];
      here = false;
      if (!any_open() || here.exchange(true)) break;
    }
    --running;
  }
};

Helpers::Helpers(Arena& arena, int most)
    : arena_(&arena), process_(getpid()), state_(std::make_shared<State>(most)) {}

Helpers::~Helpers() {
  state_->ended = true;
  if (getpid() != process_) return;  // after a fork the tasks are the parent's
  const auto none = [&] { return state_->running.load() == 0; };
  while (!none()) look_for(none, kLooks);
}

bool Helpers::any() const {
  return std::any_of(state_->there.begin(), state_->there.end(),
                     [](const std::atomic<bool>& there) { return there.load(); });
}

std::int64_t Helpers::helped() const {
  return state_->helped.load();
}

void Helpers::start() {
  int allowed = -1;
  for (int k = 0; k < static_cast<int>(state_->there.size()); ++k) {
    std::atomic<bool>& there = state_->there[static_cast<std::size_t>(k)];
    if (there.load()) continue;
    if (allowed < 0) allowed = arena_->most_helpers();
    if (k >= allowed) return;
    there = true;
    arena_->enqueue([state = state_, worker = k + 1] { state->help(worker); });
  }
}

void Helpers::share(int first, int count, const std::function<void(int, int)>& body,
                    const std::function<void()>* work) {
  if (sharing_) throw std::logic_error("work is shared from within shared work");
  struct Shares {
    bool& now;
    explicit Shares(bool& sharing) : now(sharing) { now = true; }
    ~Shares() { now = false; }
  } const shares(sharing_);
  for (; first < count; first += Open::kMost)
    share_some(first, std::min(Open::kMost, count - first), body, std::exchange(work, nullptr));
}

void Helpers::share_some(int first, int count, const std::function<void(int, int)>& body,
                         const std::function<void()>* work) {
  State& state = *state_;
  state.first = first;
  state.body = &body;
  state.done = 0;
  Open open(state.open.load());
  ++open.times;
  open.first = 0;
  open.last = static_cast<std::uint64_t>(count);
  state.open = open.word();
  start();
  try {
    if (work) (*work)();
  } catch (...) {
    const std::lock_guard lock(state.failure_mutex);
    state.failure = std::current_exception();  // before what body may have thrown
  }
  while (state.take_one(0)) {
  }
  const auto all_done = [&] { return state.done.load() == count; };
  while (!all_done()) look_for(all_done, kLooks);
  if (state.failure) std::rethrow_exception(std::exchange(state.failure, nullptr));
}

}  // namespace swivel::detail
