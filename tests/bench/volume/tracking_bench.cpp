// SPDX-License-Identifier: LGPL-2.1-or-later
// Tracking and fusion of a depth camera: error of its path, and time by part.
//
//   tracking-bench [--frames N] [--size WxH] [--rate FPS] [--noise N] [--voxel M] [--photometric M]
//                  orbit|wall|FOLDER…
//
// orbit and wall are paths in the virtual room (kernels/virtual_room), whose depth has the noise
// and holes of a structured-light sensor, times N. A FOLDER is a recording as desk_rgbd in the
// given data: meta.json, I8/NNN.png and Zkinect/NNN.png; with --noise 0 Z/NNN.png. XX Prints a
// table: root of the mean square distance to the true place (the first pose is given), the largest
// one, that of the last frame, frames in which the camera was lost, and medians of device time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kernels/virtual_room/virtual_room.hpp"
#include "kernels/volume/tracking/tracker.hpp"
#include "tests/bench/metrics/png_file.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/bench/support/timing.hpp"
#include "tests/lab.hpp"

namespace inverse::bench {
namespace {

struct Settings {
  int frames = 240;
  Extent size{320, 240};
  double rate = 30, noise = 1, voxel = 0.01;
  double photometric = double{Tracker::Params{}.photometric};
};

/// What the camera gives: on the device.
struct RgbdFrame {
  gpu::BufferPtr picture, depth, layers;  ///< layers: reflectance and shading
  Pose truth;
};

class Source {
 public:
  virtual ~Source() = default;
  virtual int frames() const = 0;
  virtual Extent extent() const = 0;
  virtual Lens lens() const = 0;
  virtual RgbdFrame frame(const Lab& lab, int n) = 0;
};

gpu::BufferPtr pose_on(const Lab& lab, const Pose& pose) {
  Pixels values(pose.rotation.begin(), pose.rotation.end());
  values.insert(values.end(), pose.place.begin(), pose.place.end());
  return lab.upload(values);
}

class Room final : public Source {
 public:
  Room(const Lab& lab, RoomPath path, const Settings& settings)
      : room_(lab.device(), furnished_room()), path_(path), settings_(settings) {}
  int frames() const override { return settings_.frames; }
  Extent extent() const override { return settings_.size; }
  Lens lens() const override { return room_lens(settings_.size); }
  RgbdFrame frame(const Lab& lab, int n) override {
    const Pose pose = room_pose(path_, n / settings_.rate);
    const uint64_t pixels = extent().pixels();
    const auto at = pose_on(lab, pose);
    RgbdFrame frame{lab.buffer(pixels),
                    gpu::Buffer::create(lab.device(), gpu::Element::scalar, pixels),
                    lab.buffer(pixels), pose};
    lab.run([&](gpu::Commands& commands) {
      room_.record(commands, lens(), extent(), at, 2, frame.picture, frame.layers);
      room_.record_sensor(commands, extent(), frame.picture, frame.layers,
                          {.noise = float(settings_.noise)}, uint32_t(n), frame.depth);
    });
    return frame;
  }

 private:
  VirtualRoom room_;
  RoomPath path_;
  Settings settings_;
};

Pose pose_of(const nlohmann::json& matrix) {
  const auto m = [&](size_t row, size_t column) { return matrix[row][column].get<double>(); };
  // The largest component of the quaternion first, so that its root is far from zero.
  const std::array<double, 4> squares{
      1 + m(0, 0) - m(1, 1) - m(2, 2), 1 - m(0, 0) + m(1, 1) - m(2, 2),
      1 - m(0, 0) - m(1, 1) + m(2, 2), 1 + m(0, 0) + m(1, 1) + m(2, 2)};
  const auto most = size_t(std::max_element(squares.begin(), squares.end()) - squares.begin());
  const double twice = std::sqrt(squares[most]);
  const std::array<std::array<double, 4>, 4> rows{
      {{squares[0], m(0, 1) + m(1, 0), m(0, 2) + m(2, 0), m(2, 1) - m(1, 2)},
       {m(0, 1) + m(1, 0), squares[1], m(1, 2) + m(2, 1), m(0, 2) - m(2, 0)},
       {m(0, 2) + m(2, 0), m(1, 2) + m(2, 1), squares[2], m(1, 0) - m(0, 1)},
       {m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1), squares[3]}}};
  Pose pose;
  for (size_t c = 0; c < 4; ++c) pose.rotation[c] = float(rows[most][c] / (2 * twice));
  for (size_t c = 0; c < 3; ++c) pose.place[c] = float(m(c, 3));
  return pose;
}

class Recording final : public Source {
 public:
  Recording(const std::string& folder, const Settings& settings)
      : folder_(folder), depth_(settings.noise > 0 ? "Zkinect" : "Z") {
    std::ifstream file(folder + "/meta.json");
    if (!file) throw std::runtime_error("no meta.json in " + folder);
    meta_ = nlohmann::json::parse(file);
    while (count_ < settings.frames && std::filesystem::exists(path("I8", count_))) ++count_;
    if (count_ == 0) throw std::runtime_error("no I8/000.png in " + folder);
    const auto& camera = meta_["frames"][0]["camera"];
    extent_ = {camera["width"], camera["height"]};
    lens_ = {camera["fx"], camera["fy"], camera["cx"], camera["cy"]};
  }
  int frames() const override { return count_; }
  Extent extent() const override { return extent_; }
  Lens lens() const override { return lens_; }
  RgbdFrame frame(const Lab& lab, int n) override {
    const Image color = read_png(path("I8", n), true), depth = read_png(path(depth_, n), false);
    Pixels picture, meters;
    const double unit = 1 / meta_["depth_units_per_metre"].get<double>();
    for (size_t i = 0; i < extent_.pixels(); ++i) {
      for (size_t c = 0; c < 3; ++c) picture.push_back(color.data[3 * i + c]);
      picture.push_back(1);
      meters.push_back(
          float(std::round(double(depth.data[i * size_t(depth.channels)]) * 65535) * unit));
    }
    const auto depths =
        gpu::Buffer::create(lab.device(), gpu::Element::scalar, meters.size(), gpu::Memory::upload);
    memcpy(depths->map(), meters.data(), meters.size() * sizeof(float));
    const auto color_on_device = lab.upload(picture);
    return {color_on_device, depths, color_on_device,
            pose_of(meta_["frames"][size_t(n)]["camera"]["cam_to_world_opencv"])};
  }

 private:
  std::string path(const std::string& kind, int n) const {
    char name[16];
    snprintf(name, sizeof name, "/%03d.png", n);
    return folder_ + "/" + kind + name;
  }
  std::string folder_, depth_;
  nlohmann::json meta_;
  int count_ = 0;
  Extent extent_;
  Lens lens_;
};

void follow(const Lab& lab, const std::string& name, Source& source, const Settings& settings) {
  const Extent extent = source.extent();
  const Lens lens = source.lens();
  Volume volume(lab.device(), {.voxel = float(settings.voxel)});
  Tracker tracker(lab.device(), extent);
  const Volume::View view(lab.device(), extent);
  Tracker::Params params;
  params.photometric = float(settings.photometric);
  double squares = 0, most = 0, last = 0;
  int lost = 0;
  std::map<std::string, std::vector<double>> times;
  gpu::Commands commands(lab.device());
  for (int n = 0; n < source.frames(); ++n) {
    const RgbdFrame frame = source.frame(lab, n);
    const auto truth = pose_on(lab, frame.truth);
    commands.begin();
    tracker.record_frame(commands, lens, frame.depth, frame.picture);
    if (n == 0)
      commands.copy(truth, tracker.pose(), truth->bytes());
    else
      tracker.record_align(commands, params);
    commands.stage("tracking");
    volume.record_integrate(
        commands, {lens, extent, tracker.pose(), frame.depth, tracker.surface()}, frame.layers, {});
    commands.stage("fusion");
    volume.record_march(commands, lens, tracker.pose(), view);
    tracker.record_target(commands, view, frame.layers);
    commands.stage("rendering");
    commands.submit();
    commands.wait();
    if (n >= 3)  // kernels are built by then
      for (const auto& stage : commands.stages()) times[stage.name].push_back(stage.milliseconds);
    const Pixels pose = lab.download(tracker.pose());
    double square = 0;
    for (size_t c = 0; c < 3; ++c)
      square += std::pow(double{pose[4 + c]} - double{frame.truth.place[c]}, 2);
    squares += square;
    last = std::sqrt(square);
    most = std::max(most, last);
    lost += n > 0 && lab.download(tracker.found())[0] != 1;
  }
  const Pixels state = lab.download(volume.state());
  uint32_t left = 0;
  memcpy(&left, &state[shaders::volume_list::kFree], sizeof left);
  printf("| %s | %d | %.1f | %.1f | %.1f | %d | %.1f | %.1f | %.1f | %u |\n", name.c_str(),
         source.frames(), 1000 * std::sqrt(squares / source.frames()), 1000 * most, 1000 * last,
         lost, median(times["tracking"]), median(times["fusion"]), median(times["rendering"]),
         volume.params().blocks - left);
  fflush(stdout);
}

int run(int count, char** arguments) {
  Settings settings;
  std::vector<std::string> names;
  const Options options{{"--frames", integer(settings.frames)},
                        {"--rate", number(settings.rate)},
                        {"--noise", number(settings.noise)},
                        {"--voxel", number(settings.voxel)},
                        {"--photometric", number(settings.photometric)},
                        {"--size", {true, [&](const char* value) {
                                      return sscanf(value, "%ux%u", &settings.size.width,
                                                    &settings.size.height) == 2;
                                    }}}};
  if (!read(options, count, arguments, __FILE__, &names)) return 1;
  if (names.empty()) throw std::runtime_error("usage: tracking-bench [options] orbit|wall|FOLDER");
  const Lab lab;
  printf("| | frames | rms mm | max | last | lost | tracking ms | fusion | rendering | blocks |\n");
  printf("|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : names) {
    std::unique_ptr<Source> source;
    if (name == "orbit" || name == "wall")
      source =
          std::make_unique<Room>(lab, name == "orbit" ? RoomPath::orbit : RoomPath::wall, settings);
    else
      source = std::make_unique<Recording>(name, settings);
    follow(lab, std::filesystem::path(name).filename().string(), *source, settings);
  }
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int count, char** arguments) {
  try {
    return inverse::bench::run(count, arguments);
  } catch (const std::exception& error) {
    fprintf(stderr, "tracking-bench: %s\n", error.what());
    return 1;
  }
}
