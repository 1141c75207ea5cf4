// SPDX-License-Identifier: LGPL-2.1-or-later
#include "jpeg_pixels.hpp"

#include <csetjmp>
#include <cstdio>
// After cstdio, which it needs.
#include <jpeglib.h>
// After jpeglib.h.
#include <jerror.h>

#include <array>

namespace inverse {
namespace {

/// A file that libjpeg reads. It must not be left by an exception: its errors jump.
class Jpeg {
 public:
  Jpeg() {
    info_.err = jpeg_std_error(&errors_);
    info_.client_data = this;
    errors_.error_exit = [](j_common_ptr info) {
      auto& jpeg = *static_cast<Jpeg*>(info->client_data);
      info->err->format_message(info, jpeg.message_.data());
      longjmp(jpeg.back_, 1);
    };
    errors_.emit_message = [](j_common_ptr info, int) {
      // Others leave all pixels whole.
      switch (info->err->msg_code) {
        case JWRN_HIT_MARKER:
        case JWRN_HUFF_BAD_CODE:
        case JWRN_JPEG_EOF:
        case JWRN_MUST_RESYNC:
          info->err->error_exit(info);
      }
    };
    progress_.progress_monitor = [](j_common_ptr info) {
      // Each goes over all pixels, and a small file can have many.
      constexpr int kMaxScans = 500;
      auto& jpeg = *static_cast<Jpeg*>(info->client_data);
      if (jpeg.info_.input_scan_number <= kMaxScans) return;
      std::snprintf(jpeg.message_.data(), jpeg.message_.size(), "more than %d scans", kMaxScans);
      longjmp(jpeg.back_, 1);
    };
  }
  ~Jpeg() { jpeg_destroy_decompress(&info_); }
  Jpeg(const Jpeg&) = delete;
  Jpeg& operator=(const Jpeg&) = delete;

  /// Reads until the pixels. False if that failed.
  bool read_header(std::string_view file) {
    if (setjmp(back_)) return false;
    jpeg_create_decompress(&info_);
    info_.progress = &progress_;
    jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(file.data()), file.size());
    jpeg_read_header(&info_, TRUE);
    inks_ = info_.num_components == 4;
    info_.out_color_space = inks_ ? JCS_CMYK : JCS_RGB;
    return true;
  }
  Extent extent() const { return {info_.image_width, info_.image_height}; }
  /// Reads the pixels into RGBA. False if that failed.
  bool read_pixels(uint8_t* rgba) {
    if (setjmp(back_)) return false;
    jpeg_start_decompress(&info_);
    const size_t width = info_.output_width, channels = inks_ ? 4 : 3;
    const JSAMPARRAY row =
        info_.mem->alloc_sarray(reinterpret_cast<j_common_ptr>(&info_), JPOOL_IMAGE,
                                static_cast<JDIMENSION>(channels * width), 1);
    while (info_.output_scanline < info_.output_height) {
      uint8_t* to = rgba + 4 * width * info_.output_scanline;
      jpeg_read_scanlines(&info_, row, 1);
      const JSAMPLE* from = row[0];
      for (size_t x = 0; x < width; ++x, from += channels, to += 4) {
        // Inks are stored as 255 - ink: what they leave of the paper.
        for (size_t c = 0; c < 3; ++c)
          to[c] = inks_ ? static_cast<uint8_t>((from[c] * from[3] + 127) / 255) : from[c];
        to[3] = 255;
      }
    }
    return true;
  }
  const char* message() const { return message_.data(); }

 private:
  jpeg_decompress_struct info_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  jmp_buf back_{};
  std::array<char, JMSG_LENGTH_MAX> message_{};
  bool inks_ = false;
};

}  // namespace

Picture8 read_jpeg(std::string_view file, const std::function<void(Extent)>& check_size,
                   std::string& fault) {
  Jpeg jpeg;
  Picture8 picture;
  bool whole = jpeg.read_header(file);
  if (whole) {
    check_size(jpeg.extent());
    picture = {jpeg.extent(), std::vector<uint8_t>(4 * jpeg.extent().pixels())};
    whole = jpeg.read_pixels(picture.rgba.data());
  }
  if (!whole) {
    fault = jpeg.message();
    picture = {};
  }
  return picture;
}

}  // namespace inverse
