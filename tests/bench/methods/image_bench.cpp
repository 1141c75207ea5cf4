// SPDX-License-Identifier: LGPL-2.1-or-later
// Time of converting frames to planes and back: `image-bench [runs] [filter]`. Needs a Vulkan
// device.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/format/convert.hpp"
#include "kernels/image/view/mosaic.hpp"
#include "tests/bench/support/timing.hpp"

namespace {

using namespace inverse;

using bench::Clock;
using bench::processor_ms;

struct Times {
  double first, median, least, cpu;  ///< first: CPU time, compiling included
};

/// One submit and wait per run; the first one compiles. Median of `runs` after ten warm-up runs;
/// CPU time is the mean over all threads.
Times measure(gpu::Commands& commands, int runs, const std::function<void()>& record) {
  const auto once = [&] {
    const auto start = Clock::now();
    commands.begin();
    record();
    commands.submit();
    commands.wait();
    return bench::milliseconds(Clock::now() - start);
  };
  Times times{};
  const double before = processor_ms();
  once();
  times.first = processor_ms() - before;
  for (int i = 0; i < 10; ++i) once();
  const double cpu = processor_ms();
  std::vector<double> walls;
  for (int i = 0; i < runs; ++i) walls.push_back(once());
  times.cpu = (processor_ms() - cpu) / runs;
  std::sort(walls.begin(), walls.end());
  times.median = walls[walls.size() / 2];
  times.least = walls.front();
  return times;
}

void print(const std::string& what, Extent extent, const Times& t) {
  std::printf("%-16s %5ux%-5u %9.2f %9.3f %9.3f %9.3f %8.2f\n", what.c_str(), extent.width,
              extent.height, t.first, t.median, t.least, t.cpu,
              t.median * 1e6 / static_cast<double>(extent.pixels()));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 50;
  const std::string filter = argc > 2 ? argv[2] : "";
  const auto device = gpu::Device::open();
  std::printf("%s, %d runs%s\n%-16s %11s %9s %9s %9s %9s %8s\n", device->name().c_str(), runs,
              device->variant().portable ? ", portable" : "", "", "", "first CPU", "median ms",
              "least ms", "CPU ms", "ns/pixel");
  gpu::Commands commands(device);
  std::mt19937 random(1);
  for (const Extent extent : {Extent{640, 480}, Extent{1920, 1080}}) {
    PlanePool pool(device, extent);
    const PlanePtr linear = pool.acquire(), mosaic = pool.acquire();
    for (const PixelFormat pixel_format :
         {PixelFormat::rgba, PixelFormat::rgb, PixelFormat::gray8, PixelFormat::rgba64_le,
          PixelFormat::nv12, PixelFormat::i420, PixelFormat::yuy2, PixelFormat::p010_10le}) {
      FrameFormat format{pixel_format, extent};
      format.matrix = Matrix::bt709();
      format.range = is_yuv(pixel_format) ? Range::limited : Range::full;
      format.transfer =
          Transfer::of(is_yuv(pixel_format) ? TransferFunction::bt709 : TransferFunction::srgb);
      format = aligned_layout(format);
      const std::string name = name_of(pixel_format);
      const auto in =
          gpu::Buffer::create(device, gpu::Element::word, raw_words(format), gpu::Memory::upload);
      std::generate_n(in->map_as<uint32_t>(), in->count(), random);
      const auto out =
          gpu::Buffer::create(device, gpu::Element::word, raw_words(format), gpu::Memory::readback);
      const Unpack unpack(device, format);
      const Pack pack(device, format);
      if ((name + " unpack").find(filter) != std::string::npos)
        print(name + " unpack", extent,
              measure(commands, runs, [&] { unpack.record(commands, in, *linear); }));
      if ((name + " pack").find(filter) != std::string::npos)
        print(name + " pack", extent, measure(commands, runs, [&] {
                pack.record(commands, {.picture = *linear, .alpha = linear.get()}, out);
              }));
    }
    const Mosaic draw(device);
    if (std::string("mosaic").find(filter) != std::string::npos)
      print(
          "mosaic", extent, measure(commands, runs, [&] {
            draw.record(commands, {{{linear.get()}, {linear.get()}, {linear.get()}, {}}}, *mosaic);
          }));
  }
}
