// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracker.hpp"

#include <algorithm>

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {
namespace {

using shaders::depth_tracking_align;
using shaders::depth_tracking_move;

uint32_t items_of(Extent extent) {
  constexpr uint32_t kRows = depth_tracking_align::kRows;
  return extent.width * ((extent.height + kRows - 1) / kRows);
}

}  // namespace

Tracker::Tracker(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : smooth_(device),
      halve_(device),
      normals_(device),
      brightness_(device),
      appearance_(device),
      align_(device),
      align_geometry_(device, {.photometric = false}),
      move_(device, {}, gpu::kOneGroup),
      agree_(device, {}, gpu::kOneGroup),
      predict_(device),
      pose_(gpu::Buffer::create(device, gpu::Element::vec4, 2)),
      start_(gpu::Buffer::create(device, gpu::Element::vec4, 2)),
      before_(gpu::Buffer::create(device, gpu::Element::vec4, 2)),
      found_(gpu::Buffer::create(device, gpu::Element::vec4, depth_tracking_move::kFoundStride)),
      agreement_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      lost_(gpu::Buffer::create(device, gpu::Element::word, 1)) {
  for (Levels* levels : {&frame_, &target_}) {
    Extent size = extent;
    for (Level& level : *levels) {
      level.extent = size;
      level.depth = gpu::Buffer::create(device, gpu::Element::scalar, size.pixels());
      level.surface = gpu::Buffer::create(device, gpu::Element::vec4, size.pixels());
      level.brightness = gpu::Buffer::create(device, gpu::Element::scalar, size.pixels());
      size = half_of(size);
    }
  }
  const gpu::Items groups = align_.kernel()->groups(items_of(extent));
  sums_ = gpu::Buffer::create(device, gpu::Element::vec4,
                              uint64_t{groups.x} * groups.y * depth_tracking_align::kSums);
}

void Tracker::record_normals(gpu::Commands& commands, const Level& level) const {
  commands.dispatch(normals_, {.depth = level.depth, .surface = level.surface},
                    {.lens = level.lens.values(), .size = level.extent},
                    static_cast<uint32_t>(level.extent.pixels()));
}

void Tracker::record_coarser(gpu::Commands& commands, const Levels& levels) const {
  for (size_t l = 1; l < levels.size(); ++l) {
    const Level &fine = levels[l - 1], &level = levels[l];
    commands.dispatch(halve_,
                      {.fine_depth = fine.depth,
                       .fine_brightness = fine.brightness,
                       .depth = level.depth,
                       .brightness = level.brightness},
                      {.size = fine.extent}, static_cast<uint32_t>(level.extent.pixels()));
    record_normals(commands, level);
  }
}

void Tracker::record_frame(gpu::Commands& commands, const Lens& lens, const gpu::BufferPtr& depth,
                           const gpu::BufferPtr& picture) {
  float scale = 1;
  for (size_t l = 0; l < frame_.size(); ++l, scale /= 2)
    frame_[l].lens =
        target_[l].lens = {lens.fx * scale, lens.fy * scale, (lens.cx + 0.5F) * scale - 0.5F,
                           (lens.cy + 0.5F) * scale - 0.5F};
  const auto pixels = static_cast<uint32_t>(frame_[0].extent.pixels());
  commands.dispatch(smooth_, {.depth = depth, .smoothed = frame_[0].depth},
                    {.size = frame_[0].extent}, pixels);
  commands.dispatch(brightness_, {.picture = picture, .brightness = frame_[0].brightness},
                    {.size = frame_[0].extent}, pixels);
  record_normals(commands, frame_[0]);
  record_coarser(commands, frame_);
}

void Tracker::record_pose(gpu::Commands& commands, const gpu::BufferPtr& pose) {
  commands.copy(pose, pose_, pose_->bytes());
  commands.fill(found_);
  commands.fill(lost_);
}

void Tracker::record_lost(gpu::Commands& commands) {
  commands.fill(found_);
  commands.fill(lost_, 1);
}

void Tracker::record_target(gpu::Commands& commands, const Volume::View& view,
                            const gpu::BufferPtr& layers) {
  const auto pixels = static_cast<uint32_t>(frame_[0].extent.pixels());
  target_pose_ = view.pose;
  commands.dispatch(appearance_,
                    {.reflectance = view.reflectance,
                     .layers = layers,
                     .brightness = frame_[0].brightness,
                     .appearance = target_[0].brightness},
                    {.pixels = pixels}, pixels);
  target_[0].depth = view.depth;
  target_[0].surface = view.surface;
  record_coarser(commands, target_);
}

void Tracker::record_agreement(gpu::Commands& commands, const Params& params) {
  const size_t l = frame_.size() - 1;
  commands.when(lost_, 0, [&] {
    commands.dispatch(agree_,
                      {.surface = frame_[l].surface,
                       .pose = pose_,
                       .model = target_[l].surface,
                       .view_pose = target_pose_,
                       .brightness = frame_[l].brightness,
                       .appearance = target_[l].brightness,
                       .agreement = agreement_},
                      {.lens = frame_[l].lens.values(),
                       .size = frame_[l].extent,
                       .max_distance = params.max_distance[l]},
                      gpu::kOneGroup);
  });
}

void Tracker::record_align(gpu::Commands& commands, const Params& params) {
  commands.copy(pose_, start_, pose_->bytes());
  commands.dispatch(predict_, {.found = found_, .before = before_, .pose = pose_}, gpu::Items{1});
  for (size_t l = frame_.size(); l-- > 0;)
    for (uint32_t step = 0; step < params.steps[l]; ++step) {
      const Level& level = frame_[l];
      const gpu::Items groups = align_.kernel()->groups(items_of(level.extent));
      commands.dispatch(params.photometric[l] > 0 ? align_ : align_geometry_,
                        {.surface = level.surface,
                         .pose = pose_,
                         .model = target_[l].surface,
                         .view_pose = target_pose_,
                         .brightness = level.brightness,
                         .appearance = target_[l].brightness,
                         .sums = sums_},
                        {.lens = level.lens.values(),
                         .size = level.extent,
                         .max_distance = params.max_distance[l],
                         .min_cosine = params.min_cosine,
                         .photometric = params.photometric[l]},
                        items_of(level.extent));
      const bool last = l == 0 && step + 1 == params.steps[0];
      if (last) record_agreement(commands, params);
      commands.dispatch(move_,
                        {.sums = sums_,
                         .start = start_,
                         .pose = pose_,
                         .found = found_,
                         .agreement = agreement_,
                         .lost = lost_},
                        {.groups = groups.x * groups.y,
                         .damping = params.damping,
                         .last = uint32_t{last},
                         .min_share = params.min_share,
                         .lost_share = std::max(params.lost_share, params.min_share),
                         .max_rms = params.max_rms,
                         .min_alike = params.min_alike,
                         .plain = params.plain},
                        gpu::kOneGroup);
    }
}

}  // namespace inverse
