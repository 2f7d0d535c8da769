// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <string>

#include "swivel/core/study/campaign.hpp"

namespace swivel::test {

/// Expects that two rows of campaigns are equal but for their times. `what`: for messages.
inline void expect_same_rows(const EpisodeRow& a, const EpisodeRow& b, const std::string& what) {
  EXPECT_EQ(a.episode, b.episode) << what;
  EXPECT_EQ(a.status, b.status) << what;
  EXPECT_EQ(a.cost, b.cost) << what;
  EXPECT_EQ(a.checked, b.checked) << what;
  EXPECT_EQ(a.nodes_checked, b.nodes_checked) << what;
  EXPECT_EQ(a.fcl_calls, b.fcl_calls) << what;
  EXPECT_EQ(a.tool_path_error_mm_mean, b.tool_path_error_mm_mean) << what;
  EXPECT_EQ(a.tool_path_error_mm_max, b.tool_path_error_mm_max) << what;
  EXPECT_EQ(a.failed_s, b.failed_s) << what;
  EXPECT_EQ(a.cause, b.cause) << what;
  EXPECT_EQ(a.by, b.by) << what;
  EXPECT_EQ(a.reason, b.reason) << what;
  EXPECT_EQ(a.offsets, b.offsets) << what;
}

}  // namespace swivel::test
