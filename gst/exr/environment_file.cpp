// SPDX-License-Identifier: LGPL-2.1-or-later
#include "environment_file.hpp"

#include <memory>
#include <vector>

#include "common/error.hpp"
#include "common/open_file.hpp"
#include "exr_picture.hpp"

namespace inverse {
namespace {

bool is_exr(const OpenFile& file) {
  unsigned char head[4] = {};
  return file.read(0, head, sizeof head) == sizeof head && head[0] == 0x76 && head[1] == 0x2f &&
         head[2] == 0x31 && head[3] == 0x01;
}

Environment load_exr(std::shared_ptr<const OpenFile> file, const std::string& path,
                     size_t& changed) {
  const std::string name = "environment map " + path;
  ExrPicture picture(std::move(file), name, Environment::kMaxWidth);
  Environment::check_size(picture.extent(), name);
  std::vector<float> rgb = picture.rgb();
  mirror_columns(rgb, picture.extent());
  return Environment::bounded(picture.extent(), std::move(rgb), changed, name);
}

}  // namespace

Environment load_environment(const std::string& path, std::string& warning) {
  const auto file = std::make_shared<const OpenFile>(path);
  size_t changed = 0;
  Environment environment =
      is_exr(*file) ? load_exr(file, path, changed) : Environment::load(*file, path, &changed);
  warning = changed == 0 ? ""
                         : "environment map " + path + " holds " + std::to_string(changed) +
                               " values that are no radiance (negative, above 1e9, infinite or no "
                               "number); they were clamped to what is";
  return environment;
}

}  // namespace inverse
