// SPDX-License-Identifier: LGPL-2.1-or-later
#include "curve.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "common/error.hpp"
#include "common/number_text.hpp"

namespace inverse {
namespace {

/// Whether it may stand between points.
bool is_gap(char c) { return c != '\0' && std::strchr(" \t\r\n/", c) != nullptr; }

/// Reads a number at `at` and moves behind it.
float number_at(const char*& at, const char* end, const std::string& text) {
  float value = 0;
  const auto [behind, error] = std::from_chars(at, end, value);
  if (error != std::errc() || !(std::abs(value) <= kMaxCurveStops))
    throw Error(ErrorKind::unsupported,
                "curve=\"" + text + "\" has no number from -20 to 20 at character " +
                    std::to_string(at - text.data() + 1) +
                    "; write points as x,y in stops, with spaces between: \"-3,-3 0,0 2,1\"");
  at = behind;
  return value;
}

}  // namespace

ToneCurve parse_curve(const std::string& text) {
  ToneCurve curve;
  const char* const end = text.data() + text.size();
  for (const char* at = text.data();;) {
    while (at < end && is_gap(*at)) ++at;
    if (at == end) break;
    CurvePoint point{};
    point.x = number_at(at, end, text);
    if (at == end || (*at != ',' && *at != ':'))
      throw Error(ErrorKind::unsupported,
                  "curve=\"" + text + "\": point " + std::to_string(curve.size() + 1) +
                      " has no y; write points as x,y in stops: \"-3,-3 0,0 2,1\"");
    point.y = number_at(++at, end, text);
    if (at < end && !is_gap(*at))
      throw Error(ErrorKind::unsupported, "curve=\"" + text + "\": put a space behind point " +
                                              std::to_string(curve.size() + 1));
    curve.push_back(point);
    if (curve.size() > kMaxCurvePoints)
      throw Error(ErrorKind::unsupported,
                  "curve has more than " + std::to_string(kMaxCurvePoints) +
                      " points; leave out those that lie on the curve through the others");
  }
  if (!curve.empty() && curve.size() < kMinCurvePoints)
    throw Error(ErrorKind::unsupported,
                "curve=\"" + text + "\" has one point; give two or more, or none for no change");
  std::sort(curve.begin(), curve.end(),
            [](const CurvePoint& a, const CurvePoint& b) { return a.x < b.x; });
  for (size_t i = 1; i < curve.size(); ++i)
    if (curve[i].x - curve[i - 1].x < kMinCurveSpacing)
      throw Error(ErrorKind::unsupported,
                  "curve=\"" + text + "\" has two points at x=" + number_text(double{curve[i].x}) +
                      "; move them at least 0.001 stops apart, or remove one");
  return curve;
}

bool is_identity(const ToneCurve& curve) {
  return std::all_of(curve.begin(), curve.end(), [](const CurvePoint& p) { return p.x == p.y; });
}

std::vector<std::array<float, 4>> curve_knots(const ToneCurve& curve) {
  const size_t count = curve.size();
  std::vector<double> secants(count), slopes(count);
  for (size_t i = 0; i + 1 < count; ++i)
    secants[i] = (double{curve[i + 1].y} - curve[i].y) / (double{curve[i + 1].x} - curve[i].x);
  if (count > 1) {
    slopes[0] = secants[0];
    slopes[count - 1] = secants[count - 2];
  }
  // At an extremum of the points, the curve is level.
  for (size_t i = 1; i + 1 < count; ++i)
    slopes[i] = secants[i - 1] * secants[i] > 0 ? (secants[i - 1] + secants[i]) / 2 : 0;
  for (size_t i = 0; i + 1 < count; ++i) {
    if (secants[i] == 0) {
      slopes[i] = slopes[i + 1] = 0;
      continue;
    }
    const double length = std::hypot(slopes[i], slopes[i + 1]) / std::abs(secants[i]);
    if (length <= 3) continue;  // inside the circle in which a cubic is monotone
    slopes[i] *= 3 / length;
    slopes[i + 1] *= 3 / length;
  }
  std::vector<std::array<float, 4>> knots(count);
  for (size_t i = 0; i < count; ++i)
    knots[i] = {curve[i].x, curve[i].y, static_cast<float>(slopes[i]), 0};
  return knots;
}

}  // namespace inverse
