#include "tests/bench/methods.hpp"

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "kernels/intrinsic_thesis/thesis_decomposition.hpp"
#include "tests/reference/intrinsic_thesis.hpp"

namespace inverse::bench {
namespace {

Named still(const std::string& name, std::function<Decomposition(const Image&)> run) {
  return {name, [run = std::move(run)](const Image& frame, bool) { return run(frame); }};
}

double processor_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto milliseconds = [](const timeval& t) {
    return double(t.tv_sec) * 1e3 + double(t.tv_usec) * 1e-3;
  };
  return milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime);
}

}  // namespace

std::vector<Named> baselines() {
  const auto land = [](const RetinexParams& params) {
    return [params](const Image& frame) { return retinex(frame, params); };
  };
  return {still("constant shading", constant_shading),
          still("constant reflectance", constant_reflectance),
          still("R = I / max_c I", max_channel),
          still("gray Retinex .1", land({false, 0.1, 0})),
          still("color Retinex .5 .1", land({true, 0.5, 0.1})),
          still("color Retinex, chroma", land({true, 1e9, 0.1}))};
}

Named reference_intrinsic(const std::string& name, const reference::IntrinsicParams& params,
                          bool memory) {
  const auto state = std::make_shared<reference::IntrinsicState>();
  const auto run = [=](const Image& frame, bool continues) {
    const std::vector<double> rgb(frame.data.begin(), frame.data.end());
    if (memory && !continues) *state = {};
    const reference::IntrinsicResult result = reference::decompose(
        rgb.data(), frame.width, frame.height, params, memory ? state.get() : nullptr);
    Decomposition d{Image(frame.width, frame.height, 3), Image(frame.width, frame.height, 1)};
    for (std::size_t i = 0; i < d.shading.data.size(); ++i)
      d.shading.data[i] = float(std::exp(result.log_shading[i]));
    for (std::size_t i = 0; i < d.reflectance.data.size(); ++i)
      d.reflectance.data[i] = float(result.reflectance[i]);
    return d;
  };
  return {name, run, !memory};
}

Named reference_thesis() {
  return still("thesis", [](const Image& frame) {
    reference::Plane linear(frame.width, frame.height);
    for (std::size_t i = 0; i < linear.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) linear.data[i][c] = frame.data[3 * i + c];
    const reference::Plane rs = reference::IntrinsicThesis({}).decompose(linear);
    Decomposition d{Image(frame.width, frame.height, 3), Image(frame.width, frame.height, 1)};
    for (std::size_t i = 0; i < rs.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c)
        d.reflectance.data[3 * i + c] = float(std::exp(rs.data[i][c]));
      d.shading.data[i] = float(std::exp(rs.data[i][3]));
    }
    return d;
  });
}

/// The device, and the frames' way to it and back.
struct DeviceMethods::Shared {
  std::shared_ptr<gpu::Device> device = gpu::Device::open();
  gpu::Commands commands{device};
  double wall = 0, processor = 0, pixels = 0;

  template <typename Record>
  Decomposition run(const Image& frame, bool timed, Record record) {
    const Extent extent{uint32_t(frame.width), uint32_t(frame.height)};
    const auto create = [&](gpu::Memory memory) {
      return gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), memory);
    };
    const PlanePtr input = std::make_shared<Plane>(Plane{extent, create(gpu::Memory::upload)});
    const gpu::BufferPtr output = create(gpu::Memory::readback);
    float* pixel = input->buffer->map_as<float>();
    for (std::size_t i = 0; i < extent.pixels(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) pixel[4 * i + c] = frame.data[3 * i + c];
      pixel[4 * i + 3] = 1;
    }
    const double before = processor_time();
    const auto start = std::chrono::steady_clock::now();
    commands.begin();
    const PlanePtr layer = record(commands, input);
    commands.copy(layer->buffer, output, output->bytes());
    commands.submit();
    commands.wait();
    if (timed) {
      wall += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                  .count();
      processor += processor_time() - before;
      pixels += double(extent.pixels());
    }
    Decomposition d{Image(frame.width, frame.height, 3), Image(frame.width, frame.height, 1)};
    const float* result = output->map_as<float>();
    for (std::size_t i = 0; i < extent.pixels(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) d.reflectance.data[3 * i + c] = result[4 * i + c];
      d.shading.data[i] = result[4 * i + 3];
    }
    return d;
  }
};

DeviceMethods::DeviceMethods() : shared_(std::make_shared<Shared>()) {}

Named DeviceMethods::intrinsic(const std::string& name,
                               const IntrinsicDecomposition::Params& params) {
  const auto method = std::make_shared<std::optional<IntrinsicDecomposition>>();
  const auto size = std::make_shared<Extent>();
  const auto run = [=, shared = shared_](const Image& frame, bool continues) {
    const Extent extent{uint32_t(frame.width), uint32_t(frame.height)};
    const bool fresh = *size != extent;
    if (fresh) method->emplace(shared->device, extent);
    *size = extent;
    return shared->run(frame, !fresh, [&](gpu::Commands& commands, const PlanePtr& input) {
      return (*method)->record(commands, input, params, {!continues})[Role::intrinsic];
    });
  };
  return {name, run, false};
}

Named DeviceMethods::thesis(const std::string& name, const ThesisParams& params) {
  const auto method = std::make_shared<std::optional<ThesisDecomposition>>();
  const auto size = std::make_shared<Extent>();
  const auto run = [=, shared = shared_](const Image& frame, bool continues) {
    const Extent extent{uint32_t(frame.width), uint32_t(frame.height)};
    const bool fresh = *size != extent;
    if (fresh) {
      method->emplace(shared->device, extent);
      (*method)->set_params(params);
    } else if (!continues) {
      (*method)->reset();
    }
    *size = extent;
    return shared->run(frame, !fresh, [&](gpu::Commands& commands, const PlanePtr& input) {
      Layers layers;
      (*method)->record(commands, *input, layers);
      return layers[Role::intrinsic];
    });
  };
  return {name, run, false};
}

DeviceMethods::Time DeviceMethods::take_time() {
  const double frames = std::exchange(shared_->pixels, 0) / (640.0 * 480.0);
  const Time time{std::exchange(shared_->wall, 0) / std::max(frames, 1e-9),
                  std::exchange(shared_->processor, 0) / std::max(frames, 1e-9)};
  return time;
}

std::string DeviceMethods::device_name() const { return shared_->device->name(); }

}  // namespace inverse::bench
