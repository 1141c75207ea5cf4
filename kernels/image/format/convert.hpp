#pragma once
#include <cstdint>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/image/tiles/tile_list.hpp"
#include "kernels/image_format_pack_rgb.spv.hpp"
#include "kernels/image_format_pack_yuv.spv.hpp"
#include "kernels/image_format_unpack_rgb.spv.hpp"
#include "kernels/image_format_unpack_yuv.spv.hpp"
#include "pixel_format.hpp"

namespace inverse {

/// How many 32-bit words a raw buffer needs for a frame: Buffer::create(device, Element::word,
/// raw_words(format), Memory::upload or readback).
uint64_t raw_words(const FrameFormat& format);

/// Turns the bytes of a frame into linear light: rgb in [0, 1] of nominal white, w = alpha (1 where
/// the format has none). Always finite. Where limited range undershoots black the result is 0;
/// above white it is kept up to the largest code (below 1.3 for every curve).
class Unpack {
 public:
  /// Throws Error(unsupported) for what validate() refuses and for frames that are not
  /// word-aligned: copy_plane() those to their aligned_layout() and unpack that.
  Unpack(const std::shared_ptr<gpu::Device>& device, const FrameFormat& format);
  /// `raw` holds the frame as words, raw_words() of them or more; `linear` has the frame's extent.
  /// Where tiles are `listed`, only these are written.
  void record(gpu::Commands& commands, const gpu::BufferPtr& raw, const Plane& linear,
              const TileList* listed = nullptr) const;
  const FrameFormat& format() const { return format_; }

 private:
  FrameFormat format_;
  TileProgram<shaders::image_format_unpack_yuv> yuv_;  // one of the two
  TileProgram<shaders::image_format_unpack_rgb> rgb_;
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

/// Draws planes into the bytes of a frame: gain, transfer curve, matrix, chroma averaging, rounding
/// to nearest. NaN and negative values become black, values beyond the largest code (infinity too)
/// that code. Pixels stay linear where the format's transfer is linear.
class Pack {
 public:
  /// Throws as Unpack does.
  Pack(const std::shared_ptr<gpu::Device>& device, const FrameFormat& format);
  /// Writes whole words: up to three bytes of padding behind a row may change, nothing else beside
  /// the frame does; who copies padding along fills a new `raw` once, so that it is defined. `raw`
  /// as for Unpack; the planes have the frame's extent. Where tiles are `listed`, only these are
  /// written.
  void record(gpu::Commands& commands, const Drawing& drawing, const gpu::BufferPtr& raw,
              const TileList* listed = nullptr) const;
  const FrameFormat& format() const { return format_; }

 private:
  FrameFormat format_;
  TileProgram<shaders::image_format_pack_yuv> yuv_;  // one of the two
  TileProgram<shaders::image_format_pack_rgb> rgb_;
};

}  // namespace inverse
