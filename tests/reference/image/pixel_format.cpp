// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pixel_format.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace inverse::reference {
namespace {

using Bytes = std::vector<std::byte>;
using F = PixelFormat;

uint64_t row(const FrameFormat& format, uint32_t plane, uint32_t y) {
  return format.offset[plane] + static_cast<uint64_t>(y) * format.stride[plane];
}
uint32_t get8(const Bytes& bytes, uint64_t at) { return std::to_integer<uint32_t>(bytes[at]); }
void set8(Bytes& bytes, uint64_t at, uint32_t code) { bytes[at] = static_cast<std::byte>(code); }
uint32_t get16(const Bytes& bytes, uint64_t at) {
  return get8(bytes, at) | get8(bytes, at + 1) << 8;
}
void set16(Bytes& bytes, uint64_t at, uint32_t code) {
  set8(bytes, at, code & 255);
  set8(bytes, at + 1, code >> 8);
}

/// Where the first byte of each code is.
using Places = std::vector<uint64_t>;

/// Of a pixel: (r, g, b, a), (r, g, b) or luma.
Places pixel_places(const FrameFormat& f, uint32_t x, uint32_t y) {
  const uint64_t start = row(f, 0, y);
  switch (f.format) {
    case F::rgba64_le:
      return {start + x * 8, start + x * 8 + 2, start + x * 8 + 4, start + x * 8 + 6};
    case F::rgba:
      return {start + x * 4, start + x * 4 + 1, start + x * 4 + 2, start + x * 4 + 3};
    case F::bgra:
      return {start + x * 4 + 2, start + x * 4 + 1, start + x * 4, start + x * 4 + 3};
    case F::rgbx:
      return {start + x * 4, start + x * 4 + 1, start + x * 4 + 2};
    case F::bgrx:
      return {start + x * 4 + 2, start + x * 4 + 1, start + x * 4};
    case F::rgb:
      return {start + x * 3, start + x * 3 + 1, start + x * 3 + 2};
    case F::bgr:
      return {start + x * 3 + 2, start + x * 3 + 1, start + x * 3};
    case F::gray8:
    case F::nv12:
    case F::i420:
      return {start + x};
    case F::uyvy:
      return {start + x * 2 + 1};
    default:  // 16 bits, or every second byte
      return {start + x * 2};
  }
}

/// Of a chroma sample: (u, v).
Places chroma_places(const FrameFormat& f, uint32_t x, uint32_t y) {
  switch (f.format) {
    case F::yuy2:
      return {row(f, 0, y) + x * 4 + 1, row(f, 0, y) + x * 4 + 3};
    case F::uyvy:
      return {row(f, 0, y) + x * 4, row(f, 0, y) + x * 4 + 2};
    case F::nv12:
      return {row(f, 1, y) + x * 2, row(f, 1, y) + x * 2 + 1};
    case F::p010_10le:
      return {row(f, 1, y) + x * 4, row(f, 1, y) + x * 4 + 2};
    case F::i420_10le:
      return {row(f, 1, y) + x * 2, row(f, 2, y) + x * 2};
    default:
      return {row(f, 1, y) + x, row(f, 2, y) + x};
  }
}

/// Codes of ten bits are the lower bits of 16, but the upper ones in P010.
Codes read(const FrameFormat& f, const Bytes& bytes, const Places& places) {
  Codes codes{};
  for (size_t k = 0; k < places.size(); ++k) {
    codes.value[k] = bit_depth(f.format) > 8 ? get16(bytes, places[k]) : get8(bytes, places[k]);
    if (f.format == F::p010_10le) codes.value[k] >>= 6;
    if (f.format == F::i420_10le) codes.value[k] &= 1023;
  }
  return codes;
}
void write(const FrameFormat& f, Bytes& bytes, const Places& places, const Codes& codes) {
  for (size_t k = 0; k < places.size(); ++k) {
    const uint32_t code = codes.value[k] << (f.format == F::p010_10le ? 6 : 0);
    bit_depth(f.format) > 8 ? set16(bytes, places[k], code) : set8(bytes, places[k], code);
  }
}

double top_code(const FrameFormat& f) {
  return std::ldexp(1.0, static_cast<int>(bit_depth(f.format))) - 1;
}
double luma_value(const FrameFormat& f, double code) {
  const double top = top_code(f), unit = (top + 1) / 256;
  return f.range == Range::full ? code / top : (code - 16 * unit) / (219 * unit);
}
double luma_code(const FrameFormat& f, double value) {
  const double top = top_code(f), unit = (top + 1) / 256;
  return f.range == Range::full ? value * top : value * 219 * unit + 16 * unit;
}
double chroma_value(const FrameFormat& f, double code) {
  const double top = top_code(f), unit = (top + 1) / 256;
  return (code - 128 * unit) / (f.range == Range::full ? top : 224 * unit);
}
double chroma_code(const FrameFormat& f, double value) {
  const double top = top_code(f), unit = (top + 1) / 256;
  return value * (f.range == Range::full ? top : 224 * unit) + 128 * unit;
}
uint32_t rounded(const FrameFormat& f, double code) {
  const double top = top_code(f);
  return static_cast<uint32_t>(std::floor(std::clamp(code, 0.0, top) + 0.5));
}

/// The samples under a position and their weights: linear interpolation, edges repeated.
struct Taps {
  uint32_t at[2];
  double weight[2];
};
Taps taps(double position, uint32_t count) {
  const double low = std::floor(position), part = position - low;
  const auto inside = [&](double i) {
    return static_cast<uint32_t>(std::clamp(i, 0.0, static_cast<double>(count - 1)));
  };
  return {{inside(low), inside(low + 1)}, {1 - part, part}};
}

/// The luma rows or columns that a chroma sample averages.
std::vector<std::pair<uint32_t, double>> average(uint32_t sample, bool cosited, bool halved,
                                                 uint32_t count) {
  if (!halved) return {{sample, 1.0}};
  const int64_t first = 2 * static_cast<int64_t>(sample);
  std::vector<std::pair<int64_t, double>> raw{{first, 0.5}, {first + 1, 0.5}};
  if (cosited) raw = {{first - 1, 0.25}, {first, 0.5}, {first + 1, 0.25}};
  std::vector<std::pair<uint32_t, double>> inside;
  for (const auto& [at, weight] : raw)
    inside.emplace_back(
        static_cast<uint32_t>(std::clamp<int64_t>(at, 0, static_cast<int64_t>(count) - 1)), weight);
  return inside;
}

bool halved_y(F format) { return format != F::yuy2 && format != F::uyvy; }

double clean(double value, double top) {
  if (std::isnan(value) || value < 0) return 0;
  return std::min(value, top);
}

}  // namespace

uint32_t components(F format) {
  switch (format) {
    case F::rgba:
    case F::bgra:
    case F::rgba64_le:
      return 4;
    case F::rgbx:
    case F::bgrx:
    case F::rgb:
    case F::bgr:
      return 3;
    default:
      return 1;
  }
}

Extent chroma_extent(const FrameFormat& f) {
  if (!is_yuv(f.format)) return {0, 0};
  return {(f.extent.width + 1) / 2,
          halved_y(f.format) ? (f.extent.height + 1) / 2 : f.extent.height};
}

Codes pixel_codes(const FrameFormat& f, const Bytes& bytes, uint32_t x, uint32_t y) {
  return read(f, bytes, pixel_places(f, x, y));
}

void set_pixel_codes(const FrameFormat& f, Bytes& bytes, uint32_t x, uint32_t y,
                     const Codes& codes) {
  write(f, bytes, pixel_places(f, x, y), codes);
  if (f.format == F::rgbx || f.format == F::bgrx) set8(bytes, row(f, 0, y) + x * 4 + 3, 255);
}

Codes chroma_codes_at(const FrameFormat& f, const Bytes& bytes, uint32_t x, uint32_t y) {
  return read(f, bytes, chroma_places(f, x, y));
}

void set_chroma_codes(const FrameFormat& f, Bytes& bytes, uint32_t x, uint32_t y,
                      const Codes& codes) {
  write(f, bytes, chroma_places(f, x, y), codes);
}

std::vector<double> unpack(const FrameFormat& f, const Bytes& bytes) {
  const auto [width, height] = f.extent;
  const Extent chroma = chroma_extent(f);
  const double kr = f.matrix.kr, kb = f.matrix.kb, kg = 1 - kr - kb;
  const double alpha_top = top_code(f);
  const double ceiling = luma_value(f, alpha_top);
  std::vector<double> linear(static_cast<size_t>(width) * height * 4);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const Codes codes = pixel_codes(f, bytes, x, y);
      double rgb[3], alpha = 1;
      if (is_yuv(f.format)) {
        const Taps across = taps(f.site.cosited_x ? x / 2.0 : (x - 0.5) / 2, chroma.width);
        const Taps down = !halved_y(f.format)
                              ? taps(y, chroma.height)
                              : taps(f.site.cosited_y ? y / 2.0 : (y - 0.5) / 2, chroma.height);
        double cb = 0, cr = 0;
        for (int j = 0; j < 2; ++j)
          for (int i = 0; i < 2; ++i) {
            const Codes c = chroma_codes_at(f, bytes, across.at[i], down.at[j]);
            cb += across.weight[i] * down.weight[j] * chroma_value(f, c.value[0]);
            cr += across.weight[i] * down.weight[j] * chroma_value(f, c.value[1]);
          }
        const double luma = luma_value(f, codes.value[0]);
        rgb[0] = luma + 2 * (1 - kr) * cr;
        rgb[2] = luma + 2 * (1 - kb) * cb;
        rgb[1] = (luma - kr * rgb[0] - kb * rgb[2]) / kg;
      } else {
        const bool gray = components(f.format) == 1;
        for (int c = 0; c < 3; ++c) rgb[c] = luma_value(f, codes.value[gray ? 0 : c]);
        if (components(f.format) == 4) alpha = codes.value[3] / alpha_top;
      }
      double* pixel = &linear[(static_cast<size_t>(y) * width + x) * 4];
      for (int c = 0; c < 3; ++c) pixel[c] = f.transfer.decode(std::clamp(rgb[c], 0.0, ceiling));
      pixel[3] = alpha;
    }
  return linear;
}

Bytes pack(const FrameFormat& f, const std::vector<float>& picture, bool shading, float gain,
           const std::vector<float>* alpha) {
  const auto [width, height] = f.extent;
  const double top = top_code(f);
  const double ceiling = f.transfer.decode(luma_value(f, top));
  const Matrix matrix = f.matrix.is_identity() ? Matrix::bt709() : f.matrix;
  const double kr = matrix.kr, kb = matrix.kb, kg = 1 - kr - kb;
  Bytes bytes(frame_bytes(f));
  std::vector<std::array<double, 3>> encoded(static_cast<size_t>(width) * height);
  std::vector<double> luma(encoded.size());
  for (size_t i = 0; i < encoded.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double value = static_cast<double>(picture[i * 4 + (shading ? 3 : c)]) * gain;
      encoded[i][c] = f.transfer.encode(clean(value, ceiling));
    }
    luma[i] = kr * encoded[i][0] + kg * encoded[i][1] + kb * encoded[i][2];
  }
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      Codes codes{};
      if (components(f.format) == 1) {
        codes.value[0] = rounded(f, luma_code(f, luma[i]));
      } else {
        for (int c = 0; c < 3; ++c) codes.value[c] = rounded(f, luma_code(f, encoded[i][c]));
        codes.value[3] = rounded(f, top * (alpha ? clean((*alpha)[i * 4 + 3], 1) : 1));
      }
      set_pixel_codes(f, bytes, x, y, codes);
    }
  const Extent chroma = chroma_extent(f);
  for (uint32_t y = 0; y < chroma.height; ++y)
    for (uint32_t x = 0; x < chroma.width; ++x) {
      double cb = 0, cr = 0;
      for (const auto& [v, down] : average(y, f.site.cosited_y, halved_y(f.format), height))
        for (const auto& [u, across] : average(x, f.site.cosited_x, true, width)) {
          const size_t i = static_cast<size_t>(v) * width + u;
          cb += down * across * (encoded[i][2] - luma[i]) / (2 * (1 - kb));
          cr += down * across * (encoded[i][0] - luma[i]) / (2 * (1 - kr));
        }
      set_chroma_codes(f, bytes, x, y,
                       {{rounded(f, chroma_code(f, cb)), rounded(f, chroma_code(f, cr))}});
    }
  return bytes;
}

}  // namespace inverse::reference
