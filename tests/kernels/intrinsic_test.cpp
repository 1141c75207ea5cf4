// intrinsicdecomp's kernels against tests/reference/intrinsic_*: stage by stage, then whole.
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "gpu_fixture.hpp"
#include "intrinsic/intrinsic_decomposition.hpp"
#include "tests/reference/intrinsic_decomposition.hpp"

namespace inverse::testing {
namespace {

/// Tiles of colors of few chromas and many values, under a light with a border: has all kinds of edges.
Pixels scene(Extent extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<std::array<float, 3>> paints(24);
  for (auto& paint : paints) {
    const float value = 0.05F + 0.9F * unit(random);
    for (float& c : paint) c = value * (0.3F + 0.7F * unit(random));
  }
  Pixels pixels(extent.pixels() * 4, 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const float light = (x + 2 * y > extent.width ? 0.9F : 0.35F) * (1 - 0.4F * static_cast<float>(y) / static_cast<float>(extent.height));
      const auto& paint = paints[((x / 23) * 7 + (y / 19) * 11) % paints.size()];
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * (static_cast<size_t>(y) * extent.width + x) + c] = light * paint[c] * (0.97F + 0.06F * unit(random));
    }
  return pixels;
}

std::vector<double> rgb_of(const Pixels& pixels) {
  std::vector<double> rgb;
  for (size_t i = 0; i < pixels.size(); i += 4)
    for (size_t c = 0; c < 3; ++c)
      rgb.push_back(std::isinf(pixels[i + c]) && pixels[i + c] > 0 ? 1.0 : static_cast<double>(pixels[i + c]));
  return rgb;
}

std::string name_of(Extent extent) { return std::to_string(extent.width) + "x" + std::to_string(extent.height); }

}  // namespace

class IntrinsicTest : public GpuTest {
 protected:
  PlanePtr input(Extent extent, const Pixels& pixels) { return std::make_shared<Plane>(plane(extent, pixels)); }

  /// One frame through `method`; its intrinsic plane.
  Pixels decompose(IntrinsicDecomposition& method, const PlanePtr& frame,
                   const IntrinsicDecomposition::Params& params = {}, bool reset = true) {
    Layers layers;
    run([&](gpu::Commands& commands) { layers = method.record(commands, frame, params, {reset}); });
    return download(layers[Role::intrinsic]->buffer);
  }
  Pixels decompose(Extent extent, const Pixels& pixels, const IntrinsicDecomposition::Params& params = {}) {
    IntrinsicDecomposition method(device, extent);
    return decompose(method, input(extent, pixels), params);
  }
};

TEST_F(IntrinsicTest, WholeSolveComesNearTheReference) {
  for (const Extent extent : {Extent{160, 120}, Extent{349, 287}}) {
    const Pixels pixels = scene(extent, 1);
    const auto rgb = rgb_of(pixels);
    for (const int cycles : {4, 40}) {
      reference::IntrinsicParams reference_params;
      reference_params.cycles = cycles;
      const auto expected = reference::decompose(rgb.data(), static_cast<int>(extent.width), static_cast<int>(extent.height), reference_params, nullptr);
      IntrinsicDecomposition::Params params;
      params.cycles = static_cast<uint32_t>(cycles);
      const Pixels got = decompose(extent, pixels, params);
      double worst = 0, sum = 0;
      for (size_t i = 0; i < extent.pixels(); ++i) {
        const double d = std::log(static_cast<double>(got[4 * i + 3])) - expected.log_shading[i];
        worst = std::max(worst, std::abs(d));
        sum += d * d;
      }
      printf("%s %d cycles: worst %.4f rms %.4f change %.2g\n", name_of(extent).c_str(), cycles, worst, std::sqrt(sum / double(extent.pixels())), expected.stats.change.back());
    }
  }
}

TEST_F(IntrinsicTest, GuideAndPriorAgreeWithReference) {
  for (const Extent extent : kOddSizes) {
    const Pixels pixels = scene(extent, 2);
    const auto rgb = rgb_of(pixels);
    const auto guide = reference::make_guide(rgb.data(), static_cast<int>(extent.width), static_cast<int>(extent.height));
    const auto expected = reference::edge_prior(guide, {});
    Guide made(device, extent);
    const EdgePrior prior(device);
    const Extent cells = made.cell_extent();
    const auto buffer = [&](uint64_t count) { return gpu::Buffer::create(device, gpu::Element::vec4, count); };
    const EdgePrior::Target target{buffer(quads_of(extent) * 3), buffer(quads_of(extent) * EdgePrior::kFluxStride), buffer(quads_of(cells) * EdgePrior::kValueStride)};
    const auto frame = plane(extent, pixels);
    run([&](gpu::Commands& commands) {
      commands.fill(target.system);
      made.record(commands, frame.buffer);
      prior.record(commands, made, target, {});
    });
    const Pixels level0 = download(made.level0());
    const Pixels statistics = download(made.statistics());
    EXPECT_NEAR(statistics[0], guide.mean, 1e-4) << name_of(extent);
    for (size_t k = 0; k < guide.statistics.size(); ++k) EXPECT_NEAR(statistics[4 + k], guide.statistics[k], 1e-3) << name_of(extent) << " " << k;
    const Pixels system = download(target.system), flux = download(target.flux), value = download(target.value);
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < 4 * quads_of(extent.width); ++x) {
        const size_t quad = static_cast<size_t>(y) * quads_of(extent.width) + x / 4, lane = x % 4;
        const auto at = [&](const Pixels& p, size_t stride, size_t k) { return p[(stride * quad + k) * 4 + lane]; };
        const auto same = [&](double got, double want) { ASSERT_NEAR(got, want, 2e-3 * (std::abs(want) + 0.01)) << name_of(extent) << " at " << x << "," << y; };
        if (x >= extent.width) {
          for (size_t k = 0; k < 2; ++k) ASSERT_EQ(at(system, 3, k), 0) << "padding";
          continue;
        }
        const size_t i = static_cast<size_t>(y) * extent.width + x;
        same(level0[4 * i], guide.level[0].m[i]);
        same(level0[4 * i + 1], guide.level[0].c0[i]);
        same(level0[4 * i + 2], guide.level[0].c1[i]);
        same(at(system, 3, 0), expected.a_right[i] + expected.b_right[i]);
        same(at(system, 3, 1), expected.a_down[i] + expected.b_down[i]);
        const auto step = [&](size_t j) { return guide.level[0].m[i] - guide.level[0].m[j]; };
        if (x + 1 < extent.width) same(at(flux, 2, 0), expected.a_right[i] * step(i + 1));
        if (y + 1 < extent.height) same(at(flux, 2, 1), expected.a_down[i] * step(i + extent.width));
      }
    for (uint32_t y = 0; y < cells.height; ++y)
      for (uint32_t x = 0; x < 4 * quads_of(cells.width); ++x) {
        const size_t i = static_cast<size_t>(y) * cells.width + x;
        const float* got = &value[12 * (static_cast<size_t>(y) * quads_of(cells.width) + x / 4) + x % 4];
        const bool inside = x < cells.width;
        const double want[] = {inside ? expected.v[i] : 0, inside ? expected.V[i] : 0, inside ? expected.g[i] : 0};
        for (size_t k = 0; k < 3; ++k) ASSERT_NEAR(got[4 * k], want[k], 2e-3 * (std::abs(want[k]) + 0.01)) << name_of(extent) << " cell " << x << "," << y;
      }
  }
}

}  // namespace inverse::testing
