// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/cut.hpp"
#include "swivel/core/answer/plan.hpp"

namespace swivel {

/// The answer for people, in one line: whether there is a path, and what it comes near to, as far as that was asked for. Where
/// there is none, what ends every path, and a line for every run of layers that are empty for one cause.
[[nodiscard]] std::string answer_text(const PlanResult& result);

/// A line for each change that was tried, what helps first.
[[nodiscard]] std::string advice_text(const std::vector<Advice>& advice);

/// What a certificate holds: layers, and what is removed by what.
[[nodiscard]] std::string cut_text(const Cut& cut, std::size_t bytes);
/// The same without its size, for one that was verified.
[[nodiscard]] std::string removed_text(const Cut& cut);

}  // namespace swivel
