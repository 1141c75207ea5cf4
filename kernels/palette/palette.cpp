// SPDX-License-Identifier: LGPL-2.1-or-later
#include "palette.hpp"

#include <algorithm>
#include <utility>

#include "kernels/gpu/reduce.hpp"

namespace inverse {
namespace {

constexpr uint32_t kBinCount = shaders::palette_count::kBinCount;
using gpu::kOneGroup;

}  // namespace

Palette::Palette(const std::shared_ptr<gpu::Device>& device)
    : scale_count_(device),
      scale_kernel_(device, {}, kOneGroup),
      count_(device),
      average_(device),
      compact_(device, {}, kOneGroup),
      seed_(device, {}, kOneGroup),
      cluster_(device, {}, kOneGroup),
      merge_(device),
      assign_(device) {
  const auto buffer = [&](gpu::Element element, uint64_t count) {
    return gpu::Buffer::create(device, element, count);
  };
  scale_counts_ = buffer(gpu::Element::word, shaders::palette_scale::kScaleBins);
  scale_ = buffer(gpu::Element::scalar, 1);
  counts_ = buffer(gpu::Element::word, 4 * kBinCount);
  list_ = buffer(gpu::Element::vec4, kBinCount);
  list_length_ = buffer(gpu::Element::word, 1);
  clusters_ = buffer(gpu::Element::vec4, kMaxClusters);
  labels_ = buffer(gpu::Element::word, kBinCount);
  palette_ = buffer(gpu::Element::vec4, 2 * kMaxClusters);
  for (auto& histogram : histogram_) histogram = buffer(gpu::Element::vec4, kBinCount);
}

void Palette::set_params(const Params& params) {
  params_ = params;
  params_.clusters = std::clamp(params.clusters, 1, static_cast<int>(kMaxClusters));
  params_.iterations = std::clamp(params.iterations, 1, 64);
  params_.decay = std::clamp(params.decay, 0.0f, 1.0f);
  params_.fade = std::clamp(params.fade, 0.0f, 1.0f);
  params_.apart = std::clamp(params.apart, 0.0f, 3.0f);
  params_.tau_cc = std::clamp(params.tau_cc, 0.0f, 3.0f);
  params_.tau_intensity = std::max(params.tau_intensity, 0.0f);
  params_.chroma_floor = std::max(params.chroma_floor, 1e-6f);
  params_.white_quantile = std::clamp(params.white_quantile, 0.0f, 1.0f);
  params_.white_level = std::max(params.white_level, 1e-3f);
}

Palette::Push Palette::push_for(Extent extent, float fraction_scale) const {
  return {.size = extent,
          .first = first_,
          .clusters = params_.clusters,
          .iterations = params_.iterations,
          .frame = frame_,
          .seed = params_.seed,
          .decay = params_.decay,
          .fade = params_.fade,
          .apart = params_.apart,
          .tau_cc = params_.tau_cc,
          .tau_intensity = params_.tau_intensity,
          .chroma_floor = params_.chroma_floor,
          .white_quantile = params_.white_quantile,
          .white_level = params_.white_level,
          .fraction_scale = fraction_scale};
}

void Palette::record_update(gpu::Commands& commands, const Plane& log_reflectance) {
  const Extent extent = log_reflectance.extent;
  const uint64_t scale =
      std::min<uint64_t>(65535, 0xffffffffu / std::max<uint64_t>(extent.pixels(), 1));
  if (scale < 255) {
    throw Error(ErrorKind::limit, "the palette's histogram holds at most 16843009 pixels, and " +
                                      std::to_string(extent.width) + "x" +
                                      std::to_string(extent.height) +
                                      " is more; use a smaller frame or more pyramid levels");
  }
  if (!cleared_) {
    for (const auto& buffer :
         {scale_counts_, scale_, counts_, clusters_, palette_, histogram_[0], histogram_[1]}) {
      commands.fill(buffer);
    }
    cleared_ = true;
  }
  if (first_) frame_ = 0;
  const Push push = push_for(extent, static_cast<float>(scale));
  ++frame_;
  const gpu::Items pixels{extent.width, extent.height};
  const gpu::Items one_group{kOneGroup};
  commands.dispatch(scale_count_, {.reflectance = log_reflectance.buffer, .counts = scale_counts_},
                    push, pixels);
  commands.dispatch(scale_kernel_, {.counts = scale_counts_, .scale = scale_}, push, one_group);
  commands.dispatch(count_,
                    {.reflectance = log_reflectance.buffer, .scale = scale_, .counts = counts_},
                    push, pixels);
  std::swap(histogram_[0], histogram_[1]);
  commands.dispatch(average_,
                    {.counts = counts_, .before = histogram_[1], .histogram = histogram_[0]}, push,
                    {kBinCount});
  commands.dispatch(compact_,
                    {.histogram = histogram_[0], .list = list_, .list_length = list_length_}, push,
                    one_group);
  commands.dispatch(seed_, {.list = list_, .list_length = list_length_, .clusters = clusters_},
                    push, one_group);
  commands.dispatch(
      cluster_,
      {.list = list_, .list_length = list_length_, .clusters = clusters_, .labels = labels_}, push,
      one_group);
  commands.dispatch(merge_, {.clusters = clusters_, .scale = scale_, .palette = palette_}, push,
                    {1});
  first_ = false;
}

void Palette::record_assign(gpu::Commands& commands, const Plane& log_reflectance,
                            const Plane& clusters) const {
  const Extent extent = log_reflectance.extent;
  commands.dispatch(assign_,
                    {.reflectance = log_reflectance.buffer,
                     .palette = palette_,
                     .nearest_clusters = clusters.buffer},
                    push_for(extent, 0), {extent.width, extent.height});
}

std::vector<Palette::Cluster> Palette::read(const float* colors, int count) {
  std::vector<Cluster> result;
  for (int k = 0; k < count; ++k) {
    const float* color = colors + 4 * k;
    const float* log_color = color + 4 * kMaxClusters;
    result.push_back({{color[0], color[1], color[2]},
                      {log_color[0], log_color[1], log_color[2]},
                      static_cast<int>(color[3])});
  }
  return result;
}

}  // namespace inverse
