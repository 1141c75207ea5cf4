// SPDX-License-Identifier: LGPL-2.1-or-later
// Every pixel format against its reference, both ways.
#include "tests/reference/image/pixel_format.hpp"

#include <algorithm>
#include <cstring>

#include "kernels/image/format/convert.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/kernels/image/described_formats.hpp"

namespace inverse::testing {
namespace {

using Bytes = std::vector<std::byte>;

/// Those with kernels of their own; the first nine without subsampled chroma.
constexpr PixelFormat kFormats[] = {
    PixelFormat::rgba,      PixelFormat::bgra,      PixelFormat::rgbx,      PixelFormat::bgrx,
    PixelFormat::rgb,       PixelFormat::bgr,       PixelFormat::rgba64_le, PixelFormat::gray8,
    PixelFormat::gray16_le, PixelFormat::nv12,      PixelFormat::i420,      PixelFormat::yuy2,
    PixelFormat::uyvy,      PixelFormat::p010_10le, PixelFormat::i420_10le};
constexpr TransferFunction kCurves[] = {
    TransferFunction::srgb,      TransferFunction::bt709,   TransferFunction::linear,
    TransferFunction::smpte240m, TransferFunction::gamma18, TransferFunction::gamma20,
    TransferFunction::gamma22,   TransferFunction::gamma28, TransferFunction::adobe_rgb,
    TransferFunction::pq,        TransferFunction::hlg};
constexpr Matrix kMatrices[] = {Matrix::bt601(), Matrix::bt709(), Matrix::bt2020()};

/// Words between rows and before planes that are not the frame's, so that strides are exercised.
FrameFormat padded(FrameFormat format, uint32_t extra_words) {
  format = aligned_layout(format, 4);
  uint32_t end = 4 * extra_words;
  for (uint32_t p = 0; p < format.format.planes; ++p) {
    format.offset[p] = end;
    format.stride[p] += 4 * extra_words;
    end += format.stride[p] * plane_rows(format.format, format.extent, p) + 4 * extra_words;
  }
  return format;
}

/// The n-th of the ways to vary what is not format or size.
FrameFormat variation(PixelFormat format, Extent extent, uint32_t n) {
  FrameFormat f{format, extent};
  f.range = n % 2 ? Range::full : Range::limited;
  f.transfer = Transfer::of(kCurves[n % std::size(kCurves)]);
  f.matrix = kMatrices[n % std::size(kMatrices)];
  f.site = {n / 2 % 2 == 0, n / 4 % 2 == 1};
  if (n % 7 == 6) f.gamut = gamut_between(Primaries::bt2020(), Primaries::bt709());
  return padded(f, n % 3);
}

Bytes random_bytes(const FrameFormat& format, unsigned seed) {
  std::mt19937 random(seed);
  Bytes bytes(frame_bytes(format));
  for (auto& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

std::string label(const FrameFormat& f, uint32_t n) {
  return std::string(f.format.name) + " " + name_of(f.extent) + " variation " + std::to_string(n);
}

/// Codes that differ, out of how many, and by how much at most.
struct Difference {
  uint64_t samples = 0, differing = 0;
  uint32_t largest = 0;
  void add(uint32_t a, uint32_t b) {
    ++samples;
    if (a != b) ++differing;
    largest = std::max(largest, a > b ? a - b : b - a);
  }
};

Difference difference(const FrameFormat& f, const Bytes& a, const Bytes& b, bool fourth = true) {
  Difference d;
  for (uint32_t y = 0; y < f.extent.height; ++y)
    for (uint32_t x = 0; x < f.extent.width; ++x) {
      const auto p = reference::pixel_codes(f, a, x, y), q = reference::pixel_codes(f, b, x, y);
      for (uint32_t c = 0; c < reference::components(f.format); ++c) d.add(p.value[c], q.value[c]);
      if (fourth) d.add(p.value[3], q.value[3]);
    }
  const Extent chroma = reference::chroma_extent(f);
  for (uint32_t y = 0; y < chroma.height; ++y)
    for (uint32_t x = 0; x < chroma.width; ++x) {
      const auto p = reference::chroma_codes_at(f, a, x, y),
                 q = reference::chroma_codes_at(f, b, x, y);
      for (int c = 0; c < 2; ++c) d.add(p.value[c], q.value[c]);
    }
  return d;
}

}  // namespace

class PixelFormatTest : public GpuTest, public ::testing::WithParamInterface<PixelFormat> {
 protected:
  gpu::BufferPtr raw_buffer(const FrameFormat& format, const Bytes& bytes) {
    auto raw =
        gpu::Buffer::create(device, gpu::Element::word, raw_words(format), gpu::Memory::upload);
    memcpy(raw->map(), bytes.data(), bytes.size());
    return raw;
  }

  Pixels unpack(const FrameFormat& format, const Bytes& bytes) {
    const Unpack unpack(device, format);
    const Plane target = plane(format.extent);
    const auto raw = raw_buffer(format, bytes);
    run([&](gpu::Commands& commands) { unpack.record(commands, raw, target); });
    return download(target);
  }

  Bytes pack(const FrameFormat& format, const Pixels& picture, Drawing::Source source, float gain,
             const Pixels* alpha) {
    const Pack pack(device, format);
    const Plane from = plane(format.extent, picture);
    const Plane alpha_plane = plane(format.extent, alpha ? *alpha : Pixels{});
    auto raw =
        gpu::Buffer::create(device, gpu::Element::word, raw_words(format), gpu::Memory::readback);
    run([&](gpu::Commands& commands) {
      commands.fill(raw, kUntouched);
      pack.record(commands, {from, source, gain, alpha ? &alpha_plane : nullptr}, raw);
    });
    const auto* bytes = raw->map_as<std::byte>();
    expect_untouched_padding(format, raw->map_as<uint32_t>());
    return {bytes, bytes + frame_bytes(format)};
  }

  void expect_untouched_padding(const FrameFormat& format, const uint32_t* words) {
    std::vector<bool> used(raw_words(format), false);
    for (uint32_t p = 0; p < format.format.planes; ++p)
      for (uint32_t y = 0; y < plane_rows(format.format, format.extent, p); ++y) {
        const uint64_t start = format.offset[p] + static_cast<uint64_t>(y) * format.stride[p];
        const uint64_t end = start + row_bytes(format.format, format.extent, p);
        for (uint64_t w = start / 4; w <= (end - 1) / 4; ++w) used[w] = true;
      }
    for (size_t w = 0; w < used.size(); ++w)
      ASSERT_TRUE(used[w] || words[w] == kUntouched) << "word " << w << " is not the frame's";
  }

  void check_unpack(const FrameFormat& format, uint32_t n) {
    const Bytes bytes = random_bytes(format, n + format.extent.width);
    const Pixels got = unpack(format, bytes);
    const std::vector<double> expected = reference::unpack(format, bytes);
    ASSERT_EQ(got.size(), expected.size());
    // PQ raises to the power of 78.8 and back.
    const double tolerance = format.transfer.curve == Transfer::Curve::pq ? 2e-4 : 1e-5;
    for (size_t i = 0; i < got.size(); ++i)
      ASSERT_NEAR(got[i], expected[i], 1e-5 + tolerance * expected[i])
          << label(format, n) << " at " << i;
  }

  void check_pack(const FrameFormat& format, uint32_t n) {
    Pixels picture = random_pixels(format.extent, n + format.extent.width, -0.05f, 1.3f);
    const Pixels alpha = random_pixels(format.extent, n + 1, -0.1f, 1.1f);
    const float gain = n % 4 == 3 ? 0.5f : 1.0f;
    const bool shading = n % 5 == 4;
    const Pixels* alpha_source = n % 3 == 2 ? nullptr : &alpha;
    const Bytes got =
        pack(format, picture, shading ? Drawing::Source::shading : Drawing::Source::color, gain,
             alpha_source);
    const Bytes expected = reference::pack(format, picture, shading, gain, alpha_source);
    const Difference d = difference(format, got, expected);
    EXPECT_LE(d.largest, 1u) << label(format, n);
    total_.samples += d.samples;
    total_.differing += d.differing;
  }

  /// All variations of formats with kernels of their own; of the described ones, which share their
  /// code, some each, so that together they have all.
  static std::vector<uint32_t> variations() {
    constexpr uint32_t kAll = 72, kShared = 15;
    const auto* described = std::ranges::find(kDescribed, GetParam());
    const bool shares = described != std::end(kDescribed);
    std::vector<uint32_t> numbers;
    for (uint32_t n = shares ? uint32_t(described - std::begin(kDescribed)) % kShared : 0; n < kAll;
         n += shares ? kShared : 1)
      numbers.push_back(n);
    return numbers;
  }

  static constexpr uint32_t kUntouched = 0xabadcafe;
  Difference total_;
};

TEST_P(PixelFormatTest, UnpackAgreesWithReference) {
  for (uint32_t n = 0; n < kOddSizes.size(); ++n)
    ASSERT_NO_FATAL_FAILURE(check_unpack(variation(GetParam(), kOddSizes[n], n), n));
  for (const uint32_t n : variations())
    ASSERT_NO_FATAL_FAILURE(check_unpack(variation(GetParam(), {17, 5}, n), n));
}

TEST_P(PixelFormatTest, PackAgreesWithReference) {
  for (uint32_t n = 0; n < kOddSizes.size(); ++n)
    check_pack(variation(GetParam(), kOddSizes[n], n), n);
  for (const uint32_t n : variations()) check_pack(variation(GetParam(), {15, 10}, n), n);
  RecordProperty("differing", static_cast<int>(total_.differing));
  RecordProperty("samples", static_cast<int>(total_.samples));
  // A relative error of 1e-6 in the curve, which Vulkan allows pow, is 0.07 of a 16-bit code.
  const uint64_t allowed = bit_depth(GetParam()) < 16 ? 1000 : 10;
  EXPECT_LE(total_.differing, total_.samples / allowed) << "of " << total_.samples;
}

TEST_P(PixelFormatTest, BadPixelsBecomeBlackOrWhite) {
  const float bad[] = {kNan, -kNan, -kInf, -1e30f, -0.0f, 1e-40f, kInf, 1e30f};
  FrameFormat format{GetParam(), {8, 2}};
  format.matrix = Matrix::bt709();
  format.transfer = Transfer::of(TransferFunction::srgb);
  format = aligned_layout(format);
  Pixels picture(format.extent.pixels() * 4);
  for (size_t i = 0; i < picture.size(); ++i) picture[i] = bad[i / 4 % 8];
  const Bytes got = pack(format, picture, Drawing::Source::color, 1.0f, &picture);
  for (uint32_t x = 0; x < 8; ++x)
    for (uint32_t c = 0; c < 4; ++c) {
      if (c < 3 ? c >= reference::components(GetParam()) : !GetParam().alpha) continue;
      const uint32_t depth = GetParam().components[c].depth;
      EXPECT_EQ(reference::pixel_codes(format, got, x, 1).value[c], x < 6 ? 0 : (1u << depth) - 1)
          << x << ", component " << c;
    }
}

/// Formats whose bytes come back exactly: no subsampled chroma.
class RgbFormatTest : public PixelFormatTest {};

TEST_P(RgbFormatTest, RoundTripReturnsTheBytes) {
  for (const TransferFunction curve : kCurves) {
    FrameFormat format{GetParam(), {349, 287}};
    format.transfer = Transfer::of(curve);
    format = aligned_layout(format);
    const Bytes bytes = random_bytes(format, 7);
    const Pixels linear = unpack(format, bytes);
    const Bytes back = pack(format, linear, Drawing::Source::color, 1.0f, &linear);
    const Difference d = difference(format, bytes, back, GetParam().alpha);
    // PQ needs a power of 78.8, of which a float keeps 14 bits.
    const bool rounds = curve == TransferFunction::pq && bit_depth(GetParam()) == 16;
    EXPECT_LE(d.largest, rounds ? 4u : 0u)
        << GetParam().name << " curve " << static_cast<int>(curve) << ", by at most " << d.largest;
  }
}

INSTANTIATE_TEST_SUITE_P(Described, PixelFormatTest, ::testing::ValuesIn(kDescribed),
                         [](const auto& tested) { return std::string(tested.param.name); });
INSTANTIATE_TEST_SUITE_P(Described, RgbFormatTest, ::testing::ValuesIn(kDescribed, kDescribed + 12),
                         [](const auto& tested) { return std::string(tested.param.name); });
INSTANTIATE_TEST_SUITE_P(All, PixelFormatTest, ::testing::ValuesIn(kFormats),
                         [](const auto& tested) { return std::string(tested.param.name); });
INSTANTIATE_TEST_SUITE_P(Full, RgbFormatTest, ::testing::ValuesIn(kFormats, kFormats + 9),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace inverse::testing
