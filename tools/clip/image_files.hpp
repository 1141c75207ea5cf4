// SPDX-License-Identifier: LGPL-2.1-or-later
// What the renderer writes: PNG, flat float dumps and raw video frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "vec.hpp"

namespace inverse::clip {

/// The sRGB transfer curve, 0…1 to 0…1.
float encode_srgb(float linear);

/// The transfer curve of BT.601 and BT.709 video, 0…1 to 0…1.
float encode_video(float linear);

using Transfer = float (*)(float);

/// Interleaved 8-bit RGB, values clipped to 0…1 before the curve.
std::vector<uint8_t> to_bytes(const std::vector<Vec3>& image, Transfer transfer);

/// 8-bit RGB PNG in sRGB.
void write_png8(const std::filesystem::path& path, const std::vector<Vec3>& image, int width,
                int height);

/// 16-bit linear RGB PNG: code = min(scale · value, 1) · 65535.
void write_png16(const std::filesystem::path& path, const std::vector<Vec3>& image, int width,
                 int height, float scale);

/// Throws std::runtime_error naming the path where the file cannot be written whole.
void write_bytes(const std::filesystem::path& path, const void* data, size_t size);

}  // namespace inverse::clip
