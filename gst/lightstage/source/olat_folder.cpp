// SPDX-License-Identifier: LGPL-2.1-or-later
#include "olat_folder.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "kernels/lightstage/program/light_list.hpp"

namespace inverse {
namespace {

[[noreturn]] void refuse(const std::string& text) { throw Error(ErrorKind::file, text); }

}  // namespace

OlatFolder::OlatFolder(const std::string& path) : path_(path) {
  LightList list = LightList::load(path + "/lights.json");
  directions_ = std::move(list.directions);
  files_ = std::move(list.files);
  captured_ = list.captured;
  const auto first = std::ranges::find_if(files_, [](const auto& file) { return !file.empty(); });
  extent_ = open(static_cast<uint32_t>(first - files_.begin())).extent();
}

std::vector<uint32_t> OlatFolder::missing() const {
  std::vector<uint32_t> missing;
  for (uint32_t i = 0; i < files_.size(); ++i)
    if (files_[i].empty()) missing.push_back(i);
  return missing;
}

ExrPicture OlatFolder::open(uint32_t light) const {
  const std::string file = path_ + "/" + files_[light];
  return ExrPicture(file, file, kMaxPixels);
}

std::vector<float> OlatFolder::image(uint32_t light) const {
  if (files_[light].empty()) return std::vector<float>(3 * extent_.pixels());
  ExrPicture picture = open(light);
  if (const Extent extent = picture.extent(); extent != extent_)
    refuse(path_ + "/" + files_[light] + " is " + std::to_string(extent.width) + "x" +
           std::to_string(extent.height) + ", the first image " + std::to_string(extent_.width) +
           "x" + std::to_string(extent_.height));
  return picture.rgb();
}

}  // namespace inverse
