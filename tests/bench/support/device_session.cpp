// SPDX-License-Identifier: LGPL-2.1-or-later
#include "device_session.hpp"

#include <algorithm>
#include <cmath>

#include "scene.hpp"

namespace inverse::bench {

namespace {

/// Direct light is the white share of S; indirect light is the remainder of the light's color.
void split_light(const float* intrinsic, const float* light, Decomposition& d) {
  d.direct = d.indirect = Image(d.shading.width, d.shading.height, 3);
  for (std::size_t i = 0; i < d.shading.data.size(); ++i) {
    const float shading = intrinsic[4 * i + 3], share = light[4 * i + 3];
    for (std::size_t c = 0; c < 3; ++c) {
      d.direct.data[3 * i + c] = shading * share;
      d.indirect.data[3 * i + c] = shading * (light[4 * i + c] - share);
    }
  }
  d.shading = luminance_of_sum(d.direct, d.indirect);
}

}  // namespace

DeviceSession::DeviceSession(const std::string& select)
    : device_(gpu::Device::open(select)), commands_(device_) {}

void DeviceSession::fill(const Image& frame, const Plane& plane) {
  float* pixel = plane.buffer->map_as<float>();
  for (std::size_t i = 0; i < plane.extent.pixels(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) pixel[4 * i + c] = frame.data[3 * i + c];
    pixel[4 * i + 3] = 1;
  }
}

PlanePtr DeviceSession::upload(const Image& frame) const {
  const Extent extent{uint32_t(frame.width), uint32_t(frame.height)};
  auto plane = std::make_shared<Plane>(Plane{
      extent,
      gpu::Buffer::create(device_, gpu::Element::vec4, extent.pixels(), gpu::Memory::upload)});
  fill(frame, *plane);
  return plane;
}

Decomposition DeviceSession::run(const Image& frame, const Record& record, Cost& cost) {
  const Extent extent{uint32_t(frame.width), uint32_t(frame.height)};
  if (!input_ || input_->extent != extent) {
    const auto create = [&](gpu::Memory memory) {
      return gpu::Buffer::create(device_, gpu::Element::vec4, extent.pixels(), memory);
    };
    input_ = std::make_shared<Plane>(Plane{extent, create(gpu::Memory::upload)});
    output_ = create(gpu::Memory::readback);
    light_ = nullptr;
  }
  fill(frame, *input_);
  bool global = false;
  cost = measure([&] {
    commands_.begin();
    const Layers layers = record(commands_, input_);
    commands_.copy(layers[Role::intrinsic]->buffer, output_, output_->bytes());
    global = layers.global();
    if (global) {
      if (!light_)
        light_ = gpu::Buffer::create(device_, gpu::Element::vec4, extent.pixels(),
                                     gpu::Memory::readback);
      commands_.copy(layers[Role::light]->buffer, light_, light_->bytes());
    }
    commands_.stage("download");
    commands_.submit();
    commands_.wait();
  });
  // With more stages than timestamps the device time is unknown.
  if (!commands_.stages().empty() && commands_.stages().size() < gpu::Commands::kMaxStages) {
    cost.device = 0;
    for (const gpu::StageTime& stage : commands_.stages()) {
      cost.device += stage.milliseconds;
      cost.stages[stage.name] += stage.milliseconds;
    }
  }
  Decomposition d{Image(frame.width, frame.height, 3), Image(frame.width, frame.height, 1)};
  const float* result = output_->map_as<float>();
  for (std::size_t i = 0; i < extent.pixels(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) d.reflectance.data[3 * i + c] = result[4 * i + c];
    d.shading.data[i] = result[4 * i + 3];
  }
  if (global) split_light(result, light_->map_as<float>(), d);
  return d;
}

namespace {

class LowerResolution final : public Solver {
 public:
  LowerResolution(int times, std::unique_ptr<Solver> inner)
      : times_(times), inner_(std::move(inner)) {}

  Decomposition run(const Image& frame, bool continues, Cost& cost) override {
    Image small = frame;
    Decomposition d;
    Cost inner;
    const Cost down = measure([&] {
      for (int k = 0; k < times_; ++k) small = halve(small);
    });
    const Decomposition low = inner_->run(small, continues, inner);
    const Cost up = measure([&] { d = enlarge(low.shading, frame); });
    cost = inner;
    cost.wall += down.wall + up.wall;
    cost.processor += down.processor + up.processor;
    return d;
  }

 private:
  Decomposition enlarge(const Image& shading, const Image& frame) const {
    constexpr float kMinShading = 1e-6F;
    Image logs = shading;
    for (float& v : logs.data) v = std::log(std::max(v, kMinShading));
    Decomposition d{Image(frame.width, frame.height, 3), Image(frame.width, frame.height, 1)};
    const float scale = 1.0F / float(1 << times_);
    const auto place = [&](int at, int count) {
      return std::clamp((float(at) + 0.5F) * scale - 0.5F, 0.0F, float(count - 1));
    };
    for (int y = 0; y < frame.height; ++y) {
      const float v = place(y, logs.height);
      const int y0 = int(v), y1 = std::min(y0 + 1, logs.height - 1);
      for (int x = 0; x < frame.width; ++x) {
        const float u = place(x, logs.width);
        const int x0 = int(u), x1 = std::min(x0 + 1, logs.width - 1);
        const float fx = u - float(x0), fy = v - float(y0);
        const float s = std::exp((1 - fy) * ((1 - fx) * logs.at(x0, y0) + fx * logs.at(x1, y0)) +
                                 fy * ((1 - fx) * logs.at(x0, y1) + fx * logs.at(x1, y1)));
        d.shading.at(x, y) = s;
        for (int c = 0; c < 3; ++c) d.reflectance.at(x, y, c) = frame.at(x, y, c) / s;
      }
    }
    return d;
  }

  int times_;
  std::unique_ptr<Solver> inner_;
};

}  // namespace

std::unique_ptr<Solver> at_lower_resolution(
    Size size, int times, const std::function<std::unique_ptr<Solver>(Size)>& make) {
  return std::make_unique<LowerResolution>(times,
                                           make({size.width >> times, size.height >> times}));
}

}  // namespace inverse::bench
