// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

namespace inverse {

/// A control point of a tone curve: shading before and after, in stops (log2) above or below middle
/// shading.
struct CurvePoint {
  float x, y;
  bool operator==(const CurvePoint&) const = default;
};
/// In ascending order of x; empty: the identity.
using ToneCurve = std::vector<CurvePoint>;

constexpr size_t kMinCurvePoints = 2, kMaxCurvePoints = 16;
constexpr float kMaxCurveStops = 20;       ///< of a coordinate, either sign
constexpr float kMinCurveSpacing = .001F;  ///< of two points, stops

/// Reads "x,y x,y …" or "x:y/x:y …", in any order; an empty text is the identity. Throws
/// Error(unsupported) if it is something else, has fewer than kMinCurvePoints or more than
/// kMaxCurvePoints points, two that are nearer than kMinCurveSpacing, or numbers beyond
/// kMaxCurveStops.
ToneCurve parse_curve(const std::string& text);

/// Whether the curve changes nothing.
bool is_identity(const ToneCurve& curve);

/// The points with the slopes of the monotone cubic interpolation (Fritsch and Carlson 1980): x, y,
/// dy/dx, 0. The curve does not overshoot its points, and is monotone where they are.
std::vector<std::array<float, 4>> curve_knots(const ToneCurve& curve);

}  // namespace inverse
