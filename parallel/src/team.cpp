// SPDX-License-Identifier: BSD-3-Clause
#include "team.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace swivel::detail {

namespace {

using Clock = std::chrono::steady_clock;
/// What a plan does between two batches of questions.
constexpr Clock::duration kStayAwake = std::chrono::milliseconds(2);
constexpr int kLooks = 16;  // between two looks at the clock
/// Looks before the core is left to others, some microseconds: the time between two layers of a sweep. To leave it takes one.
constexpr int kSpins = 256;

/// Waits until `there`, with the core at first.
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

/// How often work was shared, and indices first ... last - 1, in one word.
struct Open {
  static constexpr int kMost = 0xffff;
  std::uint64_t times = 0, first = 0, last = 0;
  explicit Open(std::uint64_t word) : times(word >> 32), first(word >> 16 & kMost), last(word & kMost) {}
  [[nodiscard]] std::uint64_t word() const { return times << 32 | first << 16 | last; }
  [[nodiscard]] bool any() const { return first < last; }
};

}  // namespace

Team::Team(int helpers) : process_(getpid()) {
  try {
    for (int k = 0; k < helpers; ++k) helpers_.emplace_back([this, worker = k + 1] { help(worker); });
  } catch (const std::system_error&) {  // the system has no more threads: those that there are do
  }
}

Team::~Team() {
  ended_ = true;
  open_ += std::uint64_t{1} << 32;  // no longer what helpers wait on
  open_.notify_all();
  const bool forked = getpid() != process_;  // then the helpers stayed behind
  for (std::thread& helper : helpers_) forked ? helper.detach() : helper.join();
}

/// False where nobody's help is wanted. Work that was shared since fails the exchange, so what was read belongs to what is taken.
/// The caller takes from the end and helpers from the beginning: from call to call each meets what it wrote before.
bool Team::take_one(int worker) {
  std::uint64_t word = open_.load();
  for (;;) {
    Open open(word);
    if (!open.any()) return false;
    const std::function<void(int, int)>& body = *body_.load();
    const int index = first_.load() + static_cast<int>(worker == 0 ? --open.last : open.first++);
    if (!open_.compare_exchange_weak(word, open.word())) continue;
    try {
      body(index, worker);
    } catch (...) {
      const std::lock_guard lock(failure_mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
    ++done_;
    return true;
  }
}

void Team::share(int first, int count, const std::function<void(int, int)>& body, const std::function<void()>* work) {
  if (sharing_) throw std::logic_error("work is shared from within shared work");
  struct Shares {
    bool& now;
    explicit Shares(bool& sharing) : now(sharing) { now = true; }
    ~Shares() { now = false; }
  } const shares(sharing_);
  for (; first < count; first += Open::kMost)
    share_some(first, std::min(Open::kMost, count - first), body, std::exchange(work, nullptr));
}

void Team::share_some(int first, int count, const std::function<void(int, int)>& body, const std::function<void()>* work) {
  first_ = first;
  body_ = &body;
  done_ = 0;
  Open open(open_.load());
  ++open.times;
  open.first = 0;
  open.last = static_cast<std::uint64_t>(count);
  open_ = open.word();
  if (asleep_.load() > 0) open_.notify_all();
  try {
    if (work) (*work)();
  } catch (...) {
    const std::lock_guard lock(failure_mutex_);
    failure_ = std::current_exception();  // before what body may have thrown
  }
  while (take_one(0)) {
  }
  const auto all_done = [&] { return done_.load() == count; };
  while (!all_done()) look_for(all_done, kLooks);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void Team::help(int worker) {
  for (Clock::time_point last = Clock::now(); !ended_.load();) {
    if (take_one(worker)) {
      while (take_one(worker)) {
      }
      last = Clock::now();
    }
    look_for([&] { return Open(open_.load()).any(); }, kLooks);
    if (Clock::now() - last < kStayAwake) continue;
    ++asleep_;
    if (const std::uint64_t word = open_.load(); !Open(word).any() && !ended_.load()) open_.wait(word);
    --asleep_;
    last = Clock::now();
  }
}

}  // namespace swivel::detail
