// SPDX-License-Identifier: LGPL-2.1-or-later
#include "transfer.hpp"

#include <algorithm>
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

/// SMPTE ST 2084: light of 1 is kPqPeak cd/m².
constexpr double kM1 = 2610.0 / 16384, kM2 = 2523.0 / 4096 * 128, kC1 = 3424.0 / 4096,
                 kC2 = 2413.0 / 4096 * 32, kC3 = 2392.0 / 4096 * 32, kPqPeak = 10000;

double decode_pq(double encoded) {
  const double root = std::pow(std::max(encoded, 0.0), 1 / kM2);
  return std::pow(std::max(root - kC1, 0.0) / (kC2 - kC3 * root), 1 / kM1);
}
double encode_pq(double light) {
  const double root = std::pow(std::max(light, 0.0), kM1);
  return std::pow((kC1 + kC2 * root) / (1 + kC3 * root), kM2);
}

/// ITU-R BT.2100, table 5: the inverse of the HLG OETF, scene light 0…1.
constexpr double kA = 0.17883277, kB = 1 - 4 * kA;
const double kC = 0.5 - kA * std::log(4 * kA);

double decode_hlg(double encoded) {
  return encoded <= 0.5 ? encoded * encoded / 3 : (std::exp((encoded - kC) / kA) + kB) / 12;
}
double encode_hlg(double light) {
  return light <= 1.0 / 12 ? std::sqrt(3 * std::max(light, 0.0))
                           : kA * std::log(12 * light - kB) + kC;
}

[[noreturn]] void refuse(const char* name) {
  throw Error(ErrorKind::unsupported,
              std::string("the transfer function ") + name +
                  " is not supported; convert to BT.709 or sRGB first, for example with "
                  "videoconvert gamma-mode=remap and caps such as video/x-raw,colorimetry=bt709");
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
    case TransferFunction::hlg: {
      Transfer curve;
      curve.curve = function == TransferFunction::pq ? Transfer::Curve::pq : Transfer::Curve::hlg;
      return curve;
    }
    case TransferFunction::log100:
      refuse("logarithmic 100:1");
    case TransferFunction::log316:
      refuse("logarithmic 316.22777:1");
  }
  throw Error(ErrorKind::internal, "unknown transfer function");
}

double Transfer::decode(double encoded) const {
  switch (curve) {
    case Curve::pq:
      return decode_pq(encoded) * kPqPeak / kReferenceWhite;
    case Curve::hlg:
      return decode_hlg(encoded) / decode_hlg(kHlgReferenceWhite);
    case Curve::power:
      break;
  }
  return encoded < start ? slope * encoded : std::pow(scale * encoded + offset, power);
}

double Transfer::linear_start() const {
  return start > 0 ? std::pow(scale * static_cast<double>(start) + offset, power) : 0;
}

double Transfer::encode(double linear) const {
  switch (curve) {
    case Curve::pq:
      return encode_pq(linear * kReferenceWhite / kPqPeak);
    case Curve::hlg:
      return encode_hlg(linear * decode_hlg(kHlgReferenceWhite));
    case Curve::power:
      break;
  }
  return linear < linear_start() ? linear / slope
                                 : (std::pow(linear, 1.0 / power) - offset) / scale;
}

}  // namespace inverse
