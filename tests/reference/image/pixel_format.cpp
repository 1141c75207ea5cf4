// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pixel_format.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace inverse::reference {
namespace {

using Bytes = std::vector<std::byte>;

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

/// The unit that sample i of a component in row y lies in: its first byte and, of thirds, its first
/// bit.
struct Place {
  uint64_t byte;
  uint32_t bit;
};
Place place(const FrameFormat& f, size_t component, uint32_t i, uint32_t y) {
  const Component& c = f.format.components[component];
  const uint64_t start = row(f, c.plane, y), unit = c.offset + static_cast<uint64_t>(i) * c.stride;
  if (f.format.unit == Unit::thirds)
    return {start + unit / 3 * 4, static_cast<uint32_t>(unit % 3) * 10};
  return {start + unit, 0};
}

uint32_t get(Unit unit, const Bytes& bytes, uint64_t at) {
  switch (unit) {
    case Unit::byte:
      return get8(bytes, at);
    case Unit::le16:
      return get16(bytes, at);
    case Unit::be16:
      return get8(bytes, at) << 8 | get8(bytes, at + 1);
    case Unit::be32:
      return get8(bytes, at) << 24 | get8(bytes, at + 1) << 16 | get8(bytes, at + 2) << 8 |
             get8(bytes, at + 3);
    default:
      return get16(bytes, at) | get16(bytes, at + 2) << 16;
  }
}

void set(Unit unit, Bytes& bytes, uint64_t at, uint32_t value) {
  switch (unit) {
    case Unit::byte:
      return set8(bytes, at, value);
    case Unit::le16:
      return set16(bytes, at, value);
    case Unit::be16:
      set8(bytes, at, value >> 8);
      return set8(bytes, at + 1, value & 255);
    case Unit::be32:
      for (int i = 0; i < 4; ++i) set8(bytes, at + i, value >> (24 - 8 * i) & 255);
      return;
    default:
      set16(bytes, at, value & 65535);
      set16(bytes, at + 2, value >> 16);
  }
}

double top_of(const FrameFormat& f, size_t component) {
  return std::ldexp(1.0, f.format.components[component].depth) - 1;
}

uint32_t read(const FrameFormat& f, const Bytes& bytes, size_t component, uint32_t i, uint32_t y) {
  const Place at = place(f, component, i, y);
  return get(f.format.unit, bytes, at.byte) >> (f.format.components[component].shift + at.bit) &
         static_cast<uint32_t>(top_of(f, component));
}

/// Sets the bits of one code, and no others.
void write(const FrameFormat& f, Bytes& bytes, size_t component, uint32_t i, uint32_t y,
           uint32_t code) {
  const Place at = place(f, component, i, y);
  const uint32_t shift = f.format.components[component].shift + at.bit;
  const uint32_t mask = static_cast<uint32_t>(top_of(f, component)) << shift;
  set(f.format.unit, bytes, at.byte,
      (get(f.format.unit, bytes, at.byte) & ~mask) | (code << shift & mask));
}

double top_code(const FrameFormat& f) { return top_of(f, 0); }
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
uint32_t rounded(double code, double top) {
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

/// The luma rows or columns that a chroma sample averages: the pixels it spans, or those up to its
/// neighbors, the nearer the more.
std::vector<std::pair<uint32_t, double>> average(uint32_t sample, bool cosited, uint32_t times,
                                                 uint32_t count) {
  const int64_t size = int64_t{1} << times, first = size * sample;
  std::vector<std::pair<uint32_t, double>> inside;
  for (int64_t i = cosited ? 1 - size : 0; i < size; ++i) {
    const double weight =
        cosited ? (1 - std::abs(static_cast<double>(i)) / size) / size : 1.0 / size;
    inside.emplace_back(
        static_cast<uint32_t>(std::clamp<int64_t>(first + i, 0, static_cast<int64_t>(count) - 1)),
        weight);
  }
  return inside;
}

/// Where a pixel is among the chroma samples.
double chroma_position(uint32_t pixel, bool cosited, uint32_t times) {
  const double size = std::ldexp(1.0, static_cast<int>(times));
  return (pixel - (cosited ? 0 : (size - 1) / 2)) / size;
}

double clean(double value, double top) {
  if (std::isnan(value) || value < 0) return 0;
  return std::min(value, top);
}

}  // namespace

uint32_t components(const PixelFormat& format) {
  if (format.model != PixelFormat::Model::rgb) return 1;
  return 3;
}

Extent chroma_extent(const FrameFormat& f) {
  if (!is_yuv(f.format)) return {0, 0};
  const uint32_t across = 1u << f.format.w_sub, down = 1u << f.format.h_sub;
  return {(f.extent.width + across - 1) / across, (f.extent.height + down - 1) / down};
}

Codes pixel_codes(const FrameFormat& f, const Bytes& bytes, uint32_t x, uint32_t y) {
  Codes codes{};
  for (uint32_t c = 0; c < components(f.format); ++c) codes.value[c] = read(f, bytes, c, x, y);
  if (f.format.components[3].depth > 0) codes.value[3] = read(f, bytes, 3, x, y);
  return codes;
}

void set_pixel_codes(const FrameFormat& f, Bytes& bytes, uint32_t x, uint32_t y,
                     const Codes& codes) {
  for (uint32_t c = 0; c < components(f.format); ++c) write(f, bytes, c, x, y, codes.value[c]);
  if (f.format.components[3].depth > 0) write(f, bytes, 3, x, y, codes.value[3]);
}

Codes chroma_codes_at(const FrameFormat& f, const Bytes& bytes, uint32_t x, uint32_t y) {
  return {{read(f, bytes, 1, x, y), read(f, bytes, 2, x, y)}};
}

void set_chroma_codes(const FrameFormat& f, Bytes& bytes, uint32_t x, uint32_t y,
                      const Codes& codes) {
  for (uint32_t c = 0; c < 2; ++c) write(f, bytes, c + 1, x, y, codes.value[c]);
}

std::vector<double> unpack(const FrameFormat& f, const Bytes& bytes) {
  const auto [width, height] = f.extent;
  const Extent chroma = chroma_extent(f);
  const double kr = f.matrix.kr, kb = f.matrix.kb, kg = 1 - kr - kb;
  const double ceiling = luma_value(f, top_code(f));
  std::vector<double> linear(static_cast<size_t>(width) * height * 4);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const Codes codes = pixel_codes(f, bytes, x, y);
      double rgb[3], alpha = 1;
      if (is_yuv(f.format)) {
        const Taps across =
            taps(chroma_position(x, f.site.cosited_x, f.format.w_sub), chroma.width);
        const Taps down = taps(chroma_position(y, f.site.cosited_y, f.format.h_sub), chroma.height);
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
        for (size_t c = 0; c < 3; ++c) {
          const size_t of = components(f.format) == 1 ? 0 : c;
          rgb[c] = luma_value(f, codes.value[of] * top_code(f) / top_of(f, of));
        }
      }
      if (f.format.alpha) alpha = codes.value[3] / top_of(f, 3);
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
    double linear[3];
    for (int c = 0; c < 3; ++c) linear[c] = picture[i * 4 + (shading ? 3 : c)];
    if (!f.gamut.is_identity()) {
      const auto& m = f.gamut.matrix;
      for (double& value : linear) value = clean(value, 65504);
      const std::array<double, 3> v{linear[0], linear[1], linear[2]};
      for (int c = 0; c < 3; ++c)
        linear[c] = m[3 * c] * v[0] + m[3 * c + 1] * v[1] + m[3 * c + 2] * v[2];
    }
    for (int c = 0; c < 3; ++c) encoded[i][c] = f.transfer.encode(clean(linear[c] * gain, ceiling));
    luma[i] = kr * encoded[i][0] + kg * encoded[i][1] + kb * encoded[i][2];
  }
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      Codes codes{};
      if (components(f.format) == 1) {
        codes.value[0] = rounded(luma_code(f, luma[i]), top);
      } else {
        for (int c = 0; c < 3; ++c)
          codes.value[c] = rounded(luma_code(f, encoded[i][c]) * top_of(f, c) / top, top_of(f, c));
      }
      const double opacity = alpha && f.format.alpha ? clean((*alpha)[i * 4 + 3], 1) : 1;
      codes.value[3] = rounded(top_of(f, 3) * opacity, top_of(f, 3));
      set_pixel_codes(f, bytes, x, y, codes);
    }
  const Extent chroma = chroma_extent(f);
  for (uint32_t y = 0; y < chroma.height; ++y)
    for (uint32_t x = 0; x < chroma.width; ++x) {
      double cb = 0, cr = 0;
      for (const auto& [v, down] : average(y, f.site.cosited_y, f.format.h_sub, height))
        for (const auto& [u, across] : average(x, f.site.cosited_x, f.format.w_sub, width)) {
          const size_t i = static_cast<size_t>(v) * width + u;
          cb += down * across * (encoded[i][2] - luma[i]) / (2 * (1 - kb));
          cr += down * across * (encoded[i][0] - luma[i]) / (2 * (1 - kr));
        }
      set_chroma_codes(f, bytes, x, y,
                       {{rounded(chroma_code(f, cb), top), rounded(chroma_code(f, cr), top)}});
    }
  return bytes;
}

}  // namespace inverse::reference
