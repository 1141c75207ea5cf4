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
  pq,      ///< SMPTE ST 2084, display light
  hlg,     ///< ARIB STD-B67, scene light: without the system gamma
  log100,  ///< unsupported
  log316,  ///< unsupported
};

/// Luminance of the reference white, linear light 1, in cd/m² (ITU-R BT.2408), and the HLG signal
/// that has it.
inline constexpr double kReferenceWhite = 203;
inline constexpr double kHlgReferenceWhite = 0.75;

/// A transfer curve from the encoded value x (0 black, 1 nominal white) to linear light, 1 =
/// reference white. `power` is `slope·x` if x < start, else `(scale·x + offset)^power`; pq and hlg
/// are the standards' (ITU-R BT.2100), with a peak of 49.3 and 3.77. Increasing, so encode() is its
/// exact inverse; values above 1 follow the upper branch.
struct Transfer {
  enum class Curve : uint8_t { power, pq, hlg };
  Curve curve = Curve::power;
  float start = 0, slope = 1, scale = 1, offset = 0, power = 1;
  bool operator==(const Transfer&) const = default;
  bool is_linear() const {
    return curve == Curve::power && start == 0 && scale == 1 && offset == 0 && power == 1;
  }

  /// The curve of a named function. Uses H.273's exact constants: the rounded ones of older
  /// standards (1.099, 0.018) leave a step between the branches and have no inverse; the difference
  /// is below 1e-4. Throws Error(unsupported) for log100 and log316.
  static Transfer of(TransferFunction function);

  double decode(double encoded) const;  ///< to linear light
  double encode(double linear) const;   ///< its inverse
  /// Linear value at which encode() of a power curve changes branch.
  double linear_start() const;
};

}  // namespace inverse
