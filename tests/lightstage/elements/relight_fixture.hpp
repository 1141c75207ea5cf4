// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>

#include <algorithm>
#include <cmath>

#include "kernels/environment/environment.hpp"
#include "kernels/lightstage/program/light_program.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/elements/lamp.hpp"
#include "tests/lightstage/kernels/relight_models.hpp"
#include "tests/srgb.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {

inline constexpr int kSide = 64;

inline float encoded(double linear) {
  return static_cast<float>(srgb_code(std::clamp(linear, 0.0, 1.0)));
}

/// A white sphere under the gradients of a stage of 331 lights, linear RGBA.
struct Sphere {
  std::vector<float> a, b;
  explicit Sphere(int side = kSide) {
    const auto lights = geodesic_directions(331);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double px = 2 * (x + .5) / side - 1, py = 1 - 2 * (y + .5) / side;
        const double r2 = px * px + py * py;
        std::array<double, 3> first{}, second{};
        if (r2 < .9) {
          const double pz = std::sqrt(1 - r2);
          for (const auto& w : lights) {
            const double l = std::max(0.0, px * w[0] + py * w[1] + pz * w[2]) * .007;
            for (size_t c = 0; c < 3; ++c) {
              first[c] += l * (1 + w[c]) / 2;
              second[c] += l * (1 - w[c]) / 2;
            }
          }
        }
        for (size_t c = 0; c < 3; ++c) {
          a.push_back(static_cast<float>(first[c]));
          b.push_back(static_cast<float>(second[c]));
        }
        a.push_back(1);
        b.push_back(1);
      }
  }
  /// A left, B right, 8 bits sRGB.
  std::vector<uint8_t> side_by_side(int side = kSide) const {
    std::vector<uint8_t> bytes;
    const auto row = static_cast<size_t>(side) * 4;
    for (size_t y = 0; y < static_cast<size_t>(side); ++y)
      for (const auto* half : {&a, &b})
        for (size_t i = 0; i < row; ++i)
          bytes.push_back(static_cast<uint8_t>(std::lround(255 * encoded((*half)[y * row + i]))));
    return bytes;
  }
};

class RelightTest : public ::testing::Test {
 protected:
  static std::string caps(int width = 2 * kSide, int height = kSide, const char* format = "RGBA") {
    return VideoHarness::caps(format, width, height);
  }
  static const uint8_t* at(const std::vector<uint8_t>& frame, int x, int y, int width = kSide) {
    return pixel_at(frame, x, y, width);
  }
  std::string white(float radiance = 1) const {
    const std::string path = folder / "white.hdr";
    Environment::uniform({radiance, radiance, radiance}).save(path);
    return path;
  }
  std::string lamp_file(float red, float green, float blue) const {
    const std::string path = folder / "lamp.hdr";
    lamp(2, red, green, blue).save(path);
    return path;
  }
  /// `odd` in one pixel of an otherwise even OpenEXR map.
  std::string exr(float odd, int width = 64) const {
    std::vector<Imf::Rgba> pixels(static_cast<size_t>(width) * 32, Imf::Rgba(1, 1, 1));
    pixels[100].g = odd;
    return write_exr(folder / "map.exr", width, pixels);
  }
  /// A map of single floats whose channels have these names, even but for one pixel.
  std::string float_exr(const std::vector<const char*>& channels, float odd) const {
    constexpr int kWide = 64, kHigh = 32;
    std::vector<float> values(size_t{kWide} * kHigh, 1);
    values[100] = odd;
    Imf::Header header(kWide, kHigh);
    Imf::FrameBuffer pixels;
    for (const char* name : channels) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      pixels.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()),
                                     sizeof(float), sizeof(float) * kWide));
    }
    const std::string path = folder / "float.exr";
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(pixels);
    file.writePixels(kHigh);
    return path;
  }
  /// The folder of a network of random weights.
  std::string models() const {
    write_graph(random_features(1), folder / "models/olat/features.net");
    write_graph(random_light(2), folder / "models/olat/light.net");
    return folder / "models";
  }
  /// The first picture that stats say is lit by this; waits for it.
  std::vector<uint8_t> lit_by(VideoHarness& harness, const std::string& light) const {
    while (true) {
      auto picture = harness.process(sphere.side_by_side());
      if (stat<std::string>(harness.find("olatrelight"), "environment") == light) return picture;
      g_usleep(1000);
    }
  }
  static LineResult run(const std::string& properties, int width = 128) {
    return run_line("videotestsrc num-buffers=2 ! video/x-raw,width=" + std::to_string(width) +
                    ",height=32 ! olatrelight " + properties + " ! fakesink");
  }
  static std::string error_of(const std::string& properties) {
    return run(properties).first_error();
  }

  const Sphere sphere;
  const TemporaryFolder folder;
};

}  // namespace inverse::testing
