// SPDX-License-Identifier: LGPL-2.1-or-later
#include "environment_file.hpp"

#include <fstream>
#include <vector>

#include "common/error.hpp"
#include "common/regular_file.hpp"
#include "exr_picture.hpp"

namespace inverse {
namespace {

bool is_exr(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  unsigned char head[4] = {};
  file.read(reinterpret_cast<char*>(head), sizeof(head));
  return file && head[0] == 0x76 && head[1] == 0x2f && head[2] == 0x31 && head[3] == 0x01;
}

Environment load_exr(const std::string& path, size_t& changed) {
  const std::string name = "environment map " + path;
  const ExrPicture picture(path, name, Environment::kMaxWidth);
  Environment::check_size(picture.extent(), name);
  std::vector<float> rgb = picture.rgb();
  mirror_columns(rgb, picture.extent());
  return Environment::bounded(picture.extent(), std::move(rgb), changed, name);
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
