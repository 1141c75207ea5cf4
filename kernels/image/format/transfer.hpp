// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

namespace inverse {

/// The transfer functions of video (ITU-T H.273 table 3 and GStreamer's gammas).
enum class TransferFunction : uint8_t {
  linear,
  srgb,   ///< IEC 61966-2-1
  bt709,  ///< also BT.601 and BT.2020, which H.273 defines by the same equation
  smpte240m,
  adobe_rgb,  ///< gamma 563/256
  gamma18,
  gamma20,
  gamma22,
  gamma28,
  pq,      ///< SMPTE ST 2084: unsupported
  hlg,     ///< ARIB STD-B67: unsupported
  log100,  ///< unsupported
  log316,  ///< unsupported
};

/// A transfer curve from the encoded value x (0 black, 1 nominal white) to linear light: `slope·x`
/// if x < start, else `(scale·x + offset)^power`. Strictly increasing, so encode() is its exact
/// inverse; values above 1 follow the power branch.
struct Transfer {
  float start = 0, slope = 1, scale = 1, offset = 0, power = 1;
  bool operator==(const Transfer&) const = default;
  bool is_linear() const { return start == 0 && scale == 1 && offset == 0 && power == 1; }

  /// The curve of a named function. Uses H.273's exact constants: the rounded ones of older
  /// standards (1.099, 0.018) leave a step between the branches and have no inverse; the difference
  /// is below 1e-4. Throws Error(unsupported) for pq, hlg, log100 and log316.
  static Transfer of(TransferFunction function);

  double decode(double encoded) const;  ///< to linear light
  double encode(double linear) const;   ///< its inverse
  /// Linear value at which encode() changes branch.
  double linear_start() const;
};

}  // namespace inverse
