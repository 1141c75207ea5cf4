// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <vector>

namespace inverse {

/// The order of files that have numbers in their names: 9 before 10. Where the numbers are times
/// with fractions, .933 comes before .95.
class NameOrder {
 public:
  /// For these names, without ".png". Their last numbers have fractions if every name has digits on
  /// both sides of the last dot, and none ends in 0 where the others have more or fewer digits
  /// behind it: fractions are written with a fixed number of digits, or without zeros at their end.
  explicit NameOrder(const std::vector<std::string>& names);
  bool operator()(const std::string& a, const std::string& b) const;
  /// The last number of a name, without zeros before it; the name if it has none.
  std::string number_of(const std::string& name) const;

 private:
  bool fractions_;
};

}  // namespace inverse
