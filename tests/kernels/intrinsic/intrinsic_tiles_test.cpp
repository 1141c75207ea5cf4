// SPDX-License-Identifier: LGPL-2.1-or-later
// Work by tiles: kernels over a list give what they give over a frame, and a video solved by tiles
// stays near the one solved whole.
#include "intrinsic_fixture.hpp"
#include "kernels/image/format/changed_tiles.hpp"
#include "kernels/image/format/convert.hpp"
#include "tests/changed_tiles.hpp"
#include "tests/expect_error.hpp"
#include "tests/kernels/image/described_formats.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

/// A list of all tiles of a frame.
TileList all_tiles(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  TileList list(device, extent, gpu::Memory::upload);
  list.assign(std::vector<uint8_t>(list.tiles(), 1));
  return list;
}

/// Frames of a video whose input comes as floats, and which of their tiles have changed.
class Video {
 public:
  explicit Video(Extent extent) : extent_(extent) {}
  /// The tiles of `next` that differ from the frame before; none if there is none.
  std::vector<uint8_t> changed(const Pixels& next) {
    const Pixels last = std::exchange(last_, next);
    return last.empty() ? std::vector<uint8_t>() : changed_tiles(extent_.width, 4, last, next);
  }

 private:
  Extent extent_;
  Pixels last_;
};

/// A gray patch, lit from above, over a picture.
Pixels with_patch(Pixels pixels, Extent extent, size_t left, size_t top) {
  for (size_t y = top; y < top + 24; ++y)
    for (size_t x = left; x < left + 24; ++x)
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * (y * extent.width + x) + c] = 0.5F - 0.012F * static_cast<float>(y - top);
  return pixels;
}

/// Distance of log shading without the outputs' scales, whose logarithms these are.
struct Distance {
  double rms = 0;
  double tile = 0;  ///< largest mean of a tile
};
Distance distance(Extent extent, const Pixels& one, double scale, const Pixels& other,
                  double other_scale) {
  Distance distance;
  const uint32_t columns = (extent.width + 15) / 16, rows = (extent.height + 15) / 16;
  std::vector<double> sums(size_t{columns} * rows), counts(sums.size());
  const auto log_one = log_shading_of(one), log_other = log_shading_of(other);
  for (size_t i = 0; i < extent.pixels(); ++i) {
    const double d = log_one[i] + scale - log_other[i] - other_scale;
    const size_t tile = i / extent.width / 16 * columns + i % extent.width / 16;
    distance.rms += d * d;
    sums[tile] += d;
    counts[tile] += 1;
  }
  for (size_t i = 0; i < sums.size(); ++i) update_max(distance.tile, std::abs(sums[i] / counts[i]));
  distance.rms = std::sqrt(distance.rms / static_cast<double>(extent.pixels()));
  return distance;
}

class IntrinsicTilesTest : public IntrinsicTest {
 protected:
  /// One frame of a video; layers in the output's scale.
  Layers next(IntrinsicDecomposition& method, Extent extent, const Pixels& pixels,
              const std::vector<uint8_t>& changed,
              const IntrinsicDecomposition::Params& params = {}) {
    Layers layers;
    run([&](gpu::Commands& commands) {
      layers = method.record(commands, input(extent, pixels), params, {false, changed});
    });
    return layers;
  }
  Pixels pixels_of(const Layers& layers) { return download(layers[Role::intrinsic]); }
  bool listed(const IntrinsicDecomposition& method) { return last_stats(method).plan.tiles(); }
};

}  // namespace

TEST_F(IntrinsicTilesTest, KernelsOverAllTilesDoWhatTheyDoOverTheFrame) {
  for (const Extent extent : kOddSizes) {
    const TileList all = all_tiles(device, extent);
    const auto frame = plane(extent, scene(extent, 3));
    const auto same = [&](const gpu::BufferPtr& one, const gpu::BufferPtr& other,
                          const char* what) {
      const Pixels a = download(one), b = download(other);
      EXPECT_EQ(memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0)
          << what << ", " << name_of(extent);
    };
    Guide whole(device, extent), listed(device, extent);
    run([&](gpu::Commands& commands) {
      whole.record(commands, frame.buffer, nullptr);
      listed.record(commands, frame.buffer, nullptr, &all);
    });
    same(whole.level0(), listed.level0(), "guide, level 0");
    same(whole.level1(), listed.level1(), "guide, level 1");
    same(whole.cells(), listed.cells(), "guide, cells");
    same(whole.guide_coarse(), listed.guide_coarse(), "guide, level 4");
    // Operators, a cycle and its extrapolation, on a system such as the prior makes.
    Multigrid grids[] = {Multigrid(device, extent), Multigrid(device, extent)};
    const Extent cells = whole.cell_extent();
    const auto flux = buffer(pack4_count(extent) * 2), value = buffer(pack4_count(cells) * 3);
    EdgePrior prior(device, extent);
    Pixels start(pack4_count(extent) * 4);
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x)
        start[packed(extent, x, y)] = -1.0F - 0.01F * static_cast<float>((x * 7 + y * 3) % 50);
    const auto field = upload(start);
    for (size_t k = 0; k < 2; ++k)
      run([&](gpu::Commands& commands) {
        Multigrid& grid = grids[k];
        const TileList* list = k == 0 ? nullptr : &all;
        commands.fill(grid.system());
        commands.fill(grid.cell_source_term());
        commands.fill(grid.cell_system());
        prior.record(commands, whole, {grid.system(), flux, value}, {});
        commands.copy(field, grid.field(), field->bytes());
        grid.record_operators(commands, {}, list);
        for (uint32_t cycle = 0; cycle < 2; ++cycle)
          grid.record_cycle(
              commands, {}, cycle, {true, false, 0},
              [&] {
                commands.fill(grid.cell_system());
                grid.record_operators(commands, {}, list);
              },
              [] {}, {list, list});
      });
    same(grids[0].system(), grids[1].system(), "system");
    same(grids[0].cell_residual(), grids[1].cell_residual(), "what is left to the cells");
    same(grids[0].field(), grids[1].field(), "solution");
    EXPECT_NEAR(download(grids[0].progress())[0], download(grids[1].progress())[0],
                1e-4F * download(grids[0].progress())[0]);
  }
}

TEST_F(IntrinsicTilesTest, AStaticBackgroundIsReusedAndStaysNearTheWholeSolve) {
  const Extent extent{349, 287};
  const Pixels background = scene(extent, 21);
  IntrinsicDecomposition some(device, extent), whole(device, extent);
  const IntrinsicDecomposition::Params all{.adaptive = false};
  Video video(extent);
  Pixels before;
  unsigned listed_frames = 0;
  double worst = 0, worst_scale = 0;
  for (size_t k = 0; k < 30; ++k) {
    const size_t left = 40 + 5 * std::min<size_t>(k, 22);  // stops for the last frames
    const Pixels frame = with_patch(background, extent, left, 60);
    const Pixels got = pixels_of(next(some, extent, frame, video.changed(frame)));
    const Pixels want = pixels_of(next(whole, extent, frame, {}, all));
    for (size_t i = 0; i < got.size(); ++i)
      if (i % 4 < 3) {
        ASSERT_NEAR(got[i] * got[i | 3], frame[i], 1e-5) << "R S must be I, frame " << k;
      }
    update_max(worst, shading_distance(got, want));
    worst_scale = std::max(
        worst_scale, static_cast<double>(std::abs(some.findings().scale - whole.findings().scale)));
    if (listed(some)) {
      ++listed_frames;
      const auto found = some.findings();
      EXPECT_LT(found.tiles_active, some.stats(k).tiles / 2);
      EXPECT_EQ(found.tiles_evaluated, found.tiles_active);
      size_t kept = 0;
      for (size_t i = 0; i < got.size(); i += 4) kept += memcmp(&got[i], &before[i], 16) == 0;
      if (some.drawn()) {
        EXPECT_GT(kept, extent.pixels() / 3) << "frame " << k;
      }
    }
    before = got;
  }
  EXPECT_GT(listed_frames, 20U);
  EXPECT_LT(worst, 0.06);
  EXPECT_LT(worst_scale, 0.04);
  std::printf(
      "%u of 30 frames by tiles, log shading at most %.4f rms from the whole solve, its scale "
      "%.4f\n",
      listed_frames, worst, worst_scale);
}

// A listed tile changes the residual of the tiles beside it. If that is stale, the solution
// diverges where edges are strong.
TEST_F(IntrinsicTilesTest, StrongEdgesConverge) {
  const Extent extent{240, 176};
  IntrinsicDecomposition::Params params, all;
  params.prior.reflectance_weight = all.prior.reflectance_weight = 1e3F;
  params.tolerances.half = 0;
  all.adaptive = false;
  for (const unsigned seed : {12U, 21U, 22U}) {
    const Pixels background = scene(extent, seed);
    IntrinsicDecomposition some(device, extent), whole(device, extent);
    Video video(extent);
    unsigned by_tiles = 0;
    double worst = 0;
    for (size_t k = 0; k < 30; ++k) {
      const Pixels frame = with_patch(background, extent, 36 + k % 5, 68);
      const Pixels got = pixels_of(next(some, extent, frame, video.changed(frame), params));
      const Pixels want = pixels_of(next(whole, extent, frame, {}, all));
      by_tiles += listed(some);
      update_max(worst, shading_distance(got, want));
    }
    EXPECT_GT(by_tiles, 20U);
    EXPECT_LT(worst, 0.1) << "scene " << seed;
  }
}

// What moves leaves shading behind that is wrong for what it uncovers, and that fades for as long
// as the video continues: also if tiles are skipped, to within the bound of
// docs/reference/methods/intrinsicdecomp.md, 10.
TEST_F(IntrinsicTilesTest, TrailsOfMovingObjectsFade) {
  constexpr double kMaxRms = 0.04, kMaxTile = 0.15;
  const Extent extent{240, 176};
  for (const unsigned seed : {26U, 27U}) {
    const Pixels background = scene(extent, seed);
    IntrinsicDecomposition some(device, extent), whole(device, extent);
    const IntrinsicDecomposition::Params all{.adaptive = false};
    Video video(extent);
    double before = 0;
    unsigned refreshed = 0, tiles = 0;
    for (size_t k = 0; k < 192; ++k) {
      // Across the picture, and then to and fro in a corner.
      const Pixels frame = k < 40 ? with_patch(background, extent, 5 * k, 20 + 3 * k)
                                  : with_patch(background, extent, 190 + k % 4, 140 + k % 3);
      const Pixels got = pixels_of(next(some, extent, frame, video.changed(frame)));
      const Pixels want = pixels_of(next(whole, extent, frame, {}, all));
      const auto found = some.findings();
      refreshed += listed(some) && found.tiles_active == some.stats(k).tiles;
      tiles += found.tiles_active;
      if (k % 32 != 31) continue;
      const Distance now = distance(extent, got, static_cast<double>(found.scale), want,
                                    static_cast<double>(whole.findings().scale));
      EXPECT_LT(now.rms, kMaxRms) << "scene " << seed << ", frame " << k;
      EXPECT_LT(now.tile, kMaxTile) << "scene " << seed << ", frame " << k;
      if (k > 96) {
        EXPECT_LT(now.rms, before + 0.003) << "it must not grow, scene " << seed << ", frame " << k;
      }
      before = now.rms;
      std::printf("scene %u, frame %zu: %.4f rms, tiles up to %.3f\n", seed, k, now.rms, now.tile);
    }
    EXPECT_GE(refreshed, 3U);
    EXPECT_LT(tiles, 192 * some.stats(191).tiles / 3) << "and next to nothing was worked on";
  }
}

TEST_F(IntrinsicTilesTest, AChangeEverywhereIsSolvedEverywhere) {
  const Extent extent{349, 287};
  Pixels frame = scene(extent, 22);
  IntrinsicDecomposition some(device, extent), whole(device, extent);
  IntrinsicDecomposition::Params params, all;
  all.adaptive = false;
  Video video(extent);
  const auto step = [&] {
    const Pixels got = pixels_of(next(some, extent, frame, video.changed(frame), params));
    return shading_distance(got, pixels_of(next(whole, extent, frame, {}, all)));
  };
  for (int k = 0; k < 12; ++k) step();
  EXPECT_TRUE(listed(some)) << "a still video must come to be worked on by tiles";
  for (float& v : frame) v *= 0.7F;  // the light is dimmed
  EXPECT_LT(step(), 0.06);
  EXPECT_FALSE(listed(some));
  EXPECT_EQ(some.findings().tiles_active, last_stats(some).tiles);
  for (int k = 0; k < 12; ++k) step();
  EXPECT_TRUE(listed(some));
  params.prior.shading_weight = all.prior.shading_weight = 2;
  EXPECT_LT(step(), 0.06);
  EXPECT_FALSE(listed(some)) << "other parameters concern every tile";
  frame = scene(extent, 23);  // a cut
  for (int k = 0; k < 3; ++k) EXPECT_LT(step(), 0.06);
  // Without a list of changes everything may have changed; an invalid list is refused.
  for (int k = 0; k < 12; ++k) step();
  EXPECT_TRUE(listed(some));
  next(some, extent, frame, {}, params);
  EXPECT_FALSE(listed(some));
  expect_error(ErrorKind::internal, "got 3 tiles",
               [&] { next(some, extent, frame, std::vector<uint8_t>(3), params); });
}

TEST_F(IntrinsicTilesTest, PlanesInUseElsewhereAreNotOverwritten) {
  const Extent extent{349, 287};
  const Pixels background = scene(extent, 24);
  IntrinsicDecomposition holding(device, extent), plain(device, extent);
  Video video(extent);
  std::vector<std::pair<Layers, Pixels>> held;
  for (size_t k = 0; k < 16; ++k) {
    const Pixels frame = with_patch(background, extent, 10 + 2 * k, 40);
    const auto changed = video.changed(frame);
    held.emplace_back(next(holding, extent, frame, changed), Pixels());
    held.back().second = pixels_of(held.back().first);
    EXPECT_EQ(held.back().second, pixels_of(next(plain, extent, frame, changed)))
        << "whoever holds planes must not change what is seen";
  }
  EXPECT_TRUE(listed(holding));
  for (const auto& [layers, pixels] : held) EXPECT_EQ(pixels_of(layers), pixels);
}

TEST_F(IntrinsicTilesTest, TheScaleStaysWhileOnlyTilesAreWorkedOn) {
  const Extent extent{160, 120};
  const Pixels frame = scene(extent, 25);
  IntrinsicDecomposition method(device, extent);
  IntrinsicDecomposition::Params params;
  Video video(extent);
  for (int k = 0; k < 8; ++k) next(method, extent, frame, video.changed(frame), params);
  params.scale.white_level = 0.5F;
  unsigned count = 0;
  for (int k = 0; k < 12; ++k) {
    const float last = method.findings().scale;
    const Pixels got = pixels_of(next(method, extent, frame, video.changed(frame), params));
    if (listed(method)) {
      ++count;
      EXPECT_EQ(method.findings().scale, last) << "other tiles' layers have the old scale";
      EXPECT_NE(method.drawn(), nullptr);
    }
    for (size_t i = 0; i < got.size(); ++i)
      if (i % 4 < 3) {
        ASSERT_NEAR(got[i] * got[i | 3], frame[i], 1e-5);
      }
  }
  EXPECT_GT(count, 3U);
}

TEST(ChangedTiles, AreFoundByteByByteInEveryFormat) {
  const Extent extent{53, 37};  // 4 x 3 tiles
  std::vector<PixelFormat> formats{PixelFormat::rgba,     PixelFormat::rgb,  PixelFormat::gray8,
                                   PixelFormat::nv12,     PixelFormat::i420, PixelFormat::yuy2,
                                   PixelFormat::p010_10le};
  formats.insert(formats.end(), std::begin(kDescribed), std::end(kDescribed));
  for (const PixelFormat& format : formats) {
    // Three tiles begin and end together in words of three samples.
    const bool thirds = format.unit == Unit::thirds;
    const std::vector<size_t> first =
        thirds ? std::vector<size_t>{0, 1, 2} : std::vector<size_t>{0};
    std::vector<size_t> left = first;
    for (const size_t tile : first) left.push_back(8 + tile);
    std::vector<std::vector<uint8_t>> planes;
    std::vector<ChangedTiles::Rows> rows;
    for (uint32_t p = 0; p < format.planes; ++p) {
      const size_t stride = row_bytes(format, extent, p) + 5;
      planes.emplace_back(stride * plane_rows(format, extent, p), uint8_t(7));
      rows.push_back({planes[p].data(), static_cast<ptrdiff_t>(stride)});
    }
    ChangedTiles tiles(format, extent);
    EXPECT_TRUE(tiles.next(rows).empty()) << "there is nothing to compare the first frame with";
    const auto flagged = [&] {
      const auto changed = tiles.next(rows);
      std::vector<size_t> where;
      for (size_t i = 0; i < changed.size(); ++i)
        if (changed[i]) where.push_back(i);
      return where;
    };
    EXPECT_EQ(flagged(), std::vector<size_t>());
    planes[0][static_cast<size_t>(rows[0].stride) - 2] ^= 1;  // padding
    EXPECT_EQ(flagged(), std::vector<size_t>());
    for (uint32_t p = 0; p < planes.size(); ++p) {
      const size_t last_row = plane_rows(format, extent, p) - 1,
                   last_byte = row_bytes(format, extent, p) - 1;
      const auto stride = static_cast<size_t>(rows[p].stride);
      planes[p][last_row * stride + last_byte] ^= 1;
      EXPECT_EQ(flagged(), std::vector<size_t>{11}) << format.name << ", plane " << p;
      planes[p][0] ^= 1;
      planes[p][last_row * stride] ^= 1;
      EXPECT_EQ(flagged(), left) << format.name << ", plane " << p;
      EXPECT_EQ(flagged(), std::vector<size_t>());
    }
    // Upside down: the last row in memory comes first.
    rows[0].data += rows[0].stride * static_cast<ptrdiff_t>(plane_rows(format, extent, 0) - 1);
    rows[0].stride = -rows[0].stride;
    flagged();
    planes[0][0] ^= 1;
    EXPECT_EQ(flagged(), std::vector<size_t>(left.begin() + left.size() / 2, left.end()))
        << format.name;
    tiles.reset();
    EXPECT_TRUE(tiles.next(rows).empty());
  }
}

TEST(ChangedTiles, AreUnknownWhileMostChangeAndFoundAgainWhereFewDo) {
  const Extent extent{64, 48};  // 4 x 3 tiles
  std::vector<uint8_t> pixels(extent.pixels());
  const ChangedTiles::Rows rows[] = {{pixels.data(), 64}};
  ChangedTiles tiles(PixelFormat::gray8, extent);
  const auto flagged = [&] {
    const auto changed = tiles.next(rows);
    return changed.empty() ? -1 : std::count(changed.begin(), changed.end(), 1);
  };
  const auto move = [&](uint32_t columns) {
    for (size_t i = 0; i < pixels.size(); ++i)
      if (i % 64 < columns) ++pixels[i];
  };
  EXPECT_EQ(flagged(), -1);
  for (int frame = 0; frame < 4; ++frame) {
    move(64);
    EXPECT_EQ(flagged(), 12);
  }
  for (int frame = 0; frame < 3; ++frame) {
    move(64);
    EXPECT_EQ(flagged(), -1);
  }
  // An object that crosses every row: the first of these frames is compared with one that is not
  // known as a whole.
  move(16);
  EXPECT_EQ(flagged(), -1);
  for (int frame = 0; frame < 6; ++frame) {
    move(16);
    EXPECT_EQ(flagged(), 3);
  }
  EXPECT_EQ(flagged(), 0);
}

TEST_F(IntrinsicTilesTest, FramesAreConvertedByTile) {
  std::vector<PixelFormat> formats{PixelFormat::rgba, PixelFormat::rgb,  PixelFormat::nv12,
                                   PixelFormat::i420, PixelFormat::yuy2, PixelFormat::gray8};
  formats.insert(formats.end(), std::begin(kDescribed), std::end(kDescribed));
  for (const PixelFormat& pixel : formats) {
    FrameFormat format;
    format.format = pixel;
    format.extent = {93, 61};
    if (is_yuv(pixel)) format.matrix = Matrix::bt709();
    format = aligned_layout(format, 4);
    const Unpack unpack(device, format);
    const Pack pack(device, format);
    std::mt19937 random(7);
    std::vector<uint32_t> words(raw_words(format));
    for (uint32_t& word : words) word = static_cast<uint32_t>(random());
    const auto raw = upload(gpu::Element::word, words.data(), words.size());
    const TileList all = all_tiles(device, format.extent);
    TileList some(device, format.extent, gpu::Memory::upload);
    std::vector<uint8_t> flags(some.tiles());
    flags[7] = 1;  // the second of the second row
    some.assign(flags);
    const Plane planes[] = {plane(format.extent), plane(format.extent), plane(format.extent)};
    const auto back = [&] {
      return gpu::Buffer::create(device, gpu::Element::word, raw_words(format),
                                 gpu::Memory::readback);
    };
    const auto whole = back(), listed = back();
    run([&](gpu::Commands& commands) {
      for (const Plane& each : planes) commands.fill(each.buffer);
      unpack.record(commands, raw, planes[0]);
      unpack.record(commands, raw, planes[1], &all);
      unpack.record(commands, raw, planes[2], &some);
      commands.fill(whole);
      commands.fill(listed);
      pack.record(commands, {.picture = planes[0]}, whole);
      pack.record(commands, {.picture = planes[0]}, listed, &all);
    });
    const Pixels got = download(planes[0]), part = download(planes[2]);
    EXPECT_EQ(got, download(planes[1])) << pixel.name;
    EXPECT_EQ(memcmp(whole->map(), listed->map(), whole->bytes()), 0) << pixel.name;
    for (size_t i = 0; i < format.extent.pixels(); ++i) {
      const size_t x = i % format.extent.width, y = i / format.extent.width;
      const bool inside = x / 16 == 1 && y / 16 == 1;
      for (size_t c = 0; c < 4; ++c)
        ASSERT_EQ(part[4 * i + c], inside ? got[4 * i + c] : 0.0F) << pixel.name << " " << i;
    }
  }
}

}  // namespace inverse::testing
