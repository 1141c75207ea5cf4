// SPDX-License-Identifier: LGPL-2.1-or-later
// What surrounds the conversion kernels: transfer curves, layouts, refusals, the mosaic.
#include <cmath>
#include <cstring>
#include <string>

#include "kernels/image/format/convert.hpp"
#include "kernels/image/pyramid.hpp"
#include "kernels/image/view/mosaic.hpp"
#include "tests/expect_error.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/reference/image/mosaic.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {
namespace {

/// The curves as their standards write them, to linear light.
double standard_decode(TransferFunction function, double x) {
  switch (function) {
    case TransferFunction::srgb:
      return srgb_light(x);
    case TransferFunction::bt709:
      return x < 0.081 ? x / 4.5 : std::pow((x + 0.099) / 1.099, 1 / 0.45);
    case TransferFunction::smpte240m:
      return x < 0.0913 ? x / 4 : std::pow((x + 0.1115) / 1.1115, 1 / 0.45);
    case TransferFunction::adobe_rgb:
      return std::pow(x, 2.19921875);
    case TransferFunction::gamma18:
      return std::pow(x, 1.8);
    case TransferFunction::gamma20:
      return x * x;
    case TransferFunction::gamma22:
      return std::pow(x, 2.2);
    case TransferFunction::gamma28:
      return std::pow(x, 2.8);
    case TransferFunction::pq: {  // SMPTE ST 2084, equation 4.1
      const double root = std::pow(x, 1 / 78.84375);
      const double light = std::pow(std::max(root - 0.8359375, 0.0) / (18.8515625 - 18.6875 * root),
                                    1 / 0.1593017578125);
      return 10000 * light / 203;
    }
    case TransferFunction::hlg: {  // ITU-R BT.2100, table 5
      const double scene =
          x <= 0.5 ? x * x / 3 : (std::exp((x - 0.55991073) / 0.17883277) + 0.28466892) / 12;
      return scene / 0.26496256;
    }
    default:
      return x;
  }
}
constexpr TransferFunction kCurves[] = {
    TransferFunction::linear,    TransferFunction::srgb,    TransferFunction::bt709,
    TransferFunction::smpte240m, TransferFunction::gamma18, TransferFunction::gamma20,
    TransferFunction::gamma22,   TransferFunction::gamma28, TransferFunction::adobe_rgb,
    TransferFunction::pq,        TransferFunction::hlg};

}  // namespace

TEST(TransferTest, FollowsTheStandards) {
  for (const TransferFunction function : kCurves) {
    const Transfer curve = Transfer::of(function);
    for (int i = 0; i <= 1100; ++i) {
      const double x = i / 1000.0;
      EXPECT_NEAR(curve.decode(x), standard_decode(function, x), 1.5e-4)
          << static_cast<int>(function) << " at " << x;
    }
  }
}

TEST(TransferTest, EncodeIsTheExactInverseAndIncreasing) {
  for (const TransferFunction function : kCurves) {
    const Transfer curve = Transfer::of(function);
    double before = -1;
    for (int i = 0; i <= 70000; ++i) {
      const double x = i / 65535.0, linear = curve.decode(x);
      ASSERT_GT(linear, before) << static_cast<int>(function) << " at " << x;
      ASSERT_NEAR(curve.encode(linear), x, 1e-6) << static_cast<int>(function);
      before = linear;
    }
  }
}

TEST(TransferTest, LogarithmicCurvesAreRefusedByName) {
  for (const auto& [function, text] :
       {std::pair{TransferFunction::log100, "100:1"}, {TransferFunction::log316, "316"}})
    expect_error(ErrorKind::unsupported, text, [f = function] { Transfer::of(f); });
}

// ITU-R BT.2408-7, tables 1 and 3: signals of gray and of the reference white; ST 2084's peak.
TEST(TransferTest, HighDynamicRangeHasTheReferenceWhiteOfTheStandards) {
  const Transfer pq = Transfer::of(TransferFunction::pq), hlg = Transfer::of(TransferFunction::hlg);
  EXPECT_NEAR(pq.decode(1) * 203, 10000, 1e-6);
  EXPECT_NEAR(pq.encode(1), 0.58, 0.002);
  EXPECT_NEAR(pq.encode(26.0 / 203), 0.38, 0.002);
  EXPECT_NEAR(pq.decode(0), 0, 1e-12);
  EXPECT_NEAR(hlg.decode(0.75), 1, 1e-12);
  EXPECT_NEAR(hlg.decode(1), 3.774, 1e-3);
  EXPECT_NEAR(hlg.decode(0.5), 1 / 12.0 / 0.26496256, 1e-7);
  // With the system gamma of 1.2 at 1000 cd/m², the scene light 1 is shown at 203 cd/m².
  EXPECT_NEAR(1000 * std::pow(0.26496256, 1.2), 203, 0.5);
}

// ITU-R BT.2087, the matrix from BT.709 to BT.2020, and its inverse (BT.2407).
TEST(GamutTest, FollowsTheStandards) {
  const double wide[] = {0.6274, 0.3293, 0.0433, 0.0691, 0.9195, 0.0114, 0.0164, 0.0880, 0.8956};
  const double narrow[] = {1.6605,  -0.5876, -0.0728, -0.1246, 1.1329,
                           -0.0083, -0.0182, -0.1006, 1.1187};
  const Gamut out = gamut_between(Primaries::bt709(), Primaries::bt2020()),
              in = gamut_between(Primaries::bt2020(), Primaries::bt709());
  for (size_t i = 0; i < 9; ++i) {
    EXPECT_NEAR(out.matrix[i], wide[i], 1e-4) << i;
    EXPECT_NEAR(in.matrix[i], narrow[i], 1e-4) << i;
  }
  EXPECT_TRUE(gamut_between(Primaries::bt709(), Primaries::bt709()).is_identity());
  // White of another color temperature stays white.
  Primaries warm = Primaries::bt709();
  warm.white = {0.3101, 0.3162};
  const Gamut adapted = gamut_between(warm, Primaries::bt2020());
  for (size_t row = 0; row < 3; ++row)
    EXPECT_NEAR(adapted.matrix[3 * row] + adapted.matrix[3 * row + 1] + adapted.matrix[3 * row + 2],
                1, 1e-6);
}

TEST(FrameFormatTest, BytesAreThoseOfTheLayout) {
  const auto bytes = [](PixelFormat format, Extent extent, uint32_t alignment) {
    return frame_bytes(aligned_layout({format, extent}, alignment));
  };
  EXPECT_EQ(bytes(PixelFormat::rgba, {640, 480}, 4), 640u * 480 * 4);
  EXPECT_EQ(bytes(PixelFormat::nv12, {640, 480}, 4), 640u * 480 * 3 / 2);
  EXPECT_EQ(bytes(PixelFormat::i420, {640, 480}, 4), 640u * 480 * 3 / 2);
  EXPECT_EQ(bytes(PixelFormat::p010_10le, {640, 480}, 4), 640u * 480 * 3);
  EXPECT_EQ(bytes(PixelFormat::yuy2, {3, 2}, 4), 16u);     // two pairs a row
  EXPECT_EQ(bytes(PixelFormat::rgb, {3, 2}, 4), 12u + 9);  // no padding behind the last row
  EXPECT_EQ(bytes(PixelFormat::i420, {5, 3}, 4), 24u + 8 + 4 + 3);
  EXPECT_EQ(bytes(PixelFormat::nv12, {1, 1}, 4), 4u + 2);
}

TEST(FrameFormatTest, BadFramesAreRefused) {
  FrameFormat format = aligned_layout({PixelFormat::rgba, {16, 16}});
  format.stride[0] = 63;
  expect_error(ErrorKind::unsupported, "stride of only 63", [&] { validate(format); });
  format = aligned_layout({PixelFormat::rgba, {0, 16}});
  expect_error(ErrorKind::unsupported, "no pixels", [&] { validate(format); });
  format = aligned_layout({PixelFormat::nv12, {16, 16}});
  expect_error(ErrorKind::unsupported, "matrix", [&] { validate(format); });
  format.matrix = Matrix::bt601();
  EXPECT_NO_THROW(validate(format));
}

class FrameTest : public GpuTest {};

TEST_F(FrameTest, UnalignedStridesAreCopiedAndThenConverted) {
  FrameFormat odd{PixelFormat::rgb, {5, 7}};
  odd.stride = {17};
  odd.offset = {3};
  expect_error(ErrorKind::unsupported, "aligned layout", [&] { Unpack(device, odd); });
  expect_error(ErrorKind::unsupported, "aligned layout", [&] { Pack(device, odd); });

  std::vector<std::byte> bytes(frame_bytes(odd)), back(bytes.size());
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 37 + 11);
  const FrameFormat aligned = aligned_layout(odd);
  const Unpack unpack(device, aligned);
  const Pack pack(device, aligned);
  auto in =
      gpu::Buffer::create(device, gpu::Element::word, raw_words(aligned), gpu::Memory::upload);
  auto out =
      gpu::Buffer::create(device, gpu::Element::word, raw_words(aligned), gpu::Memory::readback);
  copy_plane(odd.format, odd.extent, 0, &bytes[3], 17, in->map(), aligned.stride[0]);
  const Plane linear = plane(odd.extent);
  run([&](gpu::Commands& commands) {
    unpack.record(commands, in, linear);
    pack.record(commands, {.picture = linear}, out);
  });
  copy_plane(odd.format, odd.extent, 0, out->map(), aligned.stride[0], &back[3], 17);
  for (uint32_t y = 0; y < 7; ++y)
    EXPECT_EQ(memcmp(&bytes[3 + y * 17], &back[3 + y * 17], 15), 0) << "row " << y;
  EXPECT_EQ(back[0], std::byte{0});  // what is not the frame's stays as it was
}

TEST_F(FrameTest, NeutralLumaComesBackExactly) {
  for (const PixelFormat pixel_format :
       {PixelFormat::nv12, PixelFormat::i420, PixelFormat::yuy2, PixelFormat::uyvy,
        PixelFormat::p010_10le, PixelFormat::i420_10le}) {
    FrameFormat format{pixel_format, {64, 48}};
    format.range = Range::limited;
    format.matrix = Matrix::bt709();
    format.transfer = Transfer::of(TransferFunction::bt709);
    format = aligned_layout(format);
    // A gray ramp from black to the largest code, drawn by Pack, then there and back.
    Pixels ramp(format.extent.pixels() * 4);
    for (size_t i = 0; i < ramp.size(); ++i)
      ramp[i] = 1.2f * static_cast<float>(i / 4) / static_cast<float>(format.extent.pixels());
    const Plane source = plane(format.extent, ramp), linear = plane(format.extent);
    const Unpack unpack(device, format);
    const Pack pack(device, format);
    auto raw = [&] {
      return gpu::Buffer::create(device, gpu::Element::word, raw_words(format),
                                 gpu::Memory::readback);
    };
    const auto first = raw(), second = raw();
    run([&](gpu::Commands& commands) {
      pack.record(commands, {.picture = source}, first);
      unpack.record(commands, first, linear);
      pack.record(commands, {.picture = linear}, second);
    });
    EXPECT_EQ(memcmp(first->map(), second->map(), frame_bytes(format)), 0) << pixel_format.name;
  }
}

TEST_F(FrameTest, DifferentSizesAreRefused) {
  const FrameFormat format = aligned_layout({PixelFormat::rgba, {8, 8}});
  const Unpack unpack(device, format);
  const auto raw = gpu::Buffer::create(device, gpu::Element::word, raw_words(format));
  const Plane other = plane({9, 8});
  gpu::Commands commands(device);
  commands.begin();
  expect_error(ErrorKind::internal, "plane and frame differ in size",
               [&] { unpack.record(commands, raw, other); });
  const auto little = gpu::Buffer::create(device, gpu::Element::word, raw_words(format) - 1);
  expect_error(ErrorKind::internal, "the raw buffer is shorter than the frame", [&] {
    unpack.record(commands, little, plane({8, 8}));
  });
  commands.submit();
}

TEST_F(FrameTest, MosaicAgreesWithReference) {
  const Mosaic mosaic(device);
  for (const Extent extent : kOddSizes) {
    const Pixels a = random_pixels(extent, 1), b = random_pixels(extent, 2);
    const Plane first = plane(extent, a), second = plane(extent, b), target = plane(extent);
    run([&](gpu::Commands& commands) {
      mosaic.record(commands,
                    {{{&first}, {&second}, {&second, Drawing::Source::shading, 0.5f}, {}}}, target);
    });
    const reference::Plane one = to_reference(extent, a), two = to_reference(extent, b);
    const reference::Plane expected =
        reference::mosaic({{{&one}, {&two}, {&two, true, 0.5}, {}}}, static_cast<int>(extent.width),
                          static_cast<int>(extent.height));
    expect_near(download(target), expected, 1e-6, name_of(extent));
  }
}

}  // namespace inverse::testing
