// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <string_view>

#include "common/error.hpp"
#include "common/open_file.hpp"
#include "common/png_head.hpp"
#include "jpeg_pixels.hpp"

// Private to this file, because an application may link its own stb.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
// Damaged files fail them.
#define STBI_ASSERT(x) ((void)0)
#define STBI_MAX_DIMENSIONS 65536
#define STBI_NO_STDIO
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace inverse {
namespace {

constexpr int kAsStored = 1, kLastOrientation = 8;

/// Numbers in bytes of either order; 0 beyond the end.
class Bytes {
 public:
  explicit Bytes(std::string_view data) : data_(data) {}
  bool little = false;
  uint32_t number(size_t at, size_t bytes) const {
    if (at > data_.size() || data_.size() - at < bytes) return 0;
    uint32_t value = 0;
    for (size_t i = 0; i < bytes; ++i)
      value = value << 8 | static_cast<unsigned char>(data_[at + (little ? bytes - 1 - i : i)]);
    return value;
  }

 private:
  std::string_view data_;
};

/// Of a block of TIFF tags, as EXIF has it.
int tiff_orientation(std::string_view tiff) {
  constexpr uint32_t kOrientation = 0x112;
  Bytes bytes(tiff);
  bytes.little = tiff.starts_with("II");
  if (bytes.number(2, 2) != 42) return kAsStored;
  const size_t first = bytes.number(4, 4);
  const uint32_t entries = bytes.number(first, 2);
  for (size_t i = 0; i < entries; ++i) {
    const size_t entry = first + 2 + 12 * i;
    if (bytes.number(entry, 2) != kOrientation) continue;
    const auto value = static_cast<int>(bytes.number(entry + 8, 2));
    return value >= kAsStored && value <= kLastOrientation ? value : kAsStored;
  }
  return kAsStored;
}

/// The segments of a JPEG before its pixels: segment(marker, where it begins). Returns where the
/// pixels begin, npos if they are missing, or if there is anything between segments.
template <typename Segment>
size_t for_segments(std::string_view jpeg, Segment segment) {
  constexpr uint32_t kScan = 0xffda, kFill = 0xffff;
  const Bytes bytes(jpeg);
  for (size_t at = 2; at + 4 <= jpeg.size();) {
    const uint32_t marker = bytes.number(at, 2), length = bytes.number(at + 2, 2);
    if (marker == kFill) {
      ++at;
      continue;
    }
    if (marker == kScan) return at;
    if (marker >> 8 != 0xff || length < 2) break;
    segment(marker, at);
    at += 2 + length;
  }
  return std::string_view::npos;
}

int jpeg_orientation(std::string_view jpeg) {
  constexpr uint32_t kApp1 = 0xffe1;
  constexpr std::string_view kExif("Exif\0\0", 6);
  int orientation = kAsStored;
  for_segments(jpeg, [&](uint32_t marker, size_t at) {
    const std::string_view data = jpeg.substr(at + 4, Bytes(jpeg).number(at + 2, 2) - 2);
    if (marker == kApp1 && data.starts_with(kExif))
      orientation = tiff_orientation(data.substr(kExif.size()));
  });
  return orientation;
}

/// The chunks of a PNG, one after the other: chunk(type, data). False if they end too early.
template <typename Chunk>
bool for_chunks(std::string_view png, Chunk chunk) {
  constexpr size_t kSignature = 8, kHead = 8, kChecksum = 4;
  for (png.remove_prefix(std::min(kSignature, png.size())); png.size() >= kHead;) {
    const size_t length = Bytes(png).number(0, 4);
    if (length > png.size() - kHead || png[4] == '\0') return false;
    if (png.substr(4, 4) == "IEND") return true;
    chunk(png.substr(4, 4), png.substr(kHead, length));
    png.remove_prefix(std::min(kHead + length + kChecksum, png.size()));
  }
  return false;
}

constexpr std::string_view kPng("\x89PNG", 4), kJpeg("\xff\xd8\xff", 3);

/// Whether a PNG or JPEG has its end, and nothing between its segments: stb and libjpeg go on
/// beyond that of a file.
bool has_its_end(std::string_view file) {
  if (file.starts_with(kPng)) return for_chunks(file, [](auto, auto) {});
  if (!file.starts_with(kJpeg)) return true;
  const size_t pixels = for_segments(file, [](auto, auto) {});
  return pixels != std::string_view::npos && file.find("\xff\xd9", pixels) != file.npos;
}

/// As read_jpeg, of a PNG.
Picture8 read_png(std::string_view file, const std::function<void(Extent)>& check_size,
                  std::string& fault) {
  const auto* bytes = reinterpret_cast<const stbi_uc*>(file.data());
  const auto size = static_cast<int>(file.size());
  int width = 0, height = 0, channels = 0;
  Picture8 picture;
  const bool known = stbi_info_from_memory(bytes, size, &width, &height, &channels);
  // stb says only that it does not know a picture that is too large for it.
  check_size(known ? Extent{static_cast<uint32_t>(width), static_cast<uint32_t>(height)}
                   : Extent{Bytes(file).number(16, 4), Bytes(file).number(20, 4)});
  const std::unique_ptr<stbi_uc, void (*)(void*)> decoded(
      known ? stbi_load_from_memory(bytes, size, &width, &height, &channels, 4) : nullptr,
      stbi_image_free);
  if (!decoded) {
    const char* why = stbi_failure_reason();
    fault = why ? why : "";
    return picture;
  }
  picture.extent = {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
  picture.rgba.assign(decoded.get(), decoded.get() + 4 * picture.extent.pixels());
  return picture;
}

float linear(uint8_t code) {
  const float v = static_cast<float>(code) / 255;
  return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

}  // namespace

int exif_orientation(const std::string& file) {
  if (file.starts_with(kJpeg)) return jpeg_orientation(file);
  int orientation = kAsStored;
  if (file.starts_with(kPng))
    for_chunks(file, [&](std::string_view type, std::string_view data) {
      if (type == "eXIf") orientation = tiff_orientation(data);
    });
  return orientation;
}

Picture8 oriented(Picture8 picture, int orientation) {
  if (orientation <= kAsStored || orientation > kLastOrientation) return picture;
  const auto [w, h] = picture.extent;
  const bool turned = orientation >= 5;
  Picture8 out{turned ? Extent{h, w} : picture.extent, {}};
  out.rgba.resize(picture.rgba.size());
  for (uint32_t y = 0; y < out.extent.height; ++y)
    for (uint32_t x = 0; x < out.extent.width; ++x) {
      // Where the pixel lies in the file.
      uint32_t u = turned ? y : x, v = turned ? x : y;
      const bool from_right =
          orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
      const bool from_bottom =
          orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
      if (from_right) u = w - 1 - u;
      if (from_bottom) v = h - 1 - v;
      std::memcpy(&out.rgba[4 * (uint64_t{y} * out.extent.width + x)],
                  &picture.rgba[4 * (uint64_t{v} * w + u)], 4);
    }
  return out;
}

Picture8 load_picture(const std::string& path, Turn turn) {
  const auto refuse = [&path](const std::string& why) {
    throw Error(ErrorKind::file, path + ": " + why +
                                     "; pictures are PNG or JPEG files: convert others, "
                                     "with gst-launch-1.0 or ImageMagick for example");
  };
  const auto fail = [&path](const std::string& why) {
    throw Error(ErrorKind::file, path + ": it " + why);
  };
  const OpenFile opened(path);
  if (!opened.fault().empty()) fail(opened.fault());
  std::string file(PngHead::kBytes, '\0');
  file.resize(opened.read(0, file.data(), file.size()));
  const PngHead head(file);
  if (!head.png && !file.starts_with(kJpeg)) refuse("no picture");
  const auto check_size = [&](Extent extent) {
    const uint64_t pixels = extent.pixels();
    if (pixels > kMaxPixels)
      throw Error(ErrorKind::file, path + ": a picture of " + std::to_string(extent.width) + "x" +
                                       std::to_string(extent.height) +
                                       " pixels; scale it to less than " +
                                       std::to_string(kMaxPixels >> 20) + " million");
    if (pixels == 0) refuse("no picture (it has no pixels)");
    // A damaged file may declare any size. No coding here shrinks a pixel to less.
    constexpr uint64_t kMaxRatio = 16 * 1032;
    if (kMaxRatio * opened.size() < pixels) refuse("it ends too early");
  };
  // Before the rest is read.
  const Extent declared{head.width, head.height};
  if (declared.pixels() > 0) check_size(declared);
  constexpr uint64_t kMaxJpeg = uint64_t{128} << 20;  // a byte for each of kMaxPixels
  if (head.png && opened.size() > head.max_bytes())
    fail("is larger than a picture of " + std::to_string(head.width) + "x" +
         std::to_string(head.height) + " pixels can be: store it again");
  std::string fault;
  file = read_file(opened, head.png ? head.max_bytes() : kMaxJpeg, fault);
  if (!fault.empty()) fail(fault);
  if (!file.starts_with(head.png ? kPng : kJpeg)) fail("changed while it was read; load it again");
  if (!has_its_end(file)) refuse("it ends too early");
  const auto read = file.starts_with(kPng) ? read_png : read_jpeg;
  Picture8 picture = read(file, check_size, fault);
  if (picture.rgba.empty()) refuse("a damaged picture (" + fault + ")");
  if (turn == Turn::none) return picture;
  return oriented(std::move(picture), exif_orientation(file));
}

LinearPicture linear_picture(const Picture8& picture, uint32_t max_side) {
  static const auto kLinear = [] {
    std::array<float, 256> table{};
    for (size_t i = 0; i < table.size(); ++i) table[i] = linear(static_cast<uint8_t>(i));
    return table;
  }();
  const auto [w, h] = picture.extent;
  const uint32_t factor = (std::max(w, h) - 1) / std::max(max_side, 1U) + 1;
  LinearPicture out{{(w + factor - 1) / factor, (h + factor - 1) / factor}, {}};
  out.rgba.reserve(4 * out.extent.pixels());
  for (uint32_t y = 0; y < out.extent.height; ++y)
    for (uint32_t x = 0; x < out.extent.width; ++x) {
      std::array<float, 4> sum{};  // colors times alpha, alpha
      float count = 0;
      for (uint32_t v = y * factor; v < std::min((y + 1) * factor, h); ++v)
        for (uint32_t u = x * factor; u < std::min((x + 1) * factor, w); ++u, ++count) {
          const uint8_t* code = &picture.rgba[4 * (uint64_t{v} * w + u)];
          const float alpha = static_cast<float>(code[3]) / 255;
          for (size_t c = 0; c < 3; ++c) sum[c] += alpha * kLinear[code[c]];
          sum[3] += alpha;
        }
      for (size_t c = 0; c < 3; ++c) out.rgba.push_back(sum[3] > 0 ? sum[c] / sum[3] : 0);
      out.rgba.push_back(sum[3] / count);
    }
  return out;
}

}  // namespace inverse
