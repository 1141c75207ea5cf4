// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <optional>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/image_format_pack_rgb.spv.hpp"
#include "kernels/image_format_pack_table.spv.hpp"
#include "kernels/image_format_pack_yuv.spv.hpp"
#include "kernels/image_format_unpack_rgb.spv.hpp"
#include "kernels/image_format_unpack_table.spv.hpp"
#include "kernels/image_format_unpack_yuv.spv.hpp"
#include "pixel_format.hpp"

namespace inverse {

/// Number of 32-bit words of a raw buffer for a frame: Buffer::create(device, Element::word,
/// raw_words(format), Memory::upload or readback).
uint64_t raw_words(const FrameFormat& format);

/// Converts the bytes of a frame to linear light in the frame's own primaries: rgb, 1 = white (of
/// PQ and HLG: reference white), w = alpha (1 if the format has none). Always finite and not
/// negative. Limited-range codes below black give 0; codes above white are kept: up to 1.3, PQ 119,
/// HLG 6.3.
class Unpack {
 public:
  /// Throws Error(unsupported) for formats that validate() rejects and for frames that are not
  /// word-aligned: copy those with copy_plane() to their aligned_layout() first.
  Unpack(const std::shared_ptr<gpu::Device>& device, const FrameFormat& format);
  /// `raw` holds the frame as at least raw_words() words; `linear` has the frame's extent.
  void record(gpu::Commands& commands, const gpu::BufferPtr& raw, const Plane& linear) const;
  const FrameFormat& format() const { return format_; }

 private:
  FrameFormat format_;
  std::optional<gpu::Program<shaders::image_format_unpack_rgb>> rgb_;  // one of the three
  std::optional<gpu::Program<shaders::image_format_unpack_yuv>> yuv_;
  std::optional<gpu::Program<shaders::image_format_unpack_table>> table_;
};

/// What to draw from planes.
struct Drawing {
  enum class Source : uint8_t {
    color,    ///< rgb
    shading,  ///< w, as gray
  };
  const Plane& picture;
  Source source = Source::color;
  float gain = 1;                ///< linear light is multiplied by it
  const Plane* alpha = nullptr;  ///< its w becomes the frame's alpha; without one it is opaque
};

/// Converts planes to the bytes of a frame: primaries, gain, transfer curve, matrix, chroma
/// averaging, rounding to nearest. NaN and negative values become black; values beyond the largest
/// code, and infinity, become that code. Pixels stay linear if the format's transfer is linear.
class Pack {
 public:
  /// Throws as Unpack does.
  Pack(const std::shared_ptr<gpu::Device>& device, const FrameFormat& format);
  /// Writes whole words: up to three padding bytes after a row may change, nothing else. To copy
  /// defined padding, fill a new `raw` once. `raw` as for Unpack; the planes have the frame's
  /// extent.
  void record(gpu::Commands& commands, const Drawing& drawing, const gpu::BufferPtr& raw) const;
  const FrameFormat& format() const { return format_; }

 private:
  FrameFormat format_;
  uint32_t across_;  // pixels of a row that an invocation draws
  std::optional<gpu::Program<shaders::image_format_pack_rgb>> rgb_;  // one of the three
  std::optional<gpu::Program<shaders::image_format_pack_yuv>> yuv_;
  std::optional<gpu::Program<shaders::image_format_pack_table>> table_;
};

}  // namespace inverse
