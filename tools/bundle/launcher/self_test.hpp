// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <vector>

namespace inverse::bundle {

/// Runs a GoogleTest program in as many processes as there are processors, each again without the
/// tests that have run if one ends it. Prints a line for each test, what failed ones printed, and
/// at last "N passed, N failed", after which "N skipped" if some were. `command` is the program
/// with its first words; `filter` is as in --gtest_filter, empty for all tests. Returns the exit
/// status: 1 if one failed or none ran.
int self_test(const std::vector<std::string>& command, const std::string& filter);

}  // namespace inverse::bundle
