// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace swivel {

/// An array of a fixed size whose elements begin as zero bytes. The system supplies a page when it
/// is first written to (0.3 to 2.5 us each), so that an array of many megabytes of which little is
/// used costs little.
template <class T>
class ZeroedArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  ZeroedArray() = default;
  /// Allocates `size` zeros. Throws std::bad_alloc.
  explicit ZeroedArray(std::size_t size)
      : data_(static_cast<T*>(std::calloc(size ? size : 1, sizeof(T)))), size_(size) {
    if (!data_) throw std::bad_alloc();
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T* data() { return data_.get(); }
  [[nodiscard]] const T* data() const { return data_.get(); }
  [[nodiscard]] T& operator[](std::size_t k) { return data_.get()[k]; }
  [[nodiscard]] const T& operator[](std::size_t k) const { return data_.get()[k]; }

 private:
  struct Free {
    void operator()(T* data) const { std::free(data); }
  };
  std::unique_ptr<T, Free> data_;
  std::size_t size_ = 0;
};

}  // namespace swivel
