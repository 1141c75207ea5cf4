// Time of GlobalIntrinsic beside IntrinsicDecomposition, frame by frame in turn, and by stage.
//
//   global-bench [--frames N] [--size WxH]… [--kernels 0|1] [--dump IN]
//
// Without a dump (tests/bench/frames.hpp) the frames are synthetic. Times are medians of wall and
// processor time of frames that continue the one before; with --kernels 1 stages are kernels, and a
// frame as a whole then takes longer.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "frames.hpp"
#include "global/global_intrinsic.hpp"

namespace {

using namespace inverse;
using Clock = std::chrono::steady_clock;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// Processor time of all threads of this process so far, milliseconds.
double processor_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto milliseconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_usec) * 1e-3;
  };
  return milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime);
}

struct Times {
  std::vector<double> wall, processor;
  std::map<std::string, std::vector<double>> stages;
  std::vector<std::string> order;
};

/// One frame, recorded by `record`; counted where `counts`.
template <typename Record>
void frame(gpu::Commands& commands, bool counts, Times& times, Record record) {
  const double processor = processor_time();
  const auto start = Clock::now();
  commands.begin();
  record();
  commands.submit();
  commands.wait();
  if (!counts) return;
  times.wall.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  times.processor.push_back(processor_time() - processor);
  std::map<std::string, double> sums;
  for (const auto& stage : commands.stages()) {
    if (std::find(times.order.begin(), times.order.end(), stage.name) == times.order.end())
      times.order.emplace_back(stage.name);
    sums[stage.name] += stage.milliseconds;
  }
  for (const auto& [name, time] : sums) times.stages[name].push_back(time);
}

void print(const char* name, Extent extent, const Times& times) {
  std::printf("%5ux%-5u %-10s wall %7.2f ms (best %.2f) processor %.2f ms |", extent.width,
              extent.height, name, median(times.wall),
              *std::min_element(times.wall.begin(), times.wall.end()), median(times.processor));
  for (const auto& stage : times.order)
    std::printf(" %s %.2f", stage.c_str(), median(times.stages.at(stage)));
  std::printf("\n");
}

void measure(const std::shared_ptr<gpu::Device>& device, const std::vector<bench::Frame>& frames,
             int count, bool kernels) {
  const Extent extent = frames[0].extent;
  std::vector<PlanePtr> inputs;
  for (const bench::Frame& image : frames) {
    auto buffer =
        gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), gpu::Memory::upload);
    std::memcpy(buffer->map(), image.pixels.data(), image.pixels.size() * sizeof(float));
    inputs.push_back(std::make_shared<Plane>(Plane{extent, buffer}));
  }
  IntrinsicDecomposition two_layers(device, extent);
  const uint64_t before = device->memory_bytes();
  GlobalIntrinsic global(device, extent);
  Times two, all;
  gpu::Commands commands(device);
  commands.stage_every_dispatch(kernels);
  constexpr int kWarmUp = 3;
  for (int i = 0; i < count + kWarmUp; ++i) {
    const PlanePtr& input = inputs[static_cast<size_t>(i) % inputs.size()];
    frame(commands, i >= kWarmUp, two, [&] { two_layers.record(commands, input, {}, {}); });
    frame(commands, i >= kWarmUp, all, [&] { global.record(commands, input, {}, {}); });
  }
  print("intrinsic", extent, two);
  print("global", extent, all);
  std::printf(
      "%5ux%-5u ratio of wall %.2f, of processor %.2f; %.0f bytes/pixel; amount %.2f, "
      "confidence %.2f, %u base colors\n",
      extent.width, extent.height, median(all.wall) / median(two.wall),
      median(all.processor) / median(two.processor),
      static_cast<double>(device->memory_bytes() - before) / static_cast<double>(extent.pixels()),
      global.findings().amount, global.findings().confidence, global.findings().colors);
}

}  // namespace

int main(int argc, char** argv) try {
  int count = 15;
  std::vector<Extent> sizes;
  std::string dump;
  bool kernels = false;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i], value = argv[i + 1];
    if (option == "--frames")
      count = std::max(1, std::atoi(value.c_str()));
    else if (option == "--dump")
      dump = value;
    else if (option == "--kernels")
      kernels = value != "0";
    else if (option == "--size") {
      Extent extent;
      if (std::sscanf(value.c_str(), "%ux%u", &extent.width, &extent.height) != 2)
        throw std::runtime_error("--size WxH");
      sizes.push_back(extent);
    } else {
      throw std::runtime_error("unknown option " + option);
    }
  }
  const auto device = gpu::Device::open();
  std::printf("%s\n", device->name().c_str());
  if (!dump.empty()) {
    measure(device, bench::read_frames(dump), count, kernels);
    return 0;
  }
  if (sizes.empty()) sizes = {{320, 240}, {640, 480}, {1280, 720}, {1920, 1080}};
  for (const Extent extent : sizes) {
    std::vector<bench::Frame> frames;
    for (int i = 0; i < 4; ++i) frames.push_back(bench::synthetic_frame(extent, i));
    measure(device, frames, count, kernels);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "global-bench: %s\n", error.what());
  return 1;
}
