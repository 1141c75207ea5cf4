// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_strokes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kernels/gpu/frame_ring.hpp"

namespace inverse {
namespace {

using Shader = shaders::depth_strokes_grow;
static_assert(Shader::STATE_BLOCKS == Shader::STATE_STRIDE * (Shader::FILL_PASSES + 1));
static_assert(Shader::FILL_PASSES % 2 == 0, "the last front is the first one of the next frame");
static_assert(kMaxStrokes <= 64, "mark.comp has a bit for each");

constexpr uint64_t kArguments = sizeof(uint32_t) * Shader::STATE_STRIDE;  // of a dispatch
constexpr uint32_t kColumns = 64;                                         // mark.comp

}  // namespace

SceneStrokes::SceneStrokes(const std::shared_ptr<gpu::Device>& device, const Volume& volume)
    : select_(device),
      mark_(device, {}, kColumns),
      grow_(device, {}, Shader::FRONT_GROUP),
      close_(device),
      marked_(gpu::make_table(device, gpu::Element::word,
                              std::vector<uint32_t>(volume.params().blocks))),
      list_(gpu::Buffer::create(device, gpu::Element::word, volume.params().blocks)),
      sums_(gpu::make_table(device, gpu::Element::word,
                            std::vector<uint32_t>(Shader::SUM_STRIDE * (kIds + 1)))),
      front_(gpu::Buffer::create(device, gpu::Element::word, 2 * Shader::FRONT_MAX)) {
  std::vector<uint32_t> start;
  while (start.size() < Shader::STATE_WORDS) start.insert(start.end(), {0, 1, 1, 0});
  start_ = gpu::make_table(device, gpu::Element::word, start);
  state_ = gpu::make_table(device, gpu::Element::word, start);
}

void SceneStrokes::set(const StrokesPtr& list) {
  const auto before = std::exchange(strokes_, {});
  const auto fresh_before = std::exchange(fresh_, {});
  std::vector<const Stroke*> taken;
  const size_t count = list ? std::min(list->strokes.size(), kMaxStrokes) : 0;
  for (size_t i = 0; i < count; ++i)
    if (list->strokes[i].in_scene()) taken.push_back(&list->strokes[i]);
  order_.assign(taken.size(), 0);
  for (size_t i = 0; i < taken.size(); ++i)
    for (uint32_t k = 0; k < kIds && order_[i] == 0; ++k)
      if (!strokes_[k] && before[k] == *taken[i]) {
        strokes_[k] = before[k];
        fresh_[k] = fresh_before[k];
        order_[i] = k + 1;
      }
  for (size_t i = 0; i < taken.size(); ++i) {
    if (order_[i] != 0) continue;
    uint32_t k = 0;
    while (strokes_[k] || marked_ids_[k]) ++k;
    strokes_[k] = *taken[i];
    fresh_[k] = true;
    order_[i] = k + 1;
  }
  fills_ = std::ranges::any_of(taken, [](const Stroke* stroke) { return stroke->fill; });
  changed_ = changed_ || strokes_ != before;
}

void SceneStrokes::write_tables(gpu::Commands& commands) {
  std::vector<std::array<float, 4>> brushes, balls;
  std::vector<uint32_t> ids(kIds + 1);
  for (const uint32_t id : order_) {
    const Stroke& stroke = *strokes_[id - 1];
    std::array<float, 4> low = stroke.balls[0], high = low;
    for (const auto& ball : stroke.balls)
      for (size_t c = 0; c < 4; ++c) {
        low[c] = std::min(low[c], ball[c]);
        high[c] = std::max(high[c], ball[c]);
      }
    float squares = 0;
    for (size_t c = 0; c < 3; ++c) squares += (high[c] - low[c]) * (high[c] - low[c]) / 4;
    brushes.push_back({(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2,
                       std::sqrt(squares) + high[3]});
    brushes.push_back({static_cast<float>(balls.size()), static_cast<float>(stroke.balls.size()),
                       static_cast<float>(id), 0});
    balls.insert(balls.end(), stroke.balls.begin(), stroke.balls.end());
    ids[id] = uint32_t{Shader::ID_KEPT} | (stroke.fill ? Shader::ID_FILLS : 0U) |
              (fresh_[id - 1] ? Shader::ID_FRESH : 0U);
  }
  if (balls.empty()) balls.emplace_back();
  if (brushes.empty()) brushes.resize(2);
  commands.write_table(brushes_, gpu::Element::vec4, brushes);
  commands.write_table(balls_, gpu::Element::vec4, balls);
  commands.write_table(ids_, gpu::Element::word, ids);
}

void SceneStrokes::record_marks(gpu::Commands& commands, const Volume& volume) {
  write_tables(commands);
  const auto brushes = static_cast<uint32_t>(order_.size());
  const uint32_t blocks = volume.params().blocks;
  commands.dispatch(select_,
                    {.table = volume.table(),
                     .keys = volume.keys(),
                     .colored = volume.colored(),
                     .brushes = brushes_,
                     .ids = ids_,
                     .marked = marked_,
                     .sums = sums_,
                     .state = state_,
                     .list = list_},
                    {.table_mask = volume.table_mask(),
                     .blocks = blocks,
                     .ids = uint32_t{kIds + 1},
                     .brushes = brushes,
                     .voxel = volume.params().voxel,
                     .all = uint32_t{changed_}},
                    std::max(blocks, uint32_t{kIds + 1}));
  commands.dispatch_indirect(mark_,
                             {.list = list_,
                              .keys = volume.keys(),
                              .brushes = brushes_,
                              .balls = balls_,
                              .ids = ids_,
                              .colors = volume.colors(),
                              .voxels = volume.voxels(),
                              .marked = marked_,
                              .sums = sums_,
                              .front = front_,
                              .state = state_},
                             {.brushes = brushes, .voxel = volume.params().voxel}, state_,
                             sizeof(uint32_t) * Shader::STATE_BLOCKS);
  for (size_t k = 0; k < kIds; ++k) marked_ids_[k] = strokes_[k].has_value();
  fresh_ = {};
  changed_ = false;
}

void SceneStrokes::record(gpu::Commands& commands, Volume& volume, bool grown) {
  const bool marks = changed_ || (grown && !order_.empty());
  if (marks) busy_ = gpu::kFramesInFlight + 1;
  if (busy_ == 0) return;
  --busy_;
  volume.changed();
  // The last front of the frame before goes on.
  commands.copy(state_, state_, kArguments, kArguments * Shader::FILL_PASSES);
  commands.copy(start_, state_, start_->bytes() - kArguments, kArguments, kArguments);
  if (marks) record_marks(commands, volume);
  for (uint32_t pass = 0; fills_ && pass < Shader::FILL_PASSES; ++pass)
    commands.dispatch_indirect(grow_,
                               {.table = volume.table(),
                                .keys = volume.keys(),
                                .colors = volume.colors(),
                                .sums = sums_,
                                .voxels = volume.voxels(),
                                .marked = marked_,
                                .front = front_,
                                .state = state_},
                               {.table_mask = volume.table_mask(), .pass = pass}, state_,
                               kArguments * pass);
}

void SceneStrokes::record_close(gpu::Commands& commands, const Volume::View& view,
                                const gpu::BufferPtr& closed) {
  commands.dispatch(close_, {.ids = view.strokes, .closed = closed}, {.size = view.extent},
                    static_cast<uint32_t>(view.extent.pixels()));
}

void SceneStrokes::heard(uint32_t left) {
  if (left > 0) busy_ = std::max(busy_, 1U);
}

}  // namespace inverse
