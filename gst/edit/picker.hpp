// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "gst/base/color.hpp"
#include "gst/base/filter.hpp"
#include "kernels/edit_pick.spv.hpp"

namespace inverse {

/// Sets a color property of an element to the reflectance that the user clicks on.
class Picker {
 public:
  void configure(const std::shared_ptr<gpu::Device>& device) {
    pick_ = {device};
    for (auto& copy : copies_)
      copy = {gpu::Buffer::create(device, gpu::Element::vec4, 1, gpu::Memory::readback), nullptr};
  }
  void release() { copies_ = {}; }

  /// From any thread.
  void navigate(const MouseEvent& event) {
    if (event.kind != MouseEvent::Kind::press || !std::isfinite(event.x) || !std::isfinite(event.y))
      return;
    const std::lock_guard lock(mutex_);
    clicked_ = {event.x, event.y};
  }
  /// Forgets a click that no frame has answered.
  void forget() { take_click(); }
  /// If there was a click since the last frame, records the copy of the reflectance there, for
  /// `property` (null: none).
  void record(FrameContext& frame, const char* property) {
    Copy& copy = copies_[frame.number];
    copy.property = nullptr;
    const auto click = take_click();
    if (!click || !property) return;
    const auto pixel = [](double at, uint32_t size) {
      return static_cast<int32_t>(std::clamp(at, 0.0, size - 1.0));
    };
    const Extent size = frame.layers.extent;
    frame.commands.dispatch(
        pick_, {.plane = frame.layers[Role::intrinsic]->buffer, .color = copy.color},
        {.size = size, .at = {pixel((*click)[0], size.width), pixel((*click)[1], size.height)}},
        {});
    copy.property = property;
  }
  /// Sets the property once the frame is completed.
  void completed(uint64_t number, GstElement* element) {
    const Copy& copy = copies_[number];
    if (!copy.property) return;
    const float* color = copy.color->map_as<float>();
    g_object_set(element, copy.property, srgb_color({color[0], color[1], color[2]}), nullptr);
  }

 private:
  using Click = std::array<double, 2>;
  std::optional<Click> take_click() {
    const std::lock_guard lock(mutex_);
    return std::exchange(clicked_, std::nullopt);
  }

  struct Copy {
    gpu::BufferPtr color;
    const char* property = nullptr;
  };
  gpu::Program<shaders::edit_pick> pick_;
  gpu::FrameRing<Copy> copies_;
  std::mutex mutex_;
  std::optional<Click> clicked_;  // since the last frame; of any thread
};

}  // namespace inverse
