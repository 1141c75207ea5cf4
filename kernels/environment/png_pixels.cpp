// SPDX-License-Identifier: LGPL-2.1-or-later
#include "png_pixels.hpp"

#include <algorithm>
#include <memory>
#include <string_view>

#include "common/error.hpp"
#include "common/open_file.hpp"
#include "common/png_head.hpp"

// stb_image's decoder, private to this file.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
// Damaged files fail them.
#define STBI_ASSERT(x) ((void)0)
#define STBI_MAX_DIMENSIONS 8192
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace inverse {
namespace {

/// Whether the chunks of a PNG end within the file: stb takes memory for what they declare.
bool has_its_chunks(std::string_view png) {
  constexpr size_t kSignature = 8, kHead = 8, kChecksum = 4;
  for (png.remove_prefix(std::min(kSignature, png.size())); png.size() >= kHead;) {
    size_t length = 0;
    for (size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<unsigned char>(png[i]);
    if (length > png.size() - kHead || png[4] == '\0') return false;
    if (png.substr(4, 4) == "IEND") break;
    png.remove_prefix(std::min(kHead + length + kChecksum, png.size()));
  }
  return true;
}

}  // namespace

PngPixels read_png_pixels(const std::string& path, const std::string& expected) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorKind::file, path + ": " + why + "; " + expected);
  };
  const OpenFile opened(path);
  if (!opened.fault().empty()) refuse("it " + opened.fault());
  // Before the rest is read.
  std::string file(PngHead::kBytes, '\0');
  file.resize(opened.read(0, file.data(), file.size()));
  const PngHead head(file);
  if (!head.png) refuse("no PNG");
  if (std::max(head.width, head.height) > STBI_MAX_DIMENSIONS) refuse("no PNG (too large)");
  if (opened.size() > head.max_bytes())
    refuse("it is larger than a PNG of " + std::to_string(head.width) + "x" +
           std::to_string(head.height) + " pixels can be");
  std::string fault;
  file = read_file(opened, head.max_bytes(), fault);
  if (!fault.empty()) refuse("it " + fault);
  const auto* bytes = reinterpret_cast<const stbi_uc*>(file.data());
  const auto size = static_cast<int>(file.size());
  int width = 0, height = 0, channels = 0;
  if (!has_its_chunks(file)) refuse("no PNG (it ends too early)");
  // Before memory is taken for it: Deflate shrinks to a thousandth at most, one bit is the least.
  constexpr uint64_t kMaxRatio = 8 * 1032;
  if (stbi_info_from_memory(bytes, size, &width, &height, &channels) &&
      kMaxRatio * file.size() < static_cast<uint64_t>(width) * static_cast<uint64_t>(height))
    refuse("it ends too early for " + std::to_string(width) + "x" + std::to_string(height) +
           " pixels");
  const std::unique_ptr<stbi_us, void (*)(void*)> pixels(
      stbi_load_16_from_memory(bytes, size, &width, &height, &channels, 4), stbi_image_free);
  if (!pixels) refuse(std::string("no PNG (") + stbi_failure_reason() + ")");
  const Extent extent{static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
  return {extent,
          channels,
          stbi_is_16_bit_from_memory(bytes, size) != 0,
          {pixels.get(), pixels.get() + 4 * extent.pixels()}};
}

}  // namespace inverse
