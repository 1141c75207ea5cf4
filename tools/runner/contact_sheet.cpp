// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contact_sheet.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "common/replace_file.hpp"

namespace inverse::run {
namespace {

constexpr size_t kTiles = ContactSheet::kColumns * ContactSheet::kRows;
constexpr int kGap = 8;  // pixels between tiles
constexpr uint8_t kGround = 32;

/// A PNG of a packed RGB picture.
std::vector<char> encode_png(const std::vector<uint8_t>& rgb, int width, int height) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_RGB, width, height);
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  for (int y = 0; y < height; ++y)
    gst_buffer_fill(buffer, static_cast<gsize>(y) * info.stride[0],
                    &rgb[static_cast<size_t>(y) * width * 3], static_cast<gsize>(width) * 3);
  GstCaps* caps = gst_video_info_to_caps(&info);
  GstSample* sample = gst_sample_new(buffer, caps, nullptr, nullptr);
  GstCaps* png = gst_caps_new_empty_simple("image/png");
  GError* error = nullptr;
  GstSample* encoded = gst_video_convert_sample(sample, png, 30 * GST_SECOND, &error);
  gst_caps_unref(png);
  gst_sample_unref(sample);
  gst_caps_unref(caps);
  gst_buffer_unref(buffer);
  if (!encoded) {
    const std::string reason = error ? error->message : "unknown reason";
    g_clear_error(&error);
    throw std::runtime_error("cannot encode a PNG: " + reason);
  }
  std::vector<char> bytes(gst_buffer_get_size(gst_sample_get_buffer(encoded)));
  gst_buffer_extract(gst_sample_get_buffer(encoded), 0, bytes.data(), bytes.size());
  gst_sample_unref(encoded);
  return bytes;
}

}  // namespace

void ContactSheet::offer(GstBuffer* buffer, const GstCaps* caps) {
  if (frames_++ % step_ != 0) return;
  SmallPicture picture = maker_.make(buffer, caps);
  if (picture.rgb.empty()) return;
  tiles_.push_back(std::move(picture.rgb));
  if (tiles_.size() == 2 * kTiles) {
    for (size_t i = 1; i < kTiles; ++i) tiles_[i] = std::move(tiles_[2 * i]);
    tiles_.resize(kTiles);
    step_ *= 2;
  }
}

void ContactSheet::write(const std::string& path) const {
  if (tiles_.empty()) throw std::runtime_error("no frame came out, so there is no contact sheet");
  const int tile_height = maker_.height();
  const size_t shown = std::min(tiles_.size(), kTiles);
  const int rows = static_cast<int>((shown + kColumns - 1) / kColumns);
  const int width = kColumns * (kTileWidth + kGap) + kGap;
  const int height = rows * (tile_height + kGap) + kGap;
  std::vector<uint8_t> sheet(static_cast<size_t>(width) * height * 3, kGround);
  for (size_t i = 0; i < shown; ++i) {
    // From the first to the last kept frame, evenly.
    const Tile& tile = tiles_[shown > 1 ? i * (tiles_.size() - 1) / (shown - 1) : 0];
    const int left = kGap + static_cast<int>(i % kColumns) * (kTileWidth + kGap);
    const int top = kGap + static_cast<int>(i / kColumns) * (tile_height + kGap);
    for (int y = 0; y < tile_height; ++y)
      memcpy(&sheet[(static_cast<size_t>(top + y) * width + left) * 3],
             &tile[static_cast<size_t>(y) * kTileWidth * 3], static_cast<size_t>(kTileWidth) * 3);
  }
  const std::vector<char> png = encode_png(sheet, width, height);
  replace_file(path, {png.data(), png.size()});
}

}  // namespace inverse::run
