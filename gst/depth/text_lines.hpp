// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace inverse {

/// The number that a word is; nothing if it is none, or not finite.
std::optional<double> finite_number(std::string_view word);
/// The same of a time in seconds, of which differences can be taken.
std::optional<double> time_number(std::string_view word);

using Words = std::vector<std::string_view>;

/// Calls `take` with the words of each line of a text file that is neither empty nor a comment (#).
/// Lines for which it returns false become one warning; `expected` says what a line is. Throws
/// Error(file) if the file cannot be read.
void read_lines(const std::string& path, const char* expected, std::vector<std::string>& warnings,
                const std::function<bool(const Words&)>& take);

/// Sorts what was read from `path` by `seconds`, and leaves out what has the time of another.
template <typename Entry>
void order_by_time(std::vector<Entry>& entries, const std::string& path,
                   std::vector<std::string>& warnings) {
  if (!std::ranges::is_sorted(entries, {}, &Entry::seconds)) {
    warnings.push_back(path + ": its times go back; its lines are taken in the order of time");
    std::ranges::stable_sort(entries, {}, &Entry::seconds);
  }
  const auto same = std::unique(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.seconds == b.seconds;
  });
  if (same != entries.end())
    warnings.push_back(path + ": lines with the time of another: " +
                       std::to_string(entries.end() - same) + "; the first of each time is taken");
  entries.erase(same, entries.end());
}

}  // namespace inverse
