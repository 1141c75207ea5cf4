#include "palette.hpp"

#include <algorithm>
#include <utility>

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(palette_gauge_count);
INVERSE_SHADER(palette_gauge);
INVERSE_SHADER(palette_count);
INVERSE_SHADER(palette_average);
INVERSE_SHADER(palette_compact);
INVERSE_SHADER(palette_seed);
INVERSE_SHADER(palette_cluster);
INVERSE_SHADER(palette_merge);
INVERSE_SHADER(palette_assign);

namespace inverse {
namespace {

constexpr uint32_t kBinCount = 30 * 30 * 30;
constexpr uint32_t kGaugeBins = 2048;
constexpr uint32_t kOneGroup = 128;  // invocations of the kernels that run as a single workgroup

/// As in palette.glsl.
struct Push {
  uint32_t width, height;
  int32_t first, clusters, iterations;
  uint32_t frame, seed;
  float decay, fade, apart, tau_cc, tau_intensity, chroma_floor, gauge_quantile, gauge_value,
      fraction_scale;
};

}  // namespace

Palette::Palette(const std::shared_ptr<gpu::Device>& device)
    : gauge_count_(device->kernel(shaders::palette_gauge_count)),
      gauge_kernel_(device->kernel(shaders::palette_gauge, {}, kOneGroup)),
      count_(device->kernel(shaders::palette_count)),
      average_(device->kernel(shaders::palette_average)),
      compact_(device->kernel(shaders::palette_compact, {}, kOneGroup)),
      seed_(device->kernel(shaders::palette_seed, {}, kOneGroup)),
      cluster_(device->kernel(shaders::palette_cluster, {}, kOneGroup)),
      merge_(device->kernel(shaders::palette_merge)),
      assign_(device->kernel(shaders::palette_assign)) {
  const auto buffer = [&](gpu::Element element, uint64_t count) {
    return gpu::Buffer::create(device, element, count);
  };
  gauge_counts_ = buffer(gpu::Element::word, kGaugeBins);
  gauge_ = buffer(gpu::Element::scalar, 1);
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
  params_.gauge_quantile = std::clamp(params.gauge_quantile, 0.0f, 1.0f);
  params_.gauge_value = std::max(params.gauge_value, 1e-3f);
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
         {gauge_counts_, gauge_, counts_, clusters_, palette_, histogram_[0], histogram_[1]}) {
      commands.fill(buffer);
    }
    cleared_ = true;
  }
  if (first_) frame_ = 0;
  const Push push{extent.width,         extent.height,
                  first_ ? 1 : 0,       params_.clusters,
                  params_.iterations,   frame_++,
                  params_.seed,         params_.decay,
                  params_.fade,         params_.apart,
                  params_.tau_cc,       params_.tau_intensity,
                  params_.chroma_floor, params_.gauge_quantile,
                  params_.gauge_value,  static_cast<float>(scale)};
  const gpu::Items pixels{extent.width, extent.height};
  const gpu::Items one_group{kOneGroup};
  commands.dispatch(gauge_count_, {log_reflectance.buffer, gauge_counts_}, push, pixels);
  commands.dispatch(gauge_kernel_, {gauge_counts_, gauge_}, push, one_group);
  commands.dispatch(count_, {log_reflectance.buffer, gauge_, counts_}, push, pixels);
  std::swap(histogram_[0], histogram_[1]);
  commands.dispatch(average_, {counts_, histogram_[1], histogram_[0]}, push, {kBinCount});
  commands.dispatch(compact_, {histogram_[0], list_, list_length_}, push, one_group);
  commands.dispatch(seed_, {list_, list_length_, clusters_}, push, one_group);
  commands.dispatch(cluster_, {list_, list_length_, clusters_, labels_}, push, one_group);
  commands.dispatch(merge_, {clusters_, gauge_, palette_}, push, {1});
  first_ = false;
}

void Palette::record_assign(gpu::Commands& commands, const Plane& log_reflectance,
                            const Plane& clusters) const {
  Push push{};
  push.width = log_reflectance.extent.width;
  push.height = log_reflectance.extent.height;
  push.clusters = params_.clusters;
  commands.dispatch(assign_, {log_reflectance.buffer, palette_, clusters.buffer}, push,
                    {push.width, push.height});
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
