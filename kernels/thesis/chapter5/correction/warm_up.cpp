// SPDX-License-Identifier: LGPL-2.1-or-later
// GlobalThesis::warm_up and what corrects its clusters, run once on a tiny frame.
#include "warm_up.hpp"

#include <algorithm>
#include <string>

#include "misclustering_correction.hpp"
#include "region_proposals.hpp"

namespace inverse {
namespace {

constexpr Extent kTiny{64, 64};
constexpr int kRounds = 16;  // frames, enough for a region to be filled and its colors tried

/// Red and green halves.
Plane picture(const std::shared_ptr<gpu::Device>& device) {
  const Plane plane{
      kTiny, gpu::Buffer::create(device, gpu::Element::vec4, kTiny.pixels(), gpu::Memory::upload)};
  auto* values = plane.buffer->map_as<float>();
  for (uint32_t n = 0; n < kTiny.pixels(); ++n) {
    const bool left = n % kTiny.width < kTiny.width / 2;
    const float color[4] = {left ? 0.6f : 0.1f, left ? 0.1f : 0.6f, 0.1f, 1};
    std::copy_n(color, 4, values + 4 * static_cast<size_t>(n));
  }
  return plane;
}

/// Frames are recorded, waited for and collected.
class Runner {
 public:
  explicit Runner(const std::shared_ptr<gpu::Device>& device) : commands_(device) {}
  template <typename Record>
  auto operator()(Record record) {
    commands_.begin();
    const auto result = record(commands_);
    commands_.submit();
    commands_.wait();
    return result;
  }

 private:
  gpu::Commands commands_;
};

}  // namespace

void GlobalThesis::warm_up() const {
  // What decides which kernels there are.
  device_->warm_up_once("GlobalThesis, " + std::to_string(slots_) + " slots, " +
                            std::to_string(max_layers_) + " layers" +
                            (params_.p == 1 ? "" : ", any p"),
                        [this] { play_all(); });
}

void GlobalThesis::play_all() const {
  GlobalThesis tiny(device_, kTiny);
  Params params = params_;
  params.steps = params.pcg_iterations = 1;
  params.refine_rounds = 1;
  params.energy = params.line_search = true;
  params.trace = false;
  params.cut_fraction = 1;
  params.keyframe_spacing = 1;
  tiny.set_params(params);
  tiny.hold_frames(slots_);
  const Plane frame = picture(device_);
  const Plane regions{kTiny, gpu::Buffer::create(device_, gpu::Element::vec4, kTiny.pixels())};
  Runner run(device_);
  run([&](gpu::Commands& commands) {
    commands.fill(regions.buffer);
    tiny.record_colors(commands, frame);
    return 0;
  });
  for (int layers = 0; layers <= max_layers_; layers += 4) {
    tiny.set_base_colors(std::vector<Rgb>(static_cast<size_t>(layers), {0.9f, 0.2f, 0.1f}));
    Hints hints;
    hints.fixed_regions = &regions;
    hints.scored_region = 1;
    Layers output;
    tiny.collect(
        run([&](gpu::Commands& commands) { return tiny.record(commands, frame, output, hints); }));
  }
}

namespace {

/// Whether a region was corrected.
bool play_correction(const std::shared_ptr<gpu::Device>& device) {
  GlobalThesis method(device, kTiny);
  GlobalThesis::Params params;
  params.steps = params.pcg_iterations = 1;
  params.keyframes = params.refine_rounds = 0;
  method.set_params(params);
  const GlobalThesis::Rgb colors[] = {{0.9f, 0.15f, 0.15f}, {0.15f, 0.9f, 0.15f}};
  method.set_base_colors(colors);
  MarkedRegions regions(device, kTiny);
  MisclusteringCorrection correction(device, kTiny);
  RegionProposals proposals(device, kTiny);
  const Plane frame = picture(device);
  regions.click(1, 1);
  GlobalThesis::Hints hints;
  hints.regions = &regions;
  Runner run(device);
  for (int k = 0; k < kRounds; ++k) {
    Layers output;
    uint64_t corrected = 0;
    const uint64_t number = run([&](gpu::Commands& commands) {
      const uint64_t recorded = method.record(commands, frame, output, hints);
      corrected = correction.record(commands, method, regions);
      proposals.record(commands, method, regions, RegionProposals::Mode::report);
      return recorded;
    });
    method.collect(number);
    regions.collect(regions.last());
    if (correction.collect(corrected, regions)) return true;
  }
  return false;
}

}  // namespace

bool warm_up_correction(const std::shared_ptr<gpu::Device>& device) {
  bool all = true;
  device->warm_up_once("correction of GlobalThesis", [&] { all = play_correction(device); });
  return all;
}

}  // namespace inverse
