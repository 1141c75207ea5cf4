// SPDX-License-Identifier: LGPL-2.1-or-later
// The stages of intrinsicdecomp one by one, against tests/reference/intrinsic_features.*,
// multigrid.* and the bins of intrinsic_decomposition.*.
#include "intrinsic_fixture.hpp"

namespace inverse::testing {

TEST_F(IntrinsicTest, GuideAndPriorAgreeWithReference) {
  const reference::LightColor lights[] = {{}, {0.8, -0.5}, {-1.3, -1}, {}};
  for (size_t i = 0; const Extent extent : kOddSizes) {
    const reference::LightColor& color = lights[i++ % std::size(lights)];
    const Pixels pixels = scene(extent, 2);
    const auto guide = guide_of(extent, pixels, color);
    const auto expected = reference::edge_prior(guide, {});
    Guide made(device, extent);
    EdgePrior prior(device, extent);
    const EdgePrior::Target target = prior_target(extent);
    const auto frame = plane(extent, pixels);
    const auto light = upload({float(color.slope), float(color.reference), 1, 1});
    run([&](gpu::Commands& commands) {
      commands.fill(target.system);
      made.record(commands, frame.buffer, color.slope != 0 ? light : nullptr);
      prior.record(commands, made, target, {});
    });
    const Pixels level0 = download(made.level0());
    for (size_t i = 0; i < extent.pixels(); ++i) {
      ASSERT_NEAR(level0[4 * i], guide.level[0].m[i], 1e-3) << name_of(extent) << " pixel " << i;
      ASSERT_NEAR(level0[4 * i + 1], guide.level[0].c0[i], 1e-3);
      ASSERT_NEAR(level0[4 * i + 2], guide.level[0].c1[i], 1e-3);
    }
    const Pixels statistics = download(made.statistics());
    EXPECT_NEAR(statistics[0], guide.mean, 1e-4) << name_of(extent);
    for (size_t k = 0; k < guide.statistics.size(); ++k)
      EXPECT_NEAR(statistics[k < 4 ? 4 + k : 1], guide.statistics[k], 1e-3)
          << name_of(extent) << " " << k;
    expect_prior(target, guide, expected, name_of(extent));
  }
}

TEST_F(IntrinsicTest, CycleAgreesWithReference) {
  for (const Extent extent : kOddSizes) {
    std::mt19937 random(extent.width * 31 + extent.height);
    std::uniform_real_distribution<double> unit(0, 1);
    namespace grid = reference::multigrid;
    grid::Level finest(static_cast<int>(extent.width), static_cast<int>(extent.height));
    // Weights over seven orders of e, as the prior gives them, and some edges that are missing
    // altogether.
    for (int y = 0; y < finest.height; ++y)
      for (int x = 0; x < finest.width; ++x) {
        const size_t i = finest.at(x, y);
        finest.mass[i] = 1e-6;
        finest.s[i] = unit(random) - 2;
        finest.f[i] = unit(random) - 0.5;
        if (x + 1 < finest.width)
          finest.right[i] = unit(random) < 0.02 ? 0 : std::exp(7.5 * unit(random) - 4.5);
        if (y + 1 < finest.height)
          finest.down[i] = unit(random) < 0.02 ? 0 : std::exp(7.5 * unit(random) - 4.5);
      }
    const Extent cells = half_of(half_of(extent));
    std::vector<double> screening(cells.pixels()), data(cells.pixels());
    for (double& v : screening) v = 16 * std::exp(7.5 * unit(random) - 4.5);
    for (double& v : data) v = unit(random) - 0.5;

    Multigrid multigrid(device, extent);
    Guide guide(device, extent);
    ChromaBins bins(device, cells);
    Pixels system(pack4_count(extent) * 12), field(pack4_count(extent) * 4),
        terms(pack4_count(cells) * 16), source(pack4_count(cells) * 12);
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        const size_t i = finest.at(static_cast<int>(x), static_cast<int>(y));
        system[packed(extent, x, y, 3, 0)] = static_cast<float>(finest.right[i]);
        system[packed(extent, x, y, 3, 1)] = static_cast<float>(finest.down[i]);
        system[packed(extent, x, y, 3, 2)] = static_cast<float>(finest.f[i]);
        field[packed(extent, x, y)] = static_cast<float>(finest.s[i]);
      }
    for (uint32_t y = 0; y < cells.height; ++y)
      for (uint32_t x = 0; x < cells.width; ++x) {
        const size_t i = size_t{y} * cells.width + x;
        const float mass = unit(random) < 0.3 ? 0.0F : static_cast<float>(unit(random));
        // No source term yet; g = 0: the bins have no say.
        terms[packed(cells, x, y, 4, 0)] = source[packed(cells, x, y, 3, 1)] =
            static_cast<float>(screening[i]);
        terms[packed(cells, x, y, 4, 1)] = static_cast<float>(data[i]);
        source[packed(cells, x, y, 3, 2)] = mass;
        for (uint32_t v = 4 * y; v < std::min(extent.height, 4 * y + 4); ++v)
          for (uint32_t u = 4 * x; u < std::min(extent.width, 4 * x + 4); ++u)
            finest.mass[finest.at(static_cast<int>(u), static_cast<int>(v))] +=
                static_cast<double>(mass);
      }
    const auto frame = plane(extent, scene(extent, 3));
    const auto system_buffer = upload(system), field_buffer = upload(field),
               terms_buffer = upload(terms), source_buffer = upload(source);
    Multigrid::Params params;
    run([&](gpu::Commands& commands) {
      guide.record(commands, frame.buffer, nullptr);
      commands.copy(system_buffer, multigrid.system(), system_buffer->bytes());
      commands.copy(field_buffer, multigrid.field(), field_buffer->bytes());
      commands.copy(source_buffer, multigrid.cell_source_term(), source_buffer->bytes());
      multigrid.record_operators(commands, params);
      bins.record_weights(commands, guide, terms_buffer, 1);
      const ChromaBins::State state{terms_buffer,
                                    multigrid.cell_means(),
                                    multigrid.cell_correction(),
                                    multigrid.cell_residual(),
                                    multigrid.cell_system(),
                                    multigrid.cell_source_term()};
      for (int k = 0; k < 3; ++k)
        multigrid.record_cycle(
            commands, params, static_cast<uint32_t>(k), {},
            [&] { bins.record(commands, guide, state); },
            [&] { bins.record_source_term(commands, state, false); });
    });
    auto levels = grid::hierarchy(finest, screening, static_cast<double>(params.scale));
    std::vector<double> source_term(cells.pixels());
    const grid::CellTerms cell_terms{
        [&](const std::vector<double>& far, const std::vector<double>& means, grid::Level& level) {
          for (size_t i = 0; i < far.size(); ++i)
            level.f[i] = far[i] + data[i] - screening[i] * means[i];
        },
        [&](const std::vector<double>& means, const grid::Level& level) {
          std::vector<double> left(means.size());
          for (size_t i = 0; i < left.size(); ++i)
            left[i] = data[i] - screening[i] * (means[i] + level.s[i]);
          return left;
        }};
    grid::Extrapolation extrapolation(static_cast<double>(params.slowest));
    for (int k = 0; k < 3; ++k) {
      const std::vector<double> before = levels[0].s;
      grid::cycle(levels, static_cast<int>(params.cell_cycles), cell_terms, screening, source_term);
      extrapolation.apply(k, before, levels[0].s);
    }
    const Pixels got = download(multigrid.field());
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < 4 * pack4_count(extent.width); ++x) {
        const double want =
            x < extent.width ? levels[0].s[finest.at(static_cast<int>(x), static_cast<int>(y))] : 0;
        ASSERT_NEAR(got[packed(extent, x, y)], want, 1e-3 * (1 + std::abs(want)))
            << name_of(extent) << " at " << x << "," << y;
      }
  }
}

class BinsTest : public IntrinsicTest,
                 public ::testing::WithParamInterface<std::tuple<Extent, double>> {};
// The larger a frame, the smaller a cell's share in a sum; the smaller, too, the farther weights
// are below their bound, as in real frames.
INSTANTIATE_TEST_SUITE_P(Sizes, BinsTest,
                         ::testing::Combine(::testing::Values(Extent{349, 287}, Extent{1920, 1080}),
                                            ::testing::Values(3.0, 7.5)),
                         [](const auto& info) {
                           return "Of" + name_of(std::get<0>(info.param)) + "Weights" +
                                  std::to_string(int(std::get<1>(info.param)));
                         });

TEST_P(BinsTest, AgreeWithReference) {
  const auto [extent, range] = GetParam();  // of ln g
  const Pixels pixels = scene(extent, 4);
  const auto reference_guide = guide_of(extent, pixels);
  const auto& level = reference_guide.level[reference::kCellLevel];
  Guide guide(device, extent);
  const Extent cells = guide.cell_extent();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  const uint64_t packs = pack4_count(cells);
  Pixels terms(packs * 16), means(packs * 4), correction(packs * 4), far(packs * 4);
  std::vector<double> g(cells.pixels()), rho(cells.pixels());
  const float largest = EdgePrior::max_chroma();
  for (uint32_t y = 0; y < cells.height; ++y)
    for (uint32_t x = 0; x < cells.width; ++x) {
      const size_t i = static_cast<size_t>(y) * cells.width + x, at = packed(cells, x, y);
      g[i] = 16 * std::exp(range * unit(random) - 4.5);
      terms[packed(cells, x, y, 4, 2)] = static_cast<float>(g[i]);
      terms[packed(cells, x, y, 4, 3)] = static_cast<float>(level.m[i]);
      means[at] = static_cast<float>(-3 * unit(random));
      correction[at] = static_cast<float>(0.1 * unit(random));
      rho[i] = level.m[i] - means[at] - correction[at];
    }
  const auto system = buffer(packs * 4);
  const ChromaBins::State state{upload(terms), upload(means), upload(correction), upload(far),
                                system};
  ChromaBins bins(device, cells);
  const auto frame = plane(extent, pixels);
  const auto once = [&] {
    run([&](gpu::Commands& commands) {
      commands.fill(system);
      guide.record(commands, frame.buffer, nullptr);
      bins.record_weights(commands, guide, state.terms, largest);
      bins.record(commands, guide, state);
    });
    return download(system);
  };
  const Pixels got = once();
  const auto expected = reference::splat_bins(level, g, rho);
  for (uint32_t y = 0; y < cells.height; ++y)
    for (uint32_t x = 0; x < cells.width; ++x) {
      const size_t i = static_cast<size_t>(y) * cells.width + x;
      const double want =
          g[i] * (level.m[i] - reference::slice_bins(expected, level.c0[i], level.c1[i]));
      ASSERT_NEAR(got[packed(cells, x, y, 4, 2)], want, 1e-4 * g[i]) << x << "," << y;
    }
  EXPECT_EQ(got, once()) << "the sums' order must not matter";
}

TEST_F(IntrinsicTest, OutputScaleAgreesWithReference) {
  for (const Extent extent : kOddSizes) {
    Guide guide(device, extent);
    OutputScale scale(device, guide.cell_extent());
    OutputScale::Params params;
    reference::ScaleParams wanted;
    wanted.quantile = params.white_quantile = 0.83F;  // of no count of cells a whole number
    reference::OutputScale expected(wanted);
    using History = OutputScale::History;
    using State = shaders::solve_scale_update;
    const reference::LightColor light{0.4, -0.8};
    const auto lit = upload({0.4F, -0.8F, 1, 1});
    const struct {
      History history;
      float same;  // the decision: 1 if the frame continues the one before
      bool dark;
    } frames[] = {{History::none, 0, false},    {History::decided, 1, false},
                  {History::decided, 1, true},  {History::decided, 1, false},
                  {History::decided, 0, false}, {History::taken, 0, false},
                  {History::none, 0, true},     {History::decided, 1, false}};
    unsigned seed = 20;
    for (const auto& frame : frames) {
      std::mt19937 random(++seed);
      std::uniform_real_distribution<float> value(-3, 0.5F);
      const Pixels pixels = frame.dark ? Pixels(extent.pixels() * 4, 0.001F) : scene(extent, seed);
      std::vector<double> shading(extent.pixels());
      Pixels packs(pack4_count(extent) * 4);
      for (uint32_t y = 0; y < extent.height; ++y)
        for (uint32_t x = 0; x < extent.width; ++x) {
          const float s = value(random);
          shading[static_cast<size_t>(y) * extent.width + x] = static_cast<double>(s);
          packs[packed(extent, x, y)] = s;
        }
      const auto input = plane(extent, pixels);
      const auto field = upload(packs), judged = upload({0, frame.same, 0, 0});
      run([&](gpu::Commands& commands) {
        guide.record(commands, input.buffer, lit);
        scale.record(commands, guide, field, judged, frame.history, params, lit);
      });
      const bool carries =
          frame.history == History::taken || (frame.history == History::decided && frame.same > 0);
      const double want =
          expected.update(reference::make_guide(rgb_of(pixels).data(), int(extent.width),
                                                int(extent.height), light),
                          shading, carries, light);
      const Pixels got = download(scale.value());
      EXPECT_NEAR(got[0], want, 0.5 / 32 + 1e-3)  // half a bin
          << name_of(extent) << ", frame " << seed - 21;
      EXPECT_NEAR(got[4 * State::SCALE_STATE + 3] - (got[0] - got[2]), expected.white(),
                  1.0 / 32 + 2e-3)
          << name_of(extent) << ", frame " << seed - 21;
    }
  }
}

}  // namespace inverse::testing
