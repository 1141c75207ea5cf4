// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagetestsrc with folders of pictures in place of its head.
#include <ImfArray.h>
#include <ImfRgbaFile.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "kernels/lightstage/program/light_program.hpp"
#include "test_source_shots.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

namespace fs = std::filesystem;

/// A folder of OLAT images with `lights` lights.
class Folder {
 public:
  explicit Folder(int lights, int width = 24, int height = 20) {
    fs::create_directory(folder_ / "olat");
    std::ofstream json(folder_ / "lights.json");
    json << "{\"directions\": [";
    const auto directions = geodesic_directions(static_cast<uint32_t>(lights));
    for (int i = 0; i < lights; ++i) {
      const auto& d = directions[static_cast<size_t>(i)];
      json << (i ? "," : "") << "[" << d[0] << "," << d[1] << "," << d[2] << "]";
      write(i, width, height);
    }
    json << "]}";
  }
  const std::string& path() const { return folder_.path(); }
  std::string image(int light) const {
    return folder_ / ("olat/00" + std::to_string(light) + ".exr");
  }
  /// The value of channel c at x of the images, everywhere the same along y.
  static float value(int light, int x, int c) {
    return static_cast<float>((light + 1) * (x % 8) + c) / 64;
  }
  void write(int light, int width, int height) const {
    Imf::Array2D<Imf::Rgba> pixels(height, width);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        pixels[y][x] = Imf::Rgba(value(light, x, 0), value(light, x, 1), value(light, x, 2));
    Imf::RgbaOutputFile file(image(light).c_str(), width, height, Imf::WRITE_RGB);
    file.setFrameBuffer(&pixels[0][0], 1, static_cast<size_t>(width));
    file.writePixels(height);
  }

 private:
  TemporaryFolder folder_;
};

TEST(LightStageTestSrc, PlaysFolders) {
  const Folder folder(5);
  const LightProgram program = light_program("static:5", 60);
  const std::string line = "is-live=false gain=1.25 location=" + folder.path();  // factor 1
  const LineResult shots =
      run_line("lightstagetestsrc program=static " + line +
                   " ! video/x-raw,format=RGBA64_LE,colorimetry=(string)1:1:1:1"
                   " ! appsink name=out sync=false",
               120);
  ASSERT_EQ(shots.frames.size(), program.triggers().value()) << shots.first_error();
  EXPECT_EQ(GST_VIDEO_INFO_WIDTH(&shots.info), 24);
  EXPECT_EQ(GST_VIDEO_INFO_HEIGHT(&shots.info), 20);
  for (size_t step = 0; step < program.steps.size(); ++step) {
    const auto frame = samples(shots.frames[step + LightProgram::kMarkerSteps]);
    const auto colors = program.colors(program.steps[step]);
    for (int x = 0; x < 24; ++x)
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (int l = 0; l < 5; ++l)
          sum += double{colors[static_cast<size_t>(l)][static_cast<size_t>(c)]} *
                 double{Folder::value(l, x, c)};
        ASSERT_NEAR(frame[static_cast<size_t>(4 * x + c)], std::min(1.0, sum) * 65535, 2);
      }
  }
}

TEST(LightStageTestSrc, InvalidFoldersAreErrors) {
  expect_contains(error_of("location=/no/such/folder"), "an OLAT folder has lights.json");
  {
    const Folder folder(3);
    const std::string location = "location=" + folder.path();
    expect_contains(error_of("program=performance:4 " + location),
                    "program=performance or program=static");
    // The images have another size: nothing can be agreed on.
    expect_contains(error_of(location, "width=100"), "Internal data stream error");
    std::ofstream(folder.path() + "/lights.json") << "{\"directions\": [[0, 0, 2]]}";
    expect_contains(error_of(location), "not a unit vector");
    std::ofstream(folder.path() + "/lights.json") << "{\"directions\": [[0, 0";
    expect_contains(error_of(location), "is not valid JSON at line 1, column");
    std::ofstream(folder.path() + "/lights.json") << "{\"directions\": [[0, 0, \"x\"]]}";
    expect_contains(error_of(location), "no direction of three numbers");
    std::ofstream(folder.path() + "/lights.json") << "[1]";
    expect_contains(error_of(location), "has no \"directions\"");
  }
  {
    const Folder folder(3);
    fs::resize_file(folder.image(2), fs::file_size(folder.image(2)) / 2);
    expect_contains(error_of("location=" + folder.path()), "002.exr cannot be read as OpenEXR");
    fs::remove(folder.image(2));
    expect_contains(error_of("location=" + folder.path()), "002.exr cannot be read: No such file");
    folder.write(2, 25, 20);
    expect_contains(error_of("location=" + folder.path()),
                    "002.exr is 25x20, the first image 24x20");
  }
}

}  // namespace
}  // namespace inverse::testing
