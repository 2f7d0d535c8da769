// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace swivel::detail {

/// Threads that help one caller with work of a few microseconds. To wake a thread takes longer than that, so helpers look for more
/// for a while before they sleep, and leave the core to whoever wants it meanwhile.
class Team {
 public:
  /// Fewer where the system has no more threads.
  explicit Team(int helpers);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// A helper looks for work.
  [[nodiscard]] bool awake() const { return asleep_.load() < static_cast<int>(helpers_.size()); }
  /// Calls body(index, worker) for index = first ... count - 1; the caller is worker 0, and does `work` first, unless it is null.
  /// Every index is called whatever throws; rethrows what `work` threw, else what body threw first. Not from within body or work.
  void share(int first, int count, const std::function<void(int index, int worker)>& body,
             const std::function<void()>* work = nullptr);

 private:
  void help(int worker);
  void share_some(int first, int count, const std::function<void(int, int)>& body, const std::function<void()>* work);
  bool take_one(int worker);

  pid_t process_;
  std::vector<std::thread> helpers_;
  /// How often work was shared, and which indices from `first_` on nobody has taken yet: see Open. While there are any, `first_`
  /// and `body_` are theirs.
  std::atomic<std::uint64_t> open_{0};
  std::atomic<int> first_{0};
  std::atomic<const std::function<void(int, int)>*> body_{nullptr};
  std::atomic<int> done_{0};
  std::atomic<int> asleep_{0};
  std::atomic<bool> ended_{false};
  bool sharing_ = false;
  std::mutex failure_mutex_;
  std::exception_ptr failure_;
};

}  // namespace swivel::detail
