// SPDX-License-Identifier: LGPL-2.1-or-later
#include "name_order.hpp"

#include <algorithm>
#include <cstring>
#include <string_view>

namespace inverse {
namespace {

constexpr const char* kDigits = "0123456789";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The digits behind the last dot of a name that has digits on both sides of it; empty if it has
/// none.
std::string_view fraction_of(std::string_view name) {
  const size_t dot = name.find_last_of('.');
  if (dot == name.npos || dot == 0 || !is_digit(name[dot - 1])) return {};
  const size_t end = std::min(name.find_first_not_of(kDigits, dot + 1), name.size());
  return name.substr(dot + 1, end - dot - 1);
}

bool have_fractions(const std::vector<std::string>& names) {
  if (names.empty()) return false;
  const size_t digits = fraction_of(names.front()).size();
  bool fixed = true, zero_at_end = false;
  for (const std::string& name : names) {
    const std::string_view fraction = fraction_of(name);
    if (fraction.empty()) return false;
    fixed &= fraction.size() == digits;
    zero_at_end |= fraction.size() > 1 && fraction.back() == '0';
  }
  return fixed || !zero_at_end;
}

}  // namespace

NameOrder::NameOrder(const std::vector<std::string>& names) : fractions_(have_fractions(names)) {}

bool NameOrder::operator()(const std::string& a, const std::string& b) const {
  if (fractions_) {
    const size_t dot_a = a.find_last_of('.'), dot_b = b.find_last_of('.');
    const int before = strverscmp(a.substr(0, dot_a).c_str(), b.substr(0, dot_b).c_str());
    if (before != 0) return before < 0;
    if (const auto one = fraction_of(a), other = fraction_of(b); one != other) return one < other;
  }
  return strverscmp(a.c_str(), b.c_str()) < 0;
}

std::string NameOrder::number_of(const std::string& name) const {
  const size_t last = name.find_last_of(kDigits);
  if (last == name.npos) return name;
  const size_t before = name.find_last_not_of(fractions_ ? "0123456789." : kDigits, last);
  size_t first = before == name.npos ? 0 : before + 1;
  while (first < last && (name[first] == '0' || name[first] == '.')) ++first;
  return name.substr(first, last - first + 1);
}

}  // namespace inverse
