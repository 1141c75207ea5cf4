// SPDX-License-Identifier: LGPL-2.1-or-later
#include "room_source.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "gst/base/report.hpp"
#include "gst/depth/meta/depth_meta.hpp"

namespace inverse {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kUnit = 0.001;  // meters of a step of depth

}  // namespace

const PropertyTable<RoomSourceParams>& room_source_properties() {
  using P = RoomSourceParams;
  constexpr Mutable kReady = Mutable::ready;
  static const PropertyTable<P> table{
      text<P>("device", &P::device,
              "Vulkan device: an index or a part of its name; empty = INVERSE_DEVICE, else the "
              "fastest",
              kReady),
      flag<P>("is-live", &P::live,
              "Produce frames in time, as a camera does; false = as fast as possible", kReady),
      choice<P>("path", &P::path, "GstInverseRoomPath",
                {{int(RoomPath::orbit), "orbit", "Around the table and back, in 24 s"},
                 {int(RoomPath::wall), "wall", "Along a flat wall with pictures and back, in 24 s"},
                 {int(RoomPath::still), "still", "The camera stands still"},
                 {int(RoomPath::table), "table",
                  "At the table, in reach of its things; sways by some centimeters"}},
                "How the camera moves"),
      choice<P>("show", &P::show, "GstInverseRoomShow",
                {{int(P::Show::color), "color", "What the camera sees"},
                 {int(P::Show::reflectance), "reflectance", "The true reflectance"},
                 {int(P::Show::shading), "shading", "The true shading, as gray"},
                 {int(P::Show::depth), "depth", "The true depth, white at max-depth"}},
                "Picture to produce; the depth that goes with it stays the same"),
      choice<P>("hand", &P::hand, "GstInverseRoomHand",
                {{int(HandTarget::none), "none", "There is no hand"},
                 {int(HandTarget::ball), "ball", "The red and white ball"},
                 {int(HandTarget::dark_ball), "dark-ball", "The black ball"},
                 {int(HandTarget::box), "box", "The box with print"},
                 {int(HandTarget::book), "book", "The book"},
                 {int(HandTarget::table), "table", "The table"},
                 {int(HandTarget::print), "print", "The print on the wall; path=wall"}},
                "What a hand touches that comes into the picture every 6 s"),
      number<P>("speed", &P::speed, 0, 100, "Factor on the speed of the camera"),
      number<P>("depth-noise", &P::depth_noise, 0, 100,
                "Errors of depth, relative to those of a structured-light sensor; 0 = exact"),
      number<P>("max-depth", &P::max_depth, 0.1F, 60,
                "Depth in meters beyond which the sensor sees nothing"),
      number<P>("samples", &P::samples, 1, 8,
                "Rays along each side of a pixel; fewer are faster, more give smoother edges"),
      number<P>("seed", &P::seed, 0, 0xffffffffU, "Seed of the noise"),
  };
  return table;
}

RoomSource::~RoomSource() {
  if (stats_) gst_structure_free(stats_);
}

void RoomSource::set_caps(const GstVideoInfo& info) {
  const auto device = context_.current();
  if (!device) throw Error(ErrorKind::internal, "caps before a device");
  auto output = std::make_unique<FrameOutput>(info);
  const Extent extent{static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&info)),
                      static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&info))};
  if (!room_ || commands_->device() != device || extent != extent_) {
    extent_ = extent;
    commands_ = std::make_unique<gpu::Commands>(device);
    room_.emplace(device, furnished_room());
    const auto plane = [&] {
      return std::make_shared<Plane>(
          Plane{extent, gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels())});
    };
    layers_ = plane();
    truth_ = plane();
    pose_ = gpu::Buffer::create(device, gpu::Element::vec4, 2, gpu::Memory::upload);
    depth_ = gpu::Buffer::create(device, gpu::Element::scalar, extent.pixels());
    depth_readback_ =
        gpu::Buffer::create(device, gpu::Element::scalar, extent.pixels(), gpu::Memory::readback);
  }
  output->configure(device);
  readback_ = output->make_buffer(device);
  output_ = std::move(output);
  gpu::build_kernels(device);
}

void RoomSource::stop() {
  output_.reset();
  readback_.reset();
  depth_.reset();
  depth_readback_.reset();
  pose_.reset();
  layers_.reset();
  truth_.reset();
  room_.reset();
  commands_.reset();
  frames_ = 0;
}

void RoomSource::draw(double seconds, uint64_t frame, GstBuffer* buffer) {
  const auto start = Clock::now();
  const RoomSourceParams params = parameters_.snapshot();
  const Pose pose = room_pose(params.path, std::fmod(seconds * double{params.speed}, kPathPeriod));
  auto* to = pose_->map_as<float>();
  std::copy(pose.rotation.begin(), pose.rotation.end(), to);
  std::copy(pose.place.begin(), pose.place.end(), to + 4);
  commands_->begin();
  const Hand hand = room_hand(params.hand, pose, seconds);
  room_->record(*commands_, room_lens(extent_), extent_, pose_, params.samples, layers_->buffer,
                truth_->buffer, hand.parts);
  room_->record_sensor(
      *commands_, extent_, layers_->buffer, truth_->buffer,
      {.noise = params.depth_noise, .max_depth = params.max_depth, .seed = params.seed},
      static_cast<uint32_t>(frame), depth_);
  commands_->copy(depth_, depth_readback_, depth_->bytes());
  commands_->stage("room");
  using Show = RoomSourceParams::Show;
  Picture picture{params.show == Show::reflectance || params.show == Show::shading ? truth_
                                                                                   : layers_};
  picture.scalar = params.show == Show::shading || params.show == Show::depth;
  if (params.show == Show::depth) picture.gain = 1 / params.max_depth;
  output_->record(*commands_, picture, Layers{extent_, {}}, readback_, buffer);
  commands_->stage("output");
  commands_->submit();
  commands_->wait();
  output_->write(readback_, buffer);
  commands_->count_download(readback_->bytes() + depth_readback_->bytes());
  attach_depth(pose, buffer);
  ++frames_;
  GstStructure* stats = frame_stats(
      *commands_, frames_, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  if (!hand.parts.empty())
    gst_structure_set(stats, "hand-touches", G_TYPE_BOOLEAN, hand.touches, "hand-clearance",
                      G_TYPE_DOUBLE, double{clearance(furnished_room(), hand.parts)},
                      "hand-contact-x", G_TYPE_DOUBLE, double{hand.contact[0]}, "hand-contact-y",
                      G_TYPE_DOUBLE, double{hand.contact[1]}, "hand-contact-z", G_TYPE_DOUBLE,
                      double{hand.contact[2]}, nullptr);
  std::lock_guard lock(mutex_);
  std::swap(stats, stats_);
  if (stats) gst_structure_free(stats);
}

void RoomSource::attach_depth(const Pose& pose, GstBuffer* buffer) const {
  const uint64_t pixels = extent_.pixels();
  GstBuffer* image = gst_buffer_new_allocate(nullptr, pixels * sizeof(guint16), nullptr);
  GstMapInfo map;
  if (!image || !gst_buffer_map(image, &map, GST_MAP_WRITE))
    throw Error(ErrorKind::out_of_memory, "no memory for a depth image; use a smaller frame");
  const auto* meters = depth_readback_->map_as<float>();
  for (uint64_t n = 0; n < pixels; ++n) {
    const double steps = double{meters[n]} / kUnit;
    GST_WRITE_UINT16_LE(map.data + 2 * n, steps < 65535.5 ? guint16(std::lround(steps)) : 0);
  }
  gst_buffer_unmap(image, &map);
  const Lens lens = room_lens(extent_);
  GstInverseDepthMeta* meta = add_depth_meta(buffer);
  meta->depth = image;
  meta->width = extent_.width;
  meta->height = extent_.height;
  meta->stride = 2 * extent_.width;
  meta->unit = kUnit;
  meta->fx = double{lens.fx};
  meta->fy = double{lens.fy};
  meta->cx = double{lens.cx};
  meta->cy = double{lens.cy};
  meta->posed = TRUE;
  std::ranges::copy(rows_of(pose), meta->pose);
}

GstStructure* RoomSource::stats() const {
  std::lock_guard lock(mutex_);
  return stats_ ? gst_structure_copy(stats_) : gst_structure_new_empty("inverse-stats");
}

}  // namespace inverse
