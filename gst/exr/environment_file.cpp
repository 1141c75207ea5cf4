#include "environment_file.hpp"

#include <algorithm>
#include <fstream>
#include <vector>

#include "error.hpp"
#include "exr_picture.hpp"
#include "regular_file.hpp"

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
  const ExrPicture picture(path, name, Environment::kMaxWidth);
  const auto [width, height] = picture.extent();
  if (width < 4 || height < 2 || width != 2 * height)
    throw Error(ErrorKind::file,
                name + " is " + std::to_string(width) + "x" + std::to_string(height) +
                    "; a latitude-longitude map is twice as wide as high, from 4x2 to "
                    "16384x8192: convert other projections first");
  std::vector<float> rgb = picture.rgb();
  for (size_t row = 0; row < height; ++row)
    for (size_t x = 0; x < width / 2; ++x)
      std::swap_ranges(&rgb[3 * (row * width + x)], &rgb[3 * (row * width + x)] + 3,
                       &rgb[3 * (row * width + width - 1 - x)]);
  return Environment::bounded({width, height}, std::move(rgb), changed, name);
}

}  // namespace

Environment load_environment(const std::string& path, std::string& warning) {
  if (const std::string why = why_no_file(path); !why.empty())
    throw Error(ErrorKind::file, "environment map " + path + " " + why);
  size_t changed = 0;
  Environment environment =
      is_exr(path) ? load_exr(path, changed) : Environment::load(path, &changed);
  warning = changed == 0 ? ""
                         : "environment map " + path + " holds " + std::to_string(changed) +
                               " values that are no radiance (negative, above 1e9, infinite or no "
                               "number); they were clamped to what is";
  return environment;
}

}  // namespace inverse
