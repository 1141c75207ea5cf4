// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/decompose/scene_work.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gst/decompose/strokes/stroke_text.hpp"
#include "gst/inverse/inverse_depth_meta.h"
#include "kernels/depth/memory/scene_memory.hpp"

namespace inverse {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

/// What is wrong with a depth meta; empty: nothing.
std::string wrong_depth(const GstInverseDepthMeta& meta) {
  if (!meta.depth || meta.width == 0 || meta.height == 0 || meta.stride < 2 * meta.width ||
      gst_buffer_get_size(meta.depth) < size_t{meta.stride} * (meta.height - 1) + 2 * meta.width)
    return "the depth image of a frame is smaller than its meta says; the source that attached it "
           "is to be mended";
  if (!(meta.unit > 0 && meta.unit < 1))
    return "the unit of depth is " + std::to_string(meta.unit) +
           " m; give the meters of a step, as 0.001";
  const std::array lens{meta.fx, meta.fy, meta.cx, meta.cy};
  if (!std::ranges::all_of(lens, [](double v) { return std::isfinite(v); }) || meta.fx == 0 ||
      meta.fy == 0)
    return "the depth camera has a focal length of 0 or no number; give its calibration in pixels";
  return {};
}

constexpr const char* kLost =
    "the camera is lost: for 30 frames depth did not match the remembered scene; frames are "
    "decomposed without it until the camera sees something that it knows";
constexpr uint32_t kLongLost = 30;  // frames

/// What a depth image is like at every eighth pixel of every eighth row.
struct Looked {
  double known = 0;  ///< share of pixels
  float median = 0;  ///< of these, meters
  float far = 0;     ///< their 90th percentile, meters
};
Looked look_at(const SceneMemory::Depth& depth) {
  constexpr uint32_t kStep = 8;
  std::vector<uint16_t> steps;
  size_t pixels = 0;
  for (uint32_t y = 0; y < depth.extent.height; y += kStep)
    for (uint32_t x = 0; x < depth.extent.width; x += kStep, ++pixels) {
      const uint16_t value = GST_READ_UINT16_LE(depth.rows + y * depth.stride + size_t{2} * x);
      if (value != 0 && value != G_MAXUINT16) steps.push_back(value);
    }
  if (steps.empty()) return {};
  const auto quantile = [&](size_t tenths) {
    const auto at = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() * tenths / 10);
    std::ranges::nth_element(steps, at);
    return static_cast<float>(*at) * depth.unit;
  };
  return {static_cast<double>(steps.size()) / static_cast<double>(pixels), quantile(5),
          quantile(9)};
}

std::string number_text(float value) {
  std::array<char, 32> text;
  snprintf(text.data(), text.size(), "%.3g", double{value});
  return text.data();
}

bool alike(const SceneParams& a, const SceneParams& b) {
  return a.scene_track == b.scene_track && a.voxel_size == b.voxel_size &&
         a.scene_depth == b.scene_depth && a.scene_load == b.scene_load &&
         a.scene_memory_limit == b.scene_memory_limit;
}

SceneMemory::Params memory_params(const SceneParams& params) {
  SceneMemory::Params made;
  made.volume.voxel = params.voxel_size;
  made.volume.max_depth = params.scene_depth;
  made.volume.blocks =
      static_cast<uint32_t>(params.scene_memory_limit * kMiB / Volume::kBlockBytes);
  // At a voxel of 1 cm more than 320 pixels across cost time and bring nothing.
  made.max_width = static_cast<uint32_t>(std::clamp(3.2F / params.voxel_size, 320.0F, 1280.0F));
  made.track = params.scene_track;
  return made;
}

class RememberedScene final : public SceneWork {
 public:
  void configure(const std::shared_ptr<gpu::Device>& device) override { device_ = device; }
  void release() override;
  const KnownReflectance* recall(FrameContext& frame, uint64_t number, const SceneParams& params,
                                 const Wanted& wanted) override;
  const SeenStrokes* seen() const override { return seen_ ? &*seen_ : nullptr; }
  std::optional<SceneView> view(uint64_t number) const override {
    return memory_ ? memory_->view(number) : std::nullopt;
  }
  std::optional<Touch> touch(uint64_t number) const override {
    return memory_ ? memory_->touch(number) : std::nullopt;
  }
  bool began() const override { return began_; }
  std::vector<Stroke> take_loaded() override { return std::exchange(loaded_, {}); }
  void remember(FrameContext& frame) override;
  void forget() override { forgets_ = true; }
  void save(const std::string& path) override;
  bool requested() const override;
  void ended(const std::string& location) override;
  void describe(GstStructure* stats, uint64_t number) const override;

 private:
  /// A depth image that is mapped while this lives.
  class Image;

  /// Forgets the scene.
  void reset();
  /// Adds a warning that was not given since the last reset.
  void warn(FrameContext& frame, const std::string& text);
  void warn_of(FrameContext& frame, const SceneMemory::Findings& found);
  /// Reads a scene into the memory; a warning if it cannot.
  void load(FrameContext& frame, const std::string& path);
  /// The scene with its strokes, for a file.
  SceneData data();
  /// Writes the files that were asked for.
  void write_wanted(FrameContext& frame);
  /// Makes the memory for frames like this one; false, with a warning, if it cannot.
  bool begin(FrameContext& frame, const SceneMemory::Depth& depth, const SceneParams& params);

  std::shared_ptr<gpu::Device> device_;
  std::optional<SceneMemory> memory_;
  SceneParams made_with_;
  std::optional<KnownReflectance> known_;
  std::optional<SeenStrokes> seen_;
  StrokesPtr strokes_;          // all of the last frame
  std::vector<Stroke> loaded_;  // from a file
  bool remembers_ = false;      // this frame
  bool began_ = false;
  std::set<std::string> told_;
  bool written_ = false;  // `location`, since the last frame
  std::atomic<bool> has_scene_ = false, forgets_ = false;
  mutable std::mutex mutex_;
  std::vector<std::string> wanted_;  // files
};

class RememberedScene::Image {
 public:
  explicit Image(GstBuffer* buffer) : buffer_(buffer) {
    mapped_ = gst_buffer_map(buffer, &map_, GST_MAP_READ);
  }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;
  ~Image() {
    if (mapped_) gst_buffer_unmap(buffer_, &map_);
  }
  const std::byte* rows() const {
    return mapped_ ? reinterpret_cast<const std::byte*>(map_.data) : nullptr;
  }

 private:
  GstBuffer* buffer_;
  GstMapInfo map_{};
  bool mapped_;
};

void RememberedScene::release() {
  reset();
  device_.reset();
}

void RememberedScene::reset() {
  has_scene_ = false;
  memory_.reset();
  seen_.reset();
  loaded_.clear();
  told_.clear();
}

void RememberedScene::warn(FrameContext& frame, const std::string& text) {
  if (told_.insert(text).second) frame.warnings.push_back(text);
}

bool RememberedScene::begin(FrameContext& frame, const SceneMemory::Depth& depth,
                            const SceneParams& params) {
  constexpr double kMinKnown = 0.1;
  constexpr float kNearScene = 0.7F, kFarScene = 9;  // meters; a wrong unit is off by 5 or more
  const Looked looked = look_at(depth);
  if (looked.known < kMinKnown) {
    warn(frame,
         "depth is unknown almost everywhere; check the source of depth. The scene is remembered "
         "from the first frame on that has more");
    return false;
  }
  if (!(looked.median >= Volume::Params{}.min_depth && looked.median <= params.scene_depth))
    warn(frame, "the median depth is " + number_text(looked.median) +
                    " m, and most of it is not remembered: that takes " +
                    number_text(Volume::Params{}.min_depth) + " m to scene::max-depth, " +
                    number_text(params.scene_depth) + " m; is the unit of depth (depth-unit), " +
                    number_text(depth.unit) + " m a step, right?");
  else if (!(looked.far >= kNearScene && looked.far <= kFarScene))
    warn(frame, "the 90th percentile of depth is " + number_text(looked.far) +
                    " m, which is unusual for a depth camera; is the unit of depth (depth-unit), " +
                    number_text(depth.unit) + " m a step, right?");
  try {
    memory_.emplace(device_, depth.extent, memory_params(params));
  } catch (const Error& error) {
    warn(frame, std::string("the scene is not remembered: ") + error.what() +
                    "; lower scene::memory-limit");
    return false;
  }
  made_with_ = params;
  began_ = has_scene_ = true;
  if (!params.scene_load.empty()) load(frame, params.scene_load);
  try {
    if (!params.scene_location.empty()) check_scene_target(params.scene_location);
  } catch (const Error& error) {
    warn(frame, std::string("scene::location: ") + error.what());
  }
  return true;
}

void RememberedScene::load(FrameContext& frame, const std::string& path) {
  try {
    // A file has 9 bytes at most for each that the limit counts: blocks move to the host, too.
    constexpr uint64_t kFileBytes = 9;
    const uint64_t max = kFileBytes * (uint64_t(made_with_.scene_memory_limit) << 20);
    const SceneData scene = load_scene(path, max);
    try {
      memory_->restore(scene);
      loaded_ = read_strokes(scene.strokes).strokes;
    } catch (const Error& error) {
      throw Error(error.kind(), "scene " + path + ": " + error.what());
    }
  } catch (const Error& error) {
    warn(frame, std::string("scene::load: ") + error.what() + "; the scene begins empty");
  } catch (const std::bad_alloc&) {
    warn(frame, "scene::load: there is no memory for scene " + path + "; the scene begins empty");
  }
}

SceneData RememberedScene::data() {
  SceneData scene = memory_->data();
  StrokeList placed;
  if (strokes_)
    std::ranges::copy_if(strokes_->strokes, std::back_inserter(placed.strokes), &Stroke::in_scene);
  scene.strokes = text_of(placed);
  return scene;
}

void RememberedScene::write_wanted(FrameContext& frame) {
  std::vector<std::string> files;
  {
    const std::lock_guard lock(mutex_);
    files.swap(wanted_);
  }
  for (const std::string& file : files) {
    try {
      save_scene(data(), file);
      frame.messages.emplace_back(
          gst_structure_new("scene-saved", "location", G_TYPE_STRING, file.c_str(), nullptr));
    } catch (const Error& error) {
      frame.warnings.emplace_back(error.what());
    }
  }
}

void RememberedScene::save(const std::string& path) {
  check_scene_target(path);
  if (!has_scene_)
    throw Error(ErrorKind::output,
                "no scene is remembered yet; save it once frames with depth came");
  const std::lock_guard lock(mutex_);
  wanted_.push_back(path);
}

bool RememberedScene::requested() const {
  const std::lock_guard lock(mutex_);
  return forgets_ || !wanted_.empty();
}

void RememberedScene::ended(const std::string& location) {
  if (!memory_) return;
  std::vector<std::string> files;
  {
    const std::lock_guard lock(mutex_);
    files.swap(wanted_);
  }
  const bool writes_location = !location.empty() && !written_;
  if (writes_location) files.push_back(location);
  if (files.empty()) return;
  const SceneData scene = data();
  std::string faults;
  for (const std::string& file : files) {
    try {
      save_scene(scene, file);
      written_ |= writes_location && &file == &files.back();
    } catch (const Error& error) {
      faults += (faults.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  if (!faults.empty()) throw Error(ErrorKind::output, faults);
}

void RememberedScene::warn_of(FrameContext& frame, const SceneMemory::Findings& found) {
  if (found.found) told_.erase(kLost);
  if (found.frames_lost >= kLongLost && found.blocks > 0) warn(frame, kLost);
  if (found.blocks_refused > 0)
    warn(frame, "the scene has reached scene::memory-limit, " +
                    std::to_string(made_with_.scene_memory_limit) +
                    " MiB: new surfaces are not remembered; raise that limit, or "
                    "scene::voxel-size, which is " +
                    number_text(made_with_.voxel_size) + " m");
}

const KnownReflectance* RememberedScene::recall(FrameContext& frame, uint64_t number,
                                                const SceneParams& params, const Wanted& wanted) {
  remembers_ = began_ = false;
  seen_.reset();
  if (frame.fresh) told_.clear();
  const bool forgets = forgets_.exchange(false) || frame.new_stream || !params.scene_memory;
  if (memory_ && (forgets || (frame.fresh && !memory_->look_for_camera()))) reset();
  const GstInverseDepthMeta* meta =
      frame.in && params.scene_memory ? gst_buffer_get_inverse_depth_meta(frame.in) : nullptr;
  if (!meta) {
    if (wanted.touch)
      warn(frame,
           "strokes::touch needs the remembered scene, but frames come without depth or "
           "scene::remember "
           "is false: touches have no effect");
    if (!params.scene_load.empty() || !params.scene_location.empty())
      warn(frame,
           "scene::load and scene::location need the remembered scene, but frames come without "
           "depth "
           "or scene::remember is false: they have no effect");
    if (wanted.strokes && std::ranges::any_of(wanted.strokes->strokes, &Stroke::in_scene))
      warn(frame,
           "strokes with balls lie in a remembered scene, but frames come without "
           "depth or scene::remember is false: these strokes have no effect");
    return nullptr;
  }
  if (const std::string wrong = wrong_depth(*meta); !wrong.empty()) {
    warn(frame, wrong);
    return nullptr;
  }
  const Image image(meta->depth);
  if (!image.rows()) {
    warn(frame, "the depth image of a frame cannot be read; it is left out");
    return nullptr;
  }
  const auto number_of = [](double v) { return static_cast<float>(v); };
  SceneMemory::Depth depth{
      .rows = image.rows(),
      .stride = meta->stride,
      .extent = {meta->width, meta->height},
      .unit = number_of(meta->unit),
      .lens = {number_of(meta->fx), number_of(meta->fy), number_of(meta->cx), number_of(meta->cy)},
      .pose = {}};
  if (meta->posed) depth.pose = pose_of_rows(std::span<const double, 12>(meta->pose));
  if (memory_ && (memory_->depth_extent() != depth.extent || !alike(params, made_with_))) reset();
  if (!memory_ && !begin(frame, depth, params)) return nullptr;
  if (number >= gpu::kFramesInFlight)
    if (const auto found = memory_->findings(number - gpu::kFramesInFlight)) warn_of(frame, *found);
  memory_->set_weight(params.scene_weight);
  written_ = false;
  write_wanted(frame);
  strokes_ = wanted.strokes;
  memory_->set_strokes(strokes_);
  memory_->keep_views(wanted.keep_view);
  memory_->set_update(params.scene_update);
  memory_->set_touch(wanted.touch);
  known_ = memory_->record_recall(frame.commands, number, depth, *frame.layers[Role::input]);
  seen_ = memory_->seen_strokes();
  if (!params.scene_update && !memory_->known())
    warn(frame,
         "scene::update is false and no scene is known yet; set it to true until the camera has "
         "seen "
         "the scene, or set scene::load");
  remembers_ = true;
  return known_ && params.scene_weight > 0 ? &*known_ : nullptr;
}

void RememberedScene::remember(FrameContext& frame) {
  if (!remembers_) return;
  memory_->record_remember(frame.commands, *frame.layers[Role::intrinsic]);
  if (!frame.draw) frame.layers.scene = memory_->record_seen(frame.commands);
}

void RememberedScene::describe(GstStructure* stats, uint64_t number) const {
  const auto of_frame = memory_ ? memory_->findings(number) : std::nullopt;
  if (!of_frame) return;
  const SceneMemory::Findings& found = *of_frame;
  gst_structure_set(stats, "scene-camera-found", G_TYPE_BOOLEAN, found.found, "scene-frames-lost",
                    G_TYPE_UINT, found.frames_lost, "scene-match-rms", G_TYPE_DOUBLE,
                    static_cast<double>(found.rms), "scene-matched", G_TYPE_DOUBLE,
                    static_cast<double>(found.matched), "scene-blocks", G_TYPE_UINT, found.blocks,
                    "scene-blocks-visible", G_TYPE_UINT, found.blocks_visible, "scene-blocks-host",
                    G_TYPE_UINT, found.blocks_host, "scene-blocks-refused", G_TYPE_UINT,
                    found.blocks_refused, "scene-memory-mib", G_TYPE_DOUBLE,
                    found.blocks * double{Volume::kBlockBytes} / kMiB, "scene-keyframes",
                    G_TYPE_UINT, found.keyframes, "scene-added", G_TYPE_BOOLEAN, found.added,
                    "scene-view-kept", G_TYPE_BOOLEAN, found.view_kept, nullptr);
  if (!found.front) return;
  const bool touches = memory_->touch(number).has_value();
  gst_structure_set(stats, "scene-front", G_TYPE_DOUBLE, static_cast<double>(*found.front),
                    "scene-touched", G_TYPE_BOOLEAN, touches, nullptr);
}

}  // namespace

const bool kHasScene = true;

std::unique_ptr<SceneWork> make_scene_work() { return std::make_unique<RememberedScene>(); }

}  // namespace inverse
