// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <memory>
#include <mutex>

namespace swivel {

/// A value that is made at its first use, once, by whichever thread asks first. Thread-safe.
template <class T>
class Lazy {
 public:
  /// Returns the value. The first call makes it by make(), which returns a std::unique_ptr<T>;
  /// other threads wait for that. If make() throws, the next call tries again.
  template <class Make>
  const T& get(const Make& make) const {
    if (!made_.load(std::memory_order_acquire))
      std::call_once(once_, [&] {
        value_ = make();
        made_.store(true, std::memory_order_release);
      });
    return *value_;
  }
  /// Returns true if the value has been made.
  [[nodiscard]] bool is_made() const { return made_.load(std::memory_order_acquire); }

 private:
  mutable std::once_flag once_;
  mutable std::atomic<bool> made_{false};  // asked first, since entering call_once costs more
  mutable std::unique_ptr<const T> value_;
};

}  // namespace swivel
