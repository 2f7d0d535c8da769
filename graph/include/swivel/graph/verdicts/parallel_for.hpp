// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>

namespace swivel {

/// Runs work in independent parts: by the caller alone, or by threads that the caller lends.
struct ParallelFor {
  int threads = 1;
  /// Calls body(part, worker) for part = 0 ... parts - 1, worker in 0 ... threads - 1, each worker
  /// on one thread at a time.
  std::function<void(int parts, const std::function<void(int part, int worker)>& body)> for_each =
      [](int parts, const std::function<void(int, int)>& body) {
        for (int part = 0; part < parts; ++part) body(part, 0);
      };
};

}  // namespace swivel
