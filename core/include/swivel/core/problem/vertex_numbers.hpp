// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/problem/shape.hpp"

namespace swivel {

/// By vertex: a number from 0 on that is the same where positions are equal. STL stores every corner anew.
[[nodiscard]] std::vector<int> vertex_numbers(const TriangleMesh& mesh);

}  // namespace swivel
