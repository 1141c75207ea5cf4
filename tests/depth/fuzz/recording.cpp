// SPDX-License-Identifier: LGPL-2.1-or-later
// The lists of a recording: the input is divided at zeros into rgb.txt, depth.txt, groundtruth.txt
// and meta.json. An Error, or a recording that can be asked for what it has.
#include "gst/depth/recording.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "common/error.hpp"

namespace {

namespace fs = std::filesystem;

/// A PNG of one gray pixel of 16 bits.
constexpr unsigned char kPng[] = {
    0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48,
    0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x10, 0x00, 0x00, 0x00,
    0x00, 0x6A, 0xEE, 0x47, 0x16, 0x00, 0x00, 0x00, 0x0B, 0x49, 0x44, 0x41, 0x54, 0x78,
    0x9C, 0x63, 0x60, 0x7E, 0x01, 0x00, 0x00, 0xF1, 0x00, 0xEC, 0x2C, 0xEB, 0x37, 0x2E,
    0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};

/// In memory, if there is such a folder.
fs::path made() {
  std::string name = (fs::exists("/dev/shm") ? "/dev/shm" : fs::temp_directory_path().string()) +
                     "/fuzz-recording.XXXXXX";
  if (!mkdtemp(name.data())) abort();
  for (const char* folder : {"color", "depth"}) {
    fs::create_directory(fs::path(name) / folder);
    for (const char* file : {"0.png", "1.png"})
      std::ofstream(fs::path(name) / folder / file, std::ios::binary)
          .write(reinterpret_cast<const char*>(kPng), sizeof kPng);
  }
  return name;
}

void try_recording(const fs::path& folder) {
  using namespace inverse;
  try {
    const Recording recording({.location = folder.string()});
    if (recording.frames() == 0 || !(recording.period() > 0) || !(recording.unit() > 0)) abort();
    for (size_t n = 0; n < recording.frames(); ++n)
      if (!std::isfinite(recording.seconds(n)) || !recording.lens(n).usable()) abort();
  } catch (const Error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const struct Folder {
    fs::path path = made();
    ~Folder() { fs::remove_all(path); }
  } folder;
  std::string_view left(reinterpret_cast<const char*>(data), size);
  for (const char* name : {"rgb.txt", "depth.txt", "groundtruth.txt", "meta.json"}) {
    const size_t end = std::min(left.find('\0'), left.size());
    std::ofstream(folder.path / name, std::ios::binary) << left.substr(0, end);
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  try_recording(folder.path);  // as TUM RGB-D has them
  for (const char* name : {"rgb.txt", "depth.txt"}) fs::remove(folder.path / name);
  try_recording(folder.path);  // by folders
  return 0;
}
