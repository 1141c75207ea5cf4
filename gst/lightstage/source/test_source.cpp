// SPDX-License-Identifier: LGPL-2.1-or-later
#include "test_source.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>

#include "gst/base/pads/caps.hpp"
#include "gst/base/report.hpp"
#include "gst/lightstage/meta/light_stage_meta.hpp"
#include "kernels/lightstage/virtual_stage/virtual_head.hpp"

namespace inverse {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// `performance` and `static` without a number get the folder's number of lights.
LightProgram program_for(const TestSourceParams& params, const OlatFolder* folder) {
  if (!folder || (params.program != "performance" && params.program != "static"))
    return light_program(params.program, params.rate);
  auto lights = stage_lights(folder->directions());
  return params.program == "static" ? static_capture(std::move(lights), params.rate)
                                    : performance(std::move(lights), params.rate);
}

void check_agreement(const LightProgram& program, const OlatFolder& folder) {
  const std::string remedy = "; program=performance or program=static take the folder's lights";
  if (program.lights.size() != folder.directions().size())
    throw Error(ErrorKind::file, "the program \"" + program.name + "\" has " +
                                     std::to_string(program.lights.size()) + " lights, " +
                                     folder.path() + " has " +
                                     std::to_string(folder.directions().size()) + remedy);
  for (size_t i = 0; i < program.lights.size(); ++i)
    for (size_t c = 0; c < 3; ++c)
      if (std::abs(program.lights[i].direction[c] - folder.directions()[i][c]) > 2e-3)
        throw Error(ErrorKind::file, "light " + std::to_string(i) + " of the program \"" +
                                         program.name + "\" is elsewhere than in " + folder.path() +
                                         remedy);
}

/// White of a photograph, RGB: the value that a hundredth of the lit pixels exceeds.
float white_of(const std::vector<float>& rgb) {
  std::vector<float> lit;
  for (size_t i = 0; i + 2 < rgb.size(); i += 3) {
    const float brightest = std::max({rgb[i], rgb[i + 1], rgb[i + 2]});
    if (brightest > 0 && std::isfinite(brightest)) lit.push_back(brightest);
  }
  if (lit.empty()) return 1;
  const auto at = lit.begin() + static_cast<ptrdiff_t>(lit.size() * 99 / 100);
  std::ranges::nth_element(lit, at);
  return *at;
}

/// Says which lights have no picture.
std::string lacking(const OlatFolder& folder) {
  const auto missing = folder.missing();
  if (missing.empty()) return "";
  std::string text = folder.path() + " has no picture of light ";
  for (size_t i = 0; i < std::min<size_t>(missing.size(), 8); ++i)
    text += (i ? ", " : "") + std::to_string(missing[i]);
  if (missing.size() > 8) text += " and " + std::to_string(missing.size() - 8) + " more";
  return text + ": dark here; capture the subject again where that matters";
}

}  // namespace

TestSource::~TestSource() {
  if (stats_) gst_structure_free(stats_);
}

std::string TestSource::start() {
  started_ = params();
  context_.renew(started_.device);
  folder_.reset();
  if (!started_.location.empty()) folder_.emplace(started_.location);
  program_ = program_for(started_, folder_ ? &*folder_ : nullptr);
  program_id_ = program_.id();
  if (folder_) check_agreement(program_, *folder_);
  if (!started_.listen.empty()) {
    patch_.emplace(program_, started_.universe);
    std::vector<uint32_t> universes;
    for (const auto& [universe, used] : patch_->universes()) universes.push_back(universe);
    receiver_.emplace(started_.listen, universes, started_.sync_universe,
                      sacn::AllowedSources(started_.listen_source));
  }
  frames_ = dropped_ = duplicated_ = overruns_ = 0;
  return folder_ ? lacking(*folder_) : "";
}

void TestSource::stop() {
  receiver_.reset();
  patch_.reset();
  commands_.reset();
  output_.reset();
  readback_.reset();
  pictures_.reset();
  camera_.reset();
  stack_.reset();
  folder_.reset();
  program_ = {};
}

GstCaps* TestSource::caps() const {
  GstCaps* caps = pixel_caps();
  if (!program_.lights.empty())
    gst_caps_set_simple(caps, "framerate", GST_TYPE_FRACTION,
                        static_cast<gint>(program_.rate_numerator),
                        static_cast<gint>(program_.rate_denominator), nullptr);
  if (folder_)
    gst_caps_set_simple(caps, "width", G_TYPE_INT, static_cast<gint>(folder_->extent().width),
                        "height", G_TYPE_INT, static_cast<gint>(folder_->extent().height), nullptr);
  return caps;
}

std::unique_ptr<OlatStack> TestSource::make_stack(const std::shared_ptr<gpu::Device>& device,
                                                  Extent extent,
                                                  const std::function<bool()>& go_on) {
  const auto lights = static_cast<uint32_t>(program_.lights.size());
  auto stack =
      std::make_unique<OlatStack>(device, extent, lights, uint64_t{started_.stack_limit} << 20);
  // Lambert's law: under light from all sides, white reflects a quarter of the sum of all lights.
  full_on_ = static_cast<float>(lights) / 4;
  if (folder_) {
    std::vector<float> sum;
    if (folder_->captured()) sum.resize(3 * extent.pixels());
    for (uint32_t i = 0; i < lights; ++i) {
      if (!go_on()) return nullptr;
      const std::vector<float> image = folder_->image(i);
      if (folder_->captured()) std::ranges::transform(sum, image, sum.begin(), std::plus<>());
      stack->load(i, image);
    }
    if (folder_->captured()) full_on_ = white_of(sum);
    return stack;
  }
  std::vector<Direction> directions;
  for (const StageLight& light : program_.lights) directions.push_back(light.direction);
  if (!render_head(*stack, directions, view_of_camera(started_.camera), go_on)) return nullptr;
  return stack;
}

bool TestSource::set_caps(const GstVideoInfo& info, const std::function<bool()>& go_on) {
  const auto start = Clock::now();
  const auto device = context_.current();
  if (!device) throw Error(ErrorKind::internal, "caps before a device");
  auto output = std::make_unique<FrameOutput>(info);
  const Extent extent{static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&info)),
                      static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&info))};
  if (!stack_ || stack_->extent() != extent || !commands_ || commands_->device() != device) {
    stack_.reset();  // frees memory before the next one
    stack_ = make_stack(device, extent, go_on);
    if (!stack_) return false;
    commands_ = std::make_unique<gpu::Commands>(device);
    camera_.emplace(device);
    pictures_.emplace(device, extent);
  }
  output->configure(device);
  readback_ = output->make_buffer(device);
  output_ = std::move(output);
  warm_up();
  render_ms_ = milliseconds_since(start);
  return true;
}

/// Does slow first work before frames are due: builds kernels, and sums many lights in the final
/// buffers.
void TestSource::warm_up() {
  constexpr size_t kSteps = 6;
  commands_->begin();
  PlanePtr light = stack_->record(*commands_, program_.colors(LightStep{StepKind::tracking}));
  const PlanePtr picture = pictures_->acquire();
  camera_->record(*commands_, *light, {}, *picture);
  output_->record(*commands_, Picture{picture}, Layers{picture->extent, {}}, readback_, nullptr);
  commands_->submit();
  commands_->wait();
  for (size_t i = 0; i < std::min(kSteps, program_.steps.size()); ++i) {
    if (program_.steps[i].kind == StepKind::olat) continue;
    commands_->begin();
    light = stack_->record(*commands_, program_.colors(program_.steps[i]));
    commands_->submit();
    commands_->wait();
  }
}

GstClockTime TestSource::time_of(uint64_t steps) const {
  return gst_util_uint64_scale(steps, GST_SECOND * program_.rate_denominator,
                               program_.rate_numerator);
}

std::optional<uint64_t> TestSource::said_start() const {
  if (started_.start <= 0) return std::nullopt;
  return static_cast<uint64_t>(
      std::llround(started_.start * program_.rate_numerator / program_.rate_denominator));
}

GstClockTime TestSource::until_exposure(const Exposure& exposed) const {
  double guard = program_.guard, exposure = program_.exposure;
  if (exposed.trigger) {
    const auto position = program_.at(*exposed.trigger);
    if (position.part == LightProgram::Position::Part::step) {
      guard = program_.steps[position.index].guard.value_or(guard);
      exposure = program_.steps[position.index].exposure.value_or(exposure);
    }
  }
  if (exposure <= 0) return period() / 2;
  return static_cast<GstClockTime>((guard + exposure / 2) * GST_SECOND);
}

bool TestSource::ended(const Exposure& exposure) const {
  return !receiver_ && exposure.trigger &&
         program_.at(*exposure.trigger).part == LightProgram::Position::Part::ended;
}

FrameFate TestSource::fate(const Exposure& exposure) const {
  const TestSourceParams p = parameters_.snapshot();
  return fate_of(exposure.number, {p.drop_rate, p.duplicate_rate, p.late_rate, p.jitter, p.seed});
}

void TestSource::count(bool dropped, bool duplicated) {
  dropped_ += dropped;
  duplicated_ += duplicated;
}

std::vector<LightColor> TestSource::colors(const Exposure& exposure) {
  if (receiver_) {
    receiver_->poll();
    return patch_->colors(receiver_->levels());
  }
  if (exposure.trigger) return program_.colors(program_.at(*exposure.trigger));
  return std::vector<LightColor>(program_.lights.size());
}

void TestSource::draw(const Exposure& exposure, GstBuffer* buffer) {
  const auto start = Clock::now();
  const TestSourceParams params = parameters_.snapshot();
  const auto lit = colors(exposure);
  const double seconds = static_cast<double>(time_of(exposure.trigger.value_or(0))) / GST_SECOND;
  VirtualCamera::Shot shot;
  shot.sway = static_cast<float>(
      params.motion * std::sin(2 * std::numbers::pi * seconds / double{params.motion_period}));
  shot.gain = params.gain / full_on_;
  shot.noise = params.noise;
  shot.seed = params.seed + 1000 * params.camera;
  shot.frame = static_cast<uint32_t>(exposure.number);
  commands_->begin();
  const PlanePtr light = stack_->record(*commands_, lit);
  commands_->stage("weigh");
  const PlanePtr picture = pictures_->acquire();
  camera_->record(*commands_, *light, shot, *picture);
  output_->record(*commands_, Picture{picture}, Layers{picture->extent, {}}, readback_, buffer);
  commands_->stage("camera");
  commands_->submit();
  commands_->wait();
  output_->write(readback_, buffer);
  commands_->count_download(readback_->bytes());
  if (started_.label) label(exposure, lit, buffer);
  if (started_.frame_ids) {
    GST_BUFFER_OFFSET(buffer) = frame_id(exposure.number, started_.first_frame_id,
                                         static_cast<uint32_t>(started_.frame_id_bits));
    GST_BUFFER_OFFSET_END(buffer) = GST_BUFFER_OFFSET_NONE;
  }
  publish(exposure, milliseconds_since(start));
}

void TestSource::label(const Exposure& exposure, const std::vector<LightColor>& colors,
                       GstBuffer* buffer) const {
  GstLightStageMeta* meta = add_light_stage_meta(buffer);
  meta->program = program_id_;
  meta->trigger = exposure.trigger.value_or(0);
  meta->kind = GST_LIGHT_STAGE_BLACK;
  meta->lights = static_cast<guint>(colors.size());
  meta->colors = g_bytes_new(colors.data(), colors.size() * sizeof colors[0]);
  if (receiver_) {  // whatever the packets said
    meta->kind = GST_LIGHT_STAGE_CUSTOM;
    return;
  }
  if (!exposure.trigger) return;
  set_position(meta, program_, program_.at(*exposure.trigger));
}

void TestSource::publish(const Exposure& exposure, double wall_ms) {
  ++frames_;
  GstStructure* stats = frame_stats(*commands_, frames_, wall_ms);
  gst_structure_set(stats, "render-ms", G_TYPE_DOUBLE, render_ms_, "stack-bytes", G_TYPE_UINT64,
                    OlatStack::bytes(stack_->extent(), stack_->lights()), "lights", G_TYPE_UINT,
                    stack_->lights(), "trigger", G_TYPE_UINT64, exposure.trigger.value_or(0),
                    "sums", G_TYPE_UINT64, stack_->made(), "sums-reused", G_TYPE_UINT64,
                    stack_->taken_again(), "dropped", G_TYPE_UINT64, dropped_, "duplicated",
                    G_TYPE_UINT64, duplicated_, "overruns", G_TYPE_UINT64, overruns_, nullptr);
  if (receiver_) {
    const auto& heard = receiver_->stats();
    gst_structure_set(stats, "packets", G_TYPE_UINT64, heard.packets, "packets-malformed",
                      G_TYPE_UINT64, heard.malformed, "packets-late", G_TYPE_UINT64, heard.late,
                      "packets-other", G_TYPE_UINT64, heard.other, nullptr);
  }
  std::lock_guard lock(mutex_);
  std::swap(stats, stats_);
  if (stats) gst_structure_free(stats);
}

GstStructure* TestSource::stats() const {
  std::lock_guard lock(mutex_);
  return stats_ ? gst_structure_copy(stats_) : gst_structure_new_empty("inverse-stats");
}

}  // namespace inverse
