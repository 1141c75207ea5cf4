// SPDX-License-Identifier: LGPL-2.1-or-later
// Environment maps in Radiance files, read with stb.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

#include "common/error.hpp"
#include "common/file_extension.hpp"
#include "common/open_file.hpp"
#include "common/replace_file.hpp"
#include "environment.hpp"

// Private to this file, because an application may link its own stb.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
// Damaged files fail them.
#define STBI_ASSERT(x) ((void)0)
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#include <stb/stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace inverse {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(ErrorKind::file, "environment map " + path + " " + what);
}

[[noreturn]] void fail_to_write(const std::string& path, const std::string& why) {
  throw Error(ErrorKind::output, "environment map " + path + " cannot be written: " + why);
}

/// Target of a write.
struct Target {
  std::filesystem::path path;  ///< the file itself if the name is a symbolic link
  bool there;                  ///< an earlier file exists
  bool in_place;  ///< overwrite the earlier file, instead of writing a new one beside it first
};

/// Throws if nothing can be written under this name.
Target target_of(const std::string& path) {
  namespace fs = std::filesystem;
  constexpr std::array kOthers{"exr", "png", "jpg", "jpeg", "tif", "tiff", "pfm"};
  if (std::ranges::count(kOthers, extension_of(path)))
    fail_to_write(path, "it would be a Radiance picture; name it .hdr");
  std::error_code none, status;
  const fs::file_status found = fs::status(path, status);
  if (found.type() == fs::file_type::none) fail_to_write(path, status.message());
  if (fs::is_directory(found)) fail_to_write(path, "it is a folder");
  if (fs::is_fifo(found) || fs::is_socket(found)) fail_to_write(path, "it is a pipe");
  const bool there = fs::exists(found);
  const fs::path target = there ? fs::canonical(path, none) : fs::path(path);
  const std::string folder = target.parent_path().empty() ? "." : target.parent_path().string();
  const bool takes_another = access(folder.c_str(), W_OK | X_OK) == 0;
  if (there && access(target.c_str(), W_OK) != 0) fail_to_write(path, strerror(errno));
  if (there) return {target, true, !takes_another || !fs::is_regular_file(found)};
  if (!fs::is_directory(folder, none)) fail_to_write(path, "there is no folder " + folder);
  if (!takes_another) fail_to_write(path, "no file can be made in " + folder);
  return {target, false, false};
}

/// Reader for stb. stb would loop forever on missing bytes at the end of a file, or read them as
/// zeros; this returns bytes that end lines and runs, and sets beyond_end.
struct Reader {
  static constexpr int kPixel = 4;

  std::string_view left;
  bool beyond_end = false;

  static int read(void* self, char* to, int bytes) {
    auto& reader = *static_cast<Reader*>(self);
    const auto got = static_cast<int>(reader.left.copy(to, static_cast<size_t>(bytes)));
    reader.left.remove_prefix(static_cast<size_t>(got));
    // A buffer may end early, but pixels (4 bytes) have to be complete.
    if (got == bytes || (got > 0 && bytes > kPixel)) return got;
    reader.beyond_end = true;
    memset(to + got, '\n', static_cast<size_t>(bytes - got));
    return bytes;
  }
  static void skip(void* self, int bytes) {
    std::string_view& left = static_cast<Reader*>(self)->left;
    left.remove_prefix(std::min(left.size(), static_cast<size_t>(std::max(bytes, 0))));
  }
  static int ended(void* self) { return static_cast<Reader*>(self)->left.empty(); }
};

/// Multiplies by the one or three numbers of a header line; keys may repeat.
void multiply(std::array<float, 3>& factors, std::string_view line) {
  const size_t key = line.find('=');
  std::array<float, 3> by{};
  size_t count = 0;
  for (const char *at = line.data() + key + 1, *end = line.data() + line.size(); count < 3;) {
    while (at < end && (*at == ' ' || *at == '\t')) ++at;
    const auto [rest, error] = std::from_chars(at, end, by[count]);  // whatever the locale
    if (error != std::errc()) break;
    at = rest;
    ++count;
  }
  if (count == 0) return;
  for (size_t c = 0; c < 3; ++c) factors[c] *= by[count == 3 ? c : 0];
}

/// The factors that a file's header declares for red, green and blue.
std::array<float, 3> exposure_of(std::string_view file, const std::string& path) {
  std::array<float, 3> factors{1, 1, 1};
  while (true) {
    const std::string_view line = file.substr(0, file.find('\n'));
    if (line.empty()) break;
    if (line.starts_with("EXPOSURE=") || line.starts_with("COLORCORR=")) multiply(factors, line);
    file.remove_prefix(std::min(line.size() + 1, file.size()));
  }
  for (const float f : factors)
    if (!std::isnormal(f) || f < 0) fail(path, "has an exposure of no use in its header");
  return factors;
}

struct Panorama {
  Extent extent;
  std::vector<float> rgb;
};

constexpr stbi_io_callbacks kCallbacks{Reader::read, Reader::skip, Reader::ended};

/// What stb makes of a file, or of the beginning that was read of it.
template <typename Use>
auto decode(std::string_view file, const std::string& path, Use use) {
  Reader reader{file};
  auto result = use(&reader);
  if (reader.beyond_end) fail(path, "ends too early; it was not copied or written whole");
  if (!result)
    fail(path, std::string("is no Radiance picture (.hdr, RGBE, rows from the top) that "
                           "can be read (") +
                   stbi_failure_reason() + "); convert others, with Blender for example");
  return result;
}

/// The size that the header declares, of a file of so many bytes.
Extent extent_of(std::string_view head, uint64_t bytes, const std::string& path) {
  int width = 0, height = 0, channels = 0;
  decode(head, path, [&](Reader* reader) {
    return stbi_info_from_callbacks(&kCallbacks, reader, &width, &height, &channels);
  });
  if (width < 0 || height < 0) fail(path, "has a size below 0 in its header");
  const Extent extent{static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
  Environment::check_size(extent, "environment map " + path);
  // The size in the header may be wrong: a row needs at least two bytes per 127 values.
  if (bytes < static_cast<uint64_t>(height) * 8 * (static_cast<uint64_t>(width) / 127))
    fail(path, "ends too early; it was not copied or written whole");
  return extent;
}

/// The pixels of a file in camera axes.
Panorama parse(std::string_view file, const std::string& path) {
  const Extent extent = extent_of(file, file.size(), path);
  int width = 0, height = 0, channels = 0;
  const auto rgb = decode(file, path, [&](Reader* reader) {
    return std::unique_ptr<float, void (*)(void*)>(
        stbi_loadf_from_callbacks(&kCallbacks, reader, &width, &height, &channels, 3),
        stbi_image_free);
  });
  Panorama panorama{extent, {rgb.get(), rgb.get() + 3 * extent.pixels()}};
  mirror_columns(panorama.rgb, extent);
  const auto exposure = exposure_of(file, path);
  for (size_t i = 0; i < panorama.rgb.size(); ++i) panorama.rgb[i] /= exposure[i % 3];
  return panorama;
}

}  // namespace

Environment Environment::load(const std::string& path, size_t* changed) {
  return load(OpenFile(path), path, changed);
}

Environment Environment::load(const OpenFile& file, const std::string& path, size_t* changed) {
  if (!file.fault().empty()) fail(path, file.fault());
  // Before the rest is read. Runs of one value take twice the bytes of plain pixels.
  constexpr uint64_t kMaxHead = uint64_t{1} << 20;
  std::string head(std::min(file.size(), kMaxHead), '\0');
  head.resize(file.read(0, head.data(), head.size()));
  const Extent extent = extent_of(head, file.size(), path);
  const uint64_t most = 8 * extent.pixels() + kMaxHead;
  if (file.size() > most)
    fail(path, "is larger than a map of " + std::to_string(extent.width) + "x" +
                   std::to_string(extent.height) + " pixels can be; it was not written whole");
  std::string fault;
  const std::string bytes = read_file(file, most, fault);
  if (!fault.empty()) fail(path, fault);
  Panorama panorama = parse(bytes, path);
  size_t values = 0;
  return bounded(panorama.extent, std::move(panorama.rgb), changed ? *changed : values,
                 "environment map " + path);
}

void Environment::check_target(const std::string& path) { target_of(path); }

void Environment::save(const std::string& path) const {
  const auto [target, there, in_place] = target_of(path);
  const auto append = [](void* to, void* data, int bytes) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                          static_cast<size_t>(bytes));
  };
  std::vector<float> picture = rgb_;
  mirror_columns(picture, extent_);
  std::string bytes;
  if (!stbi_write_hdr_to_func(append, &bytes, static_cast<int>(extent_.width),
                              static_cast<int>(extent_.height), 3, picture.data()))
    fail_to_write(path, "it cannot be encoded");
  if (in_place) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) fail_to_write(path, "the file is not whole; is the disk full?");
    return;
  }
  replace_file(target, bytes);
}

}  // namespace inverse
