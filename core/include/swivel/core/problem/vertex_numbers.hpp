// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/problem/shape.hpp"

namespace swivel {

/// Returns a number for each vertex, from 0 on in order of first appearance, equal for vertices at
/// equal positions. STL files store every corner of every triangle anew.
[[nodiscard]] std::vector<int> vertex_numbers(const TriangleMesh& mesh);

}  // namespace swivel
