// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <memory>
#include <mutex>

namespace swivel {

/// What is made when it is first asked for, once, by whichever thread comes first.
template <class T>
class Lazy {
 public:
  /// make(): a std::unique_ptr to it.
  template <class Make>
  const T& get(const Make& make) const {
    if (!made_.load(std::memory_order_acquire))
      std::call_once(once_, [&] {
        value_ = make();
        made_.store(true, std::memory_order_release);
      });
    return *value_;
  }
  [[nodiscard]] bool is_made() const { return made_.load(std::memory_order_acquire); }

 private:
  mutable std::once_flag once_;
  mutable std::atomic<bool> made_{false};  // looking at the flag costs more
  mutable std::unique_ptr<const T> value_;
};

}  // namespace swivel
