// SPDX-License-Identifier: LGPL-2.1-or-later
#include "corners_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "common/error.hpp"

namespace inverse {

std::optional<Corners> read_corners(const std::string& text) {
  constexpr const char* kBetween = " ,;\t\n";
  std::vector<double> numbers;
  for (size_t at = text.find_first_not_of(kBetween); at != std::string::npos;
       at = text.find_first_not_of(kBetween, at)) {
    const size_t end = std::min(text.find_first_of(kBetween, at), text.size());
    double number = 0;
    const auto [last, fault] = std::from_chars(text.data() + at, text.data() + end, number);
    if (fault != std::errc() || last != text.data() + end || !std::isfinite(number)) {
      numbers.clear();
      break;
    }
    numbers.push_back(number);
    at = end;
  }
  if (numbers.empty() && text.find_first_not_of(kBetween) == std::string::npos) return {};
  if (numbers.size() != 8)
    throw Error(ErrorKind::unsupported,
                " \"" + text.substr(0, 100) +
                    "\" is not four corners: give x,y of top left, top right, bottom right and "
                    "bottom left in pixels, \"10,20 200,20 200,150 10,150\" for example");
  Corners corners;
  for (size_t i = 0; i < 4; ++i) corners[i] = {numbers[2 * i], numbers[2 * i + 1]};
  return corners;
}

std::string text_of(const Corners& corners) {
  std::string text;
  for (const Point& p : corners)
    for (size_t k = 0; k < 2; ++k) {
      if (!text.empty()) text += k == 0 ? ' ' : ',';
      // In any locale. Four corners within kFarthest have few digits.
      std::array<char, 64> number{};
      const auto [end, fault] = std::to_chars(number.data(), number.data() + number.size(), p[k],
                                              std::chars_format::fixed, 2);
      if (fault == std::errc()) text.append(number.data(), end);
    }
  return text;
}

}  // namespace inverse
