// SPDX-License-Identifier: LGPL-2.1-or-later
#include "transfer.hpp"

#include <cmath>
#include <string>

#include "common/error.hpp"

namespace inverse {
namespace {

/// Camera curves in the notation of the standards: V = alpha·L^0.45 - (alpha - 1) for L ≥ beta,
/// slope·L below.
Transfer camera(double alpha, double beta, double slope) {
  Transfer curve;
  curve.start = static_cast<float>(slope * beta);
  curve.slope = static_cast<float>(1 / slope);
  curve.scale = static_cast<float>(1 / alpha);
  curve.offset = static_cast<float>((alpha - 1) / alpha);
  curve.power = static_cast<float>(1 / 0.45);
  return curve;
}

Transfer gamma(double power) {
  Transfer curve;
  curve.power = static_cast<float>(power);
  return curve;
}

[[noreturn]] void refuse(const char* name) {
  throw Error(ErrorKind::unsupported,
              std::string("the transfer function ") + name +
                  " is not supported; convert to BT.709 or sRGB first, for example with "
                  "videoconvert and caps such as video/x-raw,colorimetry=bt709");
}

}  // namespace

Transfer Transfer::of(TransferFunction function) {
  switch (function) {
    case TransferFunction::linear:
      return {};
    case TransferFunction::srgb: {
      Transfer curve;
      curve.start = 0.04045f;
      curve.slope = static_cast<float>(1 / 12.92);
      curve.scale = static_cast<float>(1 / 1.055);
      curve.offset = static_cast<float>(0.055 / 1.055);
      curve.power = 2.4f;
      return curve;
    }
    case TransferFunction::bt709:
      return camera(1.09929682680944, 0.018053968510807, 4.5);
    case TransferFunction::smpte240m:
      return camera(1.111572195921731, 0.022821585529445, 4.0);
    case TransferFunction::adobe_rgb:
      return gamma(563.0 / 256.0);
    case TransferFunction::gamma18:
      return gamma(1.8);
    case TransferFunction::gamma20:
      return gamma(2.0);
    case TransferFunction::gamma22:
      return gamma(2.2);
    case TransferFunction::gamma28:
      return gamma(2.8);
    case TransferFunction::pq:
      refuse("PQ (SMPTE ST 2084)");
    case TransferFunction::hlg:
      refuse("HLG (ARIB STD-B67)");
    case TransferFunction::log100:
      refuse("logarithmic 100:1");
    case TransferFunction::log316:
      refuse("logarithmic 316.22777:1");
  }
  throw Error(ErrorKind::internal, "unknown transfer function");
}

double Transfer::decode(double encoded) const {
  return encoded < start ? slope * encoded : std::pow(scale * encoded + offset, power);
}

double Transfer::linear_start() const {
  return start > 0 ? std::pow(scale * static_cast<double>(start) + offset, power) : 0;
}

double Transfer::encode(double linear) const {
  return linear < linear_start() ? linear / slope
                                 : (std::pow(linear, 1.0 / power) - offset) / scale;
}

}  // namespace inverse
