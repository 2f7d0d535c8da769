// SPDX-License-Identifier: BSD-3-Clause
// Nothing: the target swivel_test_headers needs a source to compile the headers of all test
// programs for.
