#include "environment_file.hpp"

#include <ImfArray.h>
#include <ImfRgbaFile.h>

#include <fstream>
#include <vector>

#include "error.hpp"

namespace inverse {
namespace {

bool is_exr(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  unsigned char head[4] = {};
  file.read(reinterpret_cast<char*>(head), sizeof(head));
  return file && head[0] == 0x76 && head[1] == 0x2f && head[2] == 0x31 && head[3] == 0x01;
}

/// As Environment::load: columns are mirrored, from the subject's point of view to the camera's.
Environment load_exr(const std::string& path, size_t& changed) {
  const std::string name = "environment map " + path;
  try {
    Imf::RgbaInputFile file(path.c_str());
    const Imath::Box2i window = file.dataWindow();
    const int64_t width = int64_t{window.max.x} - window.min.x + 1;
    const int64_t height = int64_t{window.max.y} - window.min.y + 1;
    constexpr int64_t kMost = Environment::kMaxWidth;
    if (width < 4 || width > kMost || height < 2 || width != 2 * height)
      throw Error(ErrorKind::file,
                  name + " is " + std::to_string(width) + "x" + std::to_string(height) +
                      "; a latitude-longitude map is twice as wide as high, from 4x2 to "
                      "16384x8192: convert other projections first");
    Imf::Array2D<Imf::Rgba> pixels(height, width);
    file.setFrameBuffer(&pixels[0][0] - window.min.x - window.min.y * width, 1,
                        static_cast<size_t>(width));
    file.readPixels(window.min.y, window.max.y);
    std::vector<float> rgb;
    rgb.reserve(static_cast<size_t>(3 * width * height));
    for (int64_t y = 0; y < height; ++y)
      for (int64_t x = width - 1; x >= 0; --x) {
        const Imf::Rgba& pixel = pixels[y][x];
        rgb.insert(rgb.end(), {pixel.r, pixel.g, pixel.b});
      }
    return Environment::bounded({static_cast<uint32_t>(width), static_cast<uint32_t>(height)},
                                std::move(rgb), changed, name);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ErrorKind::file, name + " cannot be read: " + error.what());
  }
}

}  // namespace

Environment load_environment(const std::string& path, std::string& warning) {
  size_t changed = 0;
  Environment environment =
      is_exr(path) ? load_exr(path, changed) : Environment::load(path, changed);
  warning = changed == 0 ? ""
                         : "environment map " + path + " holds " + std::to_string(changed) +
                               " values that are no radiance (negative, infinite or no number); "
                               "they were clamped to 0 or 1e9";
  return environment;
}

}  // namespace inverse
