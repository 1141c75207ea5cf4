// SPDX-License-Identifier: LGPL-2.1-or-later
// Texts of tone curves: an Error, or points in order with finite slopes.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/error.hpp"
#include "kernels/edit/tone/curve.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  ToneCurve curve;
  try {
    curve = parse_curve({reinterpret_cast<const char*>(data), size});
  } catch (const Error&) {
    return 0;
  }
  if (curve.size() == 1 || curve.size() > kMaxCurvePoints) abort();
  for (size_t i = 1; i < curve.size(); ++i)
    if (!(curve[i].x - curve[i - 1].x >= kMinCurveSpacing)) abort();
  for (const auto& knot : curve_knots(curve))
    for (const float number : knot)
      if (!std::isfinite(number)) abort();
  return 0;
}
