// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rgbd_source.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>
#include <utility>

#include "kernels/depth/virtual_room/virtual_room.hpp"
#include "tests/bench/metrics/png_file.hpp"

namespace inverse::bench {
namespace {

/// The furnished room with other paint, lamps and places of things, and some more on the floor.
RoomScene drawn_room(int seed) {
  std::mt19937 engine(static_cast<unsigned>(seed));
  const auto any = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(engine() % 65536) / 65536;
  };
  const auto color = [&] {
    const float value = std::exp(any(std::log(0.04F), std::log(0.75F))), tint = any(0, 0.8F);
    std::array<float, 3> rgb;
    for (float& c : rgb) c = value * (1 - tint * any(0, 1));
    return rgb;
  };
  RoomScene scene = furnished_room();
  constexpr size_t kTable = 7;  // the room, its floor and a table with four legs
  for (int n = 0; n < 5; ++n) {
    const float height = any(0.05F, 0.3F);
    scene.solids.push_back({n % 2 ? Solid::Kind::ball : Solid::Kind::box,
                            {any(-2, 2), 1.23F - height, any(-1.8F, 1.8F)},
                            {height, height, height},
                            any(0, 3),
                            Solid::Paint::plain,
                            0.1F,
                            {},
                            {}});
  }
  for (size_t i = 0; i < scene.solids.size(); ++i) {
    Solid& solid = scene.solids[i];
    solid.color = color();
    solid.other = color();
    if (i < 2 || (i > 2 && i < kTable)) continue;
    solid.paint = static_cast<Solid::Paint>(engine() % 5);
    solid.side *= solid.side < 0.5F ? any(0.7F, 1.5F) : 0.1F;
    if (i < kTable) continue;
    const bool on_wall = solid.half_size[2] < 0.005F;
    solid.center[0] += any(-0.1F, 0.1F);
    solid.center[on_wall ? 1 : 2] += any(-0.1F, 0.1F);
    if (!on_wall) solid.turn += any(-0.4F, 0.4F);
  }
  for (RoomLamp& lamp : scene.lamps)
    lamp = {{any(-1.7F, 1.7F), any(-1.2F, -0.9F), any(-1.5F, 1.5F)}, any(0.4F, 1.6F)};
  scene.ambient = any(0.15F, 0.45F);
  return scene;
}

class Room final : public RgbdSource {
 public:
  Room(const Lab& lab, RoomPath path, const RgbdSettings& settings)
      : room_(lab.device(), settings.seed ? drawn_room(settings.seed) : furnished_room()),
        path_(path),
        settings_(settings) {
    std::minstd_rand engine(1);
    const double start = settings.seed * kPathPeriod * 0.3;
    for (int n = 0, at = 0; n < settings.frames; ++n) {
      times_.push_back(start + at / settings.rate);
      at += 1 + static_cast<int>(engine() % static_cast<unsigned>(settings.gap + 1));
    }
  }
  int frames() const override { return settings_.frames; }
  Extent extent() const override { return settings_.size; }
  Lens lens() const override { return room_lens(settings_.size); }
  RgbdFrame frame(const Lab& lab, int n) override {
    const Pose pose = room_pose(path_, times_.at(size_t(n)));
    const uint64_t pixels = extent().pixels();
    const auto at = pose_on(lab, pose);
    RgbdFrame frame{lab.buffer(pixels),
                    gpu::Buffer::create(lab.device(), gpu::Element::scalar, pixels),
                    lab.buffer(pixels),
                    pose,
                    {},
                    {}};
    const auto depth_of = [&] {
      std::vector<float> meters;
      const Pixels picture = lab.download(frame.picture);
      for (size_t i = 0; i < pixels; ++i) meters.push_back(picture[4 * i + 3]);
      return meters;
    };
    if (settings_.hand != HandTarget::none && n >= settings_.hand_from) {
      frame.hand = room_hand(settings_.hand, pose, (n - settings_.hand_from) / settings_.rate);
      lab.run([&](gpu::Commands& commands) {
        room_.record(commands, lens(), extent(), at, 1, frame.picture, frame.layers);
      });
      frame.bare_depth = depth_of();
    }
    lab.run([&](gpu::Commands& commands) {
      room_.record(commands, lens(), extent(), at, 2, frame.picture, frame.layers,
                   frame.hand.parts);
      room_.record_sensor(commands, extent(), frame.picture, frame.layers,
                          {.noise = float(settings_.noise)}, uint32_t(n), frame.depth);
    });
    frame.true_depth = depth_of();
    return frame;
  }

 private:
  VirtualRoom room_;
  RoomPath path_;
  RgbdSettings settings_;
  std::vector<double> times_;  // of frames, seconds
};

Pose pose_of(const nlohmann::json& matrix) {
  std::array<double, 12> rows;
  for (size_t i = 0; i < rows.size(); ++i) rows[i] = matrix[i / 4][i % 4].get<double>();
  return pose_of_rows(rows);
}

class Recording final : public RgbdSource {
 public:
  Recording(const std::string& folder, const RgbdSettings& settings)
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
    const Image color = read_png(path("I8", n), true);
    Pixels picture;
    const std::vector<float> meters = meters_of(depth_, n);
    for (size_t i = 0; i < extent_.pixels(); ++i) {
      for (size_t c = 0; c < 3; ++c) picture.push_back(color.data[3 * i + c]);
      picture.push_back(1);
    }
    const auto depths =
        gpu::Buffer::create(lab.device(), gpu::Element::scalar, meters.size(), gpu::Memory::upload);
    memcpy(depths->map(), meters.data(), meters.size() * sizeof(float));
    const auto color_on_device = lab.upload(picture);
    return {color_on_device,   depths,
            color_on_device,   pose_of(meta_["frames"][size_t(n)]["camera"]["cam_to_world_opencv"]),
            meters_of("Z", n), {}};
  }

 private:
  std::vector<float> meters_of(const std::string& kind, int n) const {
    const Image image = read_png(path(kind, n), false);
    const double unit = 1 / meta_["depth_units_per_metre"].get<double>();
    std::vector<float> meters;
    for (size_t i = 0; i < extent_.pixels(); ++i)
      meters.push_back(
          float(std::round(double(image.data[i * size_t(image.channels)]) * 65535) * unit));
    return meters;
  }
  std::string path(const std::string& kind, int n) const {
    char name[24];
    snprintf(name, sizeof name, "/%03d.png", n);
    return folder_ + "/" + kind + name;
  }
  std::string folder_, depth_;
  nlohmann::json meta_;
  int count_ = 0;
  Extent extent_;
  Lens lens_;
};

}  // namespace

Options rgbd_options(RgbdSettings& settings, Options own) {
  own.insert({{"--frames", integer(settings.frames)},
              {"--rate", number(settings.rate)},
              {"--gap", integer(settings.gap)},
              {"--seed", integer(settings.seed)},
              {"--noise", number(settings.noise)},
              {"--size", {true, [&](const char* value) {
                            return sscanf(value, "%ux%u", &settings.size.width,
                                          &settings.size.height) == 2;
                          }}}});
  return own;
}

std::vector<uint16_t> millimeters_of(const Lab& lab, const RgbdFrame& frame) {
  std::vector<uint16_t> millimeters;
  for (const float z : lab.download(frame.depth))
    millimeters.push_back(uint16_t(std::lround(1000 * double{z})));
  return millimeters;
}

SceneMemory::Depth depth_of(const std::vector<uint16_t>& millimeters, const RgbdSource& source,
                            const std::optional<Pose>& pose) {
  return {reinterpret_cast<const std::byte*>(millimeters.data()),
          source.extent().width * sizeof(uint16_t),
          source.extent(),
          0.001F,
          source.lens(),
          pose};
}

void walk_scene(const Lab& lab, RgbdSource& source, float voxel,
                const std::function<void(int number, const RgbdFrame& frame,
                                         const std::shared_ptr<const SeenScene>& scene)>& score) {
  constexpr int kEvery = 15;  // frames
  const Extent extent = source.extent();
  SceneMemory::Params made;
  made.volume.voxel = voxel;
  SceneMemory memory(lab.device(), extent, made);
  gpu::Commands commands(lab.device());
  for (int n = 0; n < source.frames(); ++n) {
    const RgbdFrame frame = source.frame(lab, n);
    const std::vector<uint16_t> depth = millimeters_of(lab, frame);
    commands.begin();
    memory.record_recall(commands, uint64_t(n), depth_of(depth, source, frame.pose),
                         {extent, frame.picture});
    memory.record_remember(commands, {extent, frame.layers});
    const std::shared_ptr<const SeenScene> scene = memory.record_seen(commands);
    commands.submit();
    commands.wait();
    if (2 * n >= source.frames() && n % kEvery == 0) score(n, frame, scene);
  }
}

Option places(std::vector<std::array<float, 3>>& field) {
  return {true, [&field](const char* value) {
            auto& at = field.emplace_back();
            return sscanf(value, "%f,%f,%f", &at[0], &at[1], &at[2]) == 3;
          }};
}

gpu::BufferPtr pose_on(const Lab& lab, const Pose& pose) {
  Pixels values(pose.rotation.begin(), pose.rotation.end());
  values.insert(values.end(), pose.place.begin(), pose.place.end());
  return lab.upload(values);
}

std::unique_ptr<RgbdSource> open_rgbd(const Lab& lab, const std::string& name,
                                      const RgbdSettings& settings) {
  for (const auto& [path, place] : {std::pair("orbit", RoomPath::orbit),
                                    {"wall", RoomPath::wall},
                                    {"table", RoomPath::table},
                                    {"still", RoomPath::still}})
    if (name == path) return std::make_unique<Room>(lab, place, settings);
  return std::make_unique<Recording>(name, settings);
}

}  // namespace inverse::bench
