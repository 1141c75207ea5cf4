// SPDX-License-Identifier: LGPL-2.1-or-later
#include "model_pictures.hpp"

#include <cmath>

#include "rgbd_source.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/metrics/png_file.hpp"

namespace inverse::bench {

ModelScore ModelPictures::add(const VolumeData& model) {
  Volume::Params params;
  params.voxel = model.voxel;
  params.truncation = model.truncation;
  params.blocks = uint32_t(model.keys.size());
  Volume volume(lab_.device(), params);
  volume.restore(model);
  ModelScore score;
  for (const Side& side : sides_) {
    const Extent extent{uint32_t(side.truth.width), uint32_t(side.truth.height)};
    Volume::View view(lab_.device(), extent);
    const auto pose = pose_on(lab_, side.pose);
    lab_.run([&](gpu::Commands& commands) { volume.record_march(commands, lens_, pose, view); });
    const Pixels pixels = lab_.download(view.reflectance);
    Image seen(side.truth.width, side.truth.height, 3), mask(seen.width, seen.height, 1);
    double sum = 0, truth = 0, known = 0;
    for (size_t i = 0; i < extent.pixels(); ++i) {
      if (!(pixels[4 * i + 3] > 0)) continue;
      mask.data[i] = 1;
      ++known;
      for (size_t c = 0; c < 3; ++c) {
        seen.data[3 * i + c] = std::exp(pixels[4 * i + c]);
        sum += double{seen.data[3 * i + c]};
        truth += double{side.truth.data[3 * i + c]};
      }
    }
    score.reflectance += lmse(seen, side.truth, mask) / double(sides_.size());
    score.covered += known / double(extent.pixels() * sides_.size());
    for (float& v : seen.data) v *= float(truth / std::max(sum, 1e-9));
    shown_.push_back(std::move(seen));
  }
  return score;
}

void ModelPictures::write(const std::string& path) const {
  std::vector<const Image*> all;
  for (const Image& image : shown_) all.push_back(&image);
  for (const Side& side : sides_) all.push_back(&side.truth);
  const int width = sides_[0].truth.width, height = sides_[0].truth.height,
            across = int(sides_.size());
  Image sheet(width * across, height * int(all.size()) / across, 3);
  for (int k = 0; k < int(all.size()); ++k)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c)
          sheet.at(k % across * width + x, k / across * height + y, c) =
              all[size_t(k)]->at(x, y, c);
  write_png(path, sheet);
}

}  // namespace inverse::bench
