// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

namespace inverse {
namespace {

using shaders::depth_list;
using shaders::depth_memory_keep_found;
using shaders::depth_tracking_move;

constexpr uint64_t kFoundBytes = depth_memory_keep_found::kFoundStride * 4 * sizeof(float);
constexpr uint64_t kStateBytes = depth_list::kStateWords * sizeof(uint32_t);
constexpr uint64_t kPoseBytes = 8 * sizeof(float);
constexpr uint32_t kCells = shaders::depth_memory_thumbnail::kThumbnailWidth *
                            shaders::depth_memory_thumbnail::kThumbnailHeight;
constexpr uint64_t kThumbnailBytes = kCells * 4 * sizeof(float);
constexpr uint64_t kLeftBytes = sizeof(uint32_t), kOutdatedBytes = sizeof(uint32_t);
// Of what is read back: what tracking found, the volume's state, the pose, the thumbnail, how many
// voxels strokes are to spread from, whether the view was rendered, what is touched.
constexpr uint64_t kStateAt = kFoundBytes, kPoseAt = kStateAt + kStateBytes,
                   kThumbnailAt = kPoseAt + kPoseBytes, kLeftAt = kThumbnailAt + kThumbnailBytes,
                   kOutdatedAt = kLeftAt + kLeftBytes, kTouchAt = kOutdatedAt + kOutdatedBytes,
                   kReadBytes = kTouchAt + TouchFinder::kResultBytes;
// Additions of frames after which strokes are drawn into what is new.
constexpr uint32_t kStrokesEvery = 4;

Pose pose_in(const gpu::BufferPtr& read) {
  const float* values = read->map_as<float>() + kPoseAt / sizeof(float);
  Pose pose;
  std::copy_n(values, 4, pose.rotation.begin());
  std::copy_n(values + 4, 4, pose.place.begin());
  return pose;
}

/// For a camera whose pose is only known roughly, and whose light is not.
Tracker::Params from_afar(Tracker::Params params) {
  params.steps = {4, 6, 10};
  params.max_distance = {0.05F, 0.15F, 0.3F};
  return params;
}

}  // namespace

SceneMemory::SceneMemory(const std::shared_ptr<gpu::Device>& device, Extent depth,
                         const Params& params)
    : params_(params),
      depth_extent_(depth),
      step_((depth.width - 1) / std::max(params.max_width, 1U) + 1),
      extent_{(depth.width - 1) / step_ + 1, (depth.height - 1) / step_ + 1},
      volume_(device, params.volume),
      tracker_(device, extent_),
      view_(device, extent_),
      read_depth_(device),
      keep_found_(device),
      resize_(device),
      retry_(device),
      thumbnail_(device),
      see_(device),
      surfaces_(device, extent_),
      poses_(device, {shaders::depth_memory_see::kPoseRows, 1}),
      depth_(gpu::Buffer::create(device, gpu::Element::scalar, extent_.pixels())),
      kept_depth_(gpu::Buffer::create(device, gpu::Element::scalar, extent_.pixels())),
      certain_(gpu::Buffer::create(device, gpu::Element::vec4,
                                   depth_memory_keep_found::kFoundStride, gpu::Memory::upload)),
      thumbnail_plane_(gpu::Buffer::create(device, gpu::Element::vec4, kCells)),
      device_(device),
      keyframes_(params.keyframes),
      host_blocks_(device) {
  auto* certain = certain_->map_as<float>();
  std::fill_n(certain, kFoundBytes / sizeof(float), 0.0F);
  certain[0] = 1;
  certain[5] = 1;  // the share that matches
}

const gpu::BufferPtr& SceneMemory::resized(gpu::Commands& commands, const Plane& plane) {
  if (plane.extent == extent_) return plane.buffer;
  if (!resized_) resized_ = gpu::Buffer::create(device_, gpu::Element::vec4, extent_.pixels());
  commands.dispatch(resize_, {.plane = plane.buffer, .resized = resized_},
                    {.from = plane.extent, .to = extent_}, static_cast<uint32_t>(extent_.pixels()));
  return resized_;
}

void SceneMemory::read(gpu::Commands& commands, uint64_t number, const Depth& depth) {
  InFlight& frame = frames_[number];
  if (!frame.image) {
    frame.image = gpu::Buffer::create(device_, gpu::Element::word, (extent_.pixels() + 1) / 2,
                                      gpu::Memory::upload);
    frame.pose = gpu::Buffer::create(device_, gpu::Element::vec4, 2, gpu::Memory::upload);
    frame.found = gpu::Buffer::create(device_, gpu::Element::word, kReadBytes / sizeof(uint32_t),
                                      gpu::Memory::readback);
    std::fill_n(frame.found->map_as<uint32_t>(), kReadBytes / sizeof(uint32_t), 0U);
  }
  auto* to = frame.image->map_as<std::byte>();
  constexpr size_t kPixel = sizeof(uint16_t);
  for (uint32_t y = 0; y < extent_.height; ++y) {
    const std::byte* row =
        depth.rows + std::min(step_ * y + step_ / 2, depth_extent_.height - 1) * depth.stride;
    for (uint32_t x = 0; x < extent_.width; ++x, to += kPixel)
      std::memcpy(to, row + kPixel * std::min(step_ * x + step_ / 2, depth_extent_.width - 1),
                  kPixel);
  }
  const auto pixels = static_cast<uint32_t>(extent_.pixels());
  commands.dispatch(read_depth_, {.image = frame.image, .depth = depth_},
                    {.pixels = pixels, .unit = depth.unit}, pixels);
}

const gpu::BufferPtr& SceneMemory::upload(uint64_t number, const Pose& pose) {
  const gpu::BufferPtr& from = frames_[number].pose;
  auto* values = from->map_as<float>();
  std::ranges::copy(pose.rotation, values);
  std::ranges::copy(pose.place, values + 4);
  return from;
}

bool SceneMemory::stands(const Pose& pose, float matched) const {
  constexpr float kTurn = 0.0044F, kMatched = 0.05F;  // radians; share of the depth image
  float squares = 0, along = 0;
  for (size_t c = 0; c < 3; ++c)
    squares += (pose.place[c] - still_.pose.place[c]) * (pose.place[c] - still_.pose.place[c]);
  for (size_t c = 0; c < 4; ++c) along += pose.rotation[c] * still_.pose.rotation[c];
  return std::sqrt(squares) < params_.volume.voxel / 2 &&
         2 * std::acos(std::min(std::abs(along), 1.0F)) < kTurn &&
         std::abs(matched - still_.matched) < kMatched;
}

std::optional<Pose> SceneMemory::learn(uint64_t number) {
  if (!std::exchange(frames_[number].number, {})) return {};
  const auto* numbers = frames_[number].found->map_as<float>();
  Keyframes::Picture picture;
  for (const float* cell = numbers + kThumbnailAt / sizeof(float); picture.depth.size() < kCells;
       cell += 4) {
    picture.brightness.push_back(cell[0]);
    picture.depth.push_back(cell[1]);
  }
  if (numbers[0] > 0) {
    tries_ = 0;
    const Pose pose = pose_in(frames_[number].found);
    const float matched = numbers[4 * depth_tracking_move::kFit + 1];
    if (!stands(pose, matched)) still_ = {pose, matched, 0};
    keyframes_.add(picture, pose);
    const auto* state = frames_[number].found->map_as<uint32_t>() + kStateAt / sizeof(uint32_t);
    last_known_ = {pose, state[depth_list::kFree]};
    return {};
  }
  // Each candidate as long as it takes to hear that it was right.
  const std::vector<Pose> poses = keyframes_.like(picture, params_.candidates);
  if (poses.empty()) return {};
  const Pose& pose = poses[tries_++ / (gpu::kFramesInFlight + 1) % poses.size()];
  if (last_known_) last_known_->pose = pose;
  return pose;
}

std::optional<KnownReflectance> SceneMemory::record_recall(gpu::Commands& commands, uint64_t number,
                                                           const Depth& depth,
                                                           const Plane& picture) {
  number_ = number;
  const uint32_t middle = step_ / 2;  // the pixel of a step that is used
  const auto step = static_cast<float>(step_), first = static_cast<float>(middle);
  lens_ = {depth.lens.fx / step, depth.lens.fy / step, (depth.lens.cx - first) / step,
           (depth.lens.cy - first) / step};
  if (strokes_ && frames_[number].number)
    strokes_->heard(*(frames_[number].found->map_as<uint32_t>() + kLeftAt / sizeof(uint32_t)));
  std::optional<Pose> candidate = learn(number);
  Tracker::Params search = from_afar(params_.tracker);
  if (std::exchange(searches_, false)) {
    // The stream's own pose is no guess.
    if (depth.pose) search.lost_share = search.min_share;
    tracker_.record_lost(commands);
    const Pose first = keyframes_.size() > 0 ? keyframes_.frames()[0].pose : Pose{};
    candidate = depth.pose.value_or(first);
  }
  read(commands, number, depth);
  tracker_.record_frame(commands, lens_, depth_, resized(commands, picture));
  tracked_ = added_ > 0 && (params_.track || !depth.pose);
  if (!tracked_) {
    tracker_.record_pose(commands, upload(number, depth.pose.value_or(Pose{})));
  } else if (candidate) {
    commands.dispatch(retry_,
                      {.found = tracker_.found(),
                       .candidate = upload(number, *candidate),
                       .pose = tracker_.pose()},
                      gpu::Items{1});
    volume_.record_march(commands, lens_, tracker_.pose(), view_);
    // Of the light there, only its mean may be like that of the frame before.
    tracker_.record_target(commands, view_, lit_ ? lit_ : resized(commands, picture));
    tracker_.record_align(commands, search);
  } else {
    tracker_.record_align(commands, params_.tracker);
  }
  commands.stage("camera");
  viewed_ = added_ > 0;
  if (!viewed_) return {};
  if (strokes_ && strokes_->busy()) {
    strokes_->record(commands, volume_, false);
    commands.stage("scene-strokes");
  }
  volume_.record_march(commands, lens_, tracker_.pose(), view_);
  if (strokes_ && !strokes_->empty()) strokes_->record_close(commands, view_, stroke_ids_);
  commands.stage("view");
  return KnownReflectance{.extent = extent_,
                          .reflectance = view_.reflectance,
                          .known_depth = view_.depth,
                          .depth = depth_,
                          .valid = tracked_ ? tracker_.found() : certain_,
                          .weight = params_.weight,
                          .surface = view_.surface,
                          .outdated = view_.outdated,
                          .focal = lens_.fx};
}

void SceneMemory::record_remember(gpu::Commands& commands, const Plane& layers) {
  const auto pixels = static_cast<uint32_t>(extent_.pixels());
  const gpu::BufferPtr& found = tracked_ ? tracker_.found() : certain_;
  const gpu::BufferPtr& here = resized(commands, layers);
  if (added_ == 0 && !updates_) return;  // there is no view to follow the camera by
  const bool looks = touches_ && viewed_;
  if (looks) {
    touch_->record(commands,
                   {.lens = lens_,
                    .pose = tracker_.pose(),
                    .surface = tracker_.surface(),
                    .layers = here,
                    .found = found},
                   view_);
    commands.stage("touch");
  }
  const bool adds = updates_ && number_ >= next_ && still_.added < params_.still;
  if (adds) {
    ++still_.added;
    commands.dispatch(keep_found_, {.depth = depth_, .found = found, .kept = kept_depth_},
                      {.pixels = pixels}, pixels);
    if (looks) touch_->record_background(commands, kept_depth_);
    volume_.record_integrate(
        commands, {lens_, extent_, tracker_.pose(), kept_depth_, tracker_.surface()}, here, {});
    commands.stage("fusion");
    if (added_ == 0) volume_.record_march(commands, lens_, tracker_.pose(), view_);
    next_ = number_ + (++added_ < params_.always ? 1 : params_.every);
    if (strokes_ && !strokes_->empty() && added_ % kStrokesEvery == 0) {
      strokes_->record(commands, volume_, true);
      commands.stage("scene-strokes");
    }
  }
  if (last_known_)
    host_blocks_.record(commands, number_, volume_, {lens_, extent_, tracker_.pose()}, *last_known_,
                        stroke_lists_);
  tracker_.record_target(commands, view_, here);
  if (!lit_) lit_ = gpu::Buffer::create(device_, gpu::Element::vec4, extent_.pixels());
  commands.copy(here, lit_, lit_->bytes());
  const Tracker::Small small = tracker_.small();
  commands.dispatch(
      thumbnail_,
      {.brightness = small.brightness, .depth = small.depth, .thumbnail = thumbnail_plane_},
      {.size = small.extent}, kCells);
  commands.stage("target");
  std::vector<gpu::Commands::CopyPart> parts{
      {.source = found, .bytes = kFoundBytes},
      {.source = volume_.state(), .bytes = kStateBytes, .target_offset = kStateAt},
      {.source = tracker_.pose(), .bytes = kPoseBytes, .target_offset = kPoseAt},
      {.source = thumbnail_plane_, .bytes = kThumbnailBytes, .target_offset = kThumbnailAt},
      {.source = view_.outdated, .bytes = kOutdatedBytes, .target_offset = kOutdatedAt}};
  InFlight& frame = frames_[number_];
  frame.added = adds;
  frame.blocks_host = static_cast<uint32_t>(host_blocks_.size());
  frame.touches = looks;
  if (looks)
    parts.push_back({.source = touch_->result(),
                     .bytes = TouchFinder::kResultBytes,
                     .target_offset = kTouchAt});
  if (strokes_)
    parts.push_back({.source = strokes_->state(),
                     .bytes = kLeftBytes,
                     .source_offset = SceneStrokes::kLeftOffset,
                     .target_offset = kLeftAt});
  commands.copy(parts, frame.found);
  frame.lens = lens_;
  frame.has_depth = keeps_views_ && viewed_;
  if (frame.has_depth) {
    if (!frame.depth)
      frame.depth = gpu::Buffer::create(device_, gpu::Element::scalar, extent_.pixels(),
                                        gpu::Memory::readback);
    commands.copy(view_.depth, frame.depth, view_.depth->bytes());
  }
  frames_[number_].number = number_;
}

SceneData SceneMemory::data() {
  SceneData scene{volume_.data(), keyframes_.frames(), {}};
  host_blocks_.append_to(scene.volume);
  return scene;
}

std::shared_ptr<const SeenScene> SceneMemory::record_seen(gpu::Commands& commands) {
  if (added_ == 0) return nullptr;
  const Volume::Params& volume = volume_.params();
  SeenScene seen{.extent = extent_,
                 .lens = lens_,
                 .surface = surfaces_.acquire(),
                 .pose = poses_.acquire(),
                 .table = volume_.table(),
                 .voxels = volume_.voxels(),
                 .table_mask = volume_.table_mask(),
                 .voxel = volume.voxel,
                 .truncation = volume.truncation * volume.voxel};
  const auto pixels = static_cast<uint32_t>(extent_.pixels());
  commands.dispatch(see_,
                    {.view = view_.surface,
                     .measured = tracker_.surface(),
                     .camera = view_.pose,
                     .found = tracked_ ? tracker_.found() : certain_,
                     .surface = seen.surface->buffer,
                     .pose = seen.pose->buffer},
                    {.pixels = pixels}, pixels);
  return std::make_shared<const SeenScene>(std::move(seen));
}

void SceneMemory::restore(const SceneData& scene) {
  for (const Keyframes::Frame& frame : scene.keyframes)
    if (frame.picture.depth.size() != kCells)
      throw Error(ErrorKind::file, "its keyframes have another size; save it again");
  // Room for what comes into sight.
  VolumeData blocks = scene.volume;
  host_blocks_.take_rest(blocks, params_.volume.blocks / 4 * 3);
  volume_.restore(blocks);
  const auto room = params_.volume.blocks - static_cast<uint32_t>(blocks.keys.size());
  last_known_ = {scene.keyframes.empty() ? Pose{} : scene.keyframes[0].pose, room};
  keyframes_.set(scene.keyframes);
  added_ = params_.always;
  searches_ = true;
}

bool SceneMemory::look_for_camera() {
  searches_ = keyframes_.size() > 0;
  return searches_;
}

void SceneMemory::set_strokes(const StrokesPtr& strokes) {
  if (strokes == stroke_list_) return;
  stroke_list_ = strokes;
  ++stroke_lists_;
  const bool any = strokes && std::ranges::any_of(strokes->strokes, &Stroke::in_scene);
  if (!strokes_ && any) {
    strokes_.emplace(device_, volume_);
    stroke_ids_ = gpu::Buffer::create(device_, gpu::Element::word, extent_.pixels());
  }
  if (strokes_) strokes_->set(strokes);
}

void SceneMemory::set_touch(bool touches) {
  touches_ = touches;
  if (touches_ && !touch_) touch_.emplace(device_, extent_);
}

std::optional<Touch> SceneMemory::touch(uint64_t number) const {
  const InFlight& frame = frames_[number];
  if (frame.number != number || !frame.touches) return {};
  return TouchFinder::read(frame.found->map_as<float>() + kTouchAt / sizeof(float));
}

std::optional<SeenStrokes> SceneMemory::seen_strokes() const {
  if (!viewed_ || !strokes_ || strokes_->empty()) return {};
  return SeenStrokes{.extent = extent_,
                     .ids = stroke_ids_,
                     .known_depth = view_.depth,
                     .depth = depth_,
                     .valid = tracked_ ? tracker_.found() : certain_,
                     .strokes = strokes_->strokes()};
}

std::optional<SceneView> SceneMemory::view(uint64_t number) const {
  const InFlight& frame = frames_[number];
  const auto found = findings(number);
  if (!found || !found->found) return {};
  SceneView view{.extent = extent_, .lens = frame.lens, .pose = pose_in(frame.found), .depth = {}};
  if (frame.has_depth) view.depth = {frame.depth->map_as<float>(), extent_.pixels()};
  return view;
}

std::optional<SceneMemory::Findings> SceneMemory::findings(uint64_t number) const {
  const InFlight& frame = frames_[number];
  if (frame.number != number) return {};
  const auto* numbers = frame.found->map_as<float>();
  const auto* state = frame.found->map_as<uint32_t>() + kStateAt / sizeof(uint32_t);
  const float* fit = numbers + size_t{4} * depth_tracking_move::kFit;
  std::optional<float> front;
  if (frame.touches) front = TouchFinder::front(numbers + kTouchAt / sizeof(float));
  return Findings{.found = numbers[0] > 0,
                  .frames_lost = static_cast<uint32_t>(numbers[1]),
                  .rms = fit[0],
                  .matched = fit[1],
                  .blocks = volume_.params().blocks - state[depth_list::kFree],
                  .blocks_visible = state[depth_list::kListed],
                  .blocks_host = frame.blocks_host,
                  .blocks_refused = state[depth_list::kRefused],
                  .blocks_outside = state[depth_list::kOutside],
                  .keyframes = static_cast<uint32_t>(keyframes_.size()),
                  .view_kept = frame.found->map_as<uint32_t>()[kOutdatedAt / sizeof(uint32_t)] == 0,
                  .added = frame.added,
                  .front = front};
}

}  // namespace inverse
