// SPDX-License-Identifier: LGPL-2.1-or-later
// The room against its specification.
#include "kernels/depth/virtual_room/virtual_room.hpp"

#include "tests/depth/kernels/volume_fixture.hpp"
#include "tests/depth/reference/virtual_room.hpp"

namespace inverse::testing {
namespace {

Vec3 wide(const std::array<float, 3>& v) { return {double{v[0]}, double{v[1]}, double{v[2]}}; }

reference::Room specified(const RoomScene& scene) {
  reference::Room room{.solids = {}, .lamps = {}, .ambient = double{scene.ambient}};
  for (const Solid& s : scene.solids)
    room.solids.push_back({static_cast<reference::RoomSolid::Kind>(s.kind), wide(s.center),
                           wide(s.half_size), double{s.turn},
                           static_cast<reference::RoomSolid::Paint>(s.paint), double{s.side},
                           wide(s.color), wide(s.other)});
  for (const RoomLamp& lamp : scene.lamps)
    room.lamps.push_back({wide(lamp.place), double{lamp.power}});
  return room;
}

Camera camera_of(const Pose& pose, const Lens& lens, Extent extent) {
  Camera camera{double{lens.fx}, double{lens.fy},   double{lens.cx},
                double{lens.cy}, int(extent.width), int(extent.height)};
  for (size_t c = 0; c < 4; ++c) camera.rotation[c] = double{pose.rotation[c]};
  for (size_t c = 0; c < 3; ++c) camera.place[c] = double{pose.place[c]};
  return camera;
}

class VirtualRoomTest : public VolumeFixture {};

TEST_F(VirtualRoomTest, AgreesWithSpecification) {
  const RoomScene scene = furnished_room();
  VirtualRoom room(device, scene);
  reference::Room expected = specified(scene);
  const Extent extent{80, 60};
  const Lens lens = room_lens(extent);
  struct Case {
    RoomPath path;
    double seconds;
    HandTarget target = HandTarget::none;
  };
  for (const auto& [path, seconds, target] :
       {Case{RoomPath::orbit, 1}, Case{RoomPath::orbit, 13}, Case{RoomPath::wall, 3},
        Case{RoomPath::table, 3.5, HandTarget::ball}, Case{RoomPath::table, 8, HandTarget::book}}) {
    const Camera camera = camera_of(room_pose(path, seconds), lens, extent);
    const Hand hand = room_hand(target, room_pose(path, seconds), seconds);
    expected.hand.clear();
    for (const HandPart& part : hand.parts)
      expected.hand.push_back(
          {wide(part.from), wide(part.to), double{part.radius}, wide(part.color)});
    const auto layers = buffer(extent.pixels()), truth = buffer(extent.pixels()),
               pose = pose_of(camera);
    run([&](gpu::Commands& commands) {
      room.record(commands, lens, extent, pose, 1, layers, truth, hand.parts);
    });
    const Pixels seen = download(layers), found = download(truth);
    size_t depth = 0, paint = 0, light = 0, on_hand = 0;
    for (size_t n = 0; n < extent.pixels(); ++n) {
      const auto x = double(n % extent.width), y = std::floor(double(n) / extent.width);
      const reference::Room::Seen meant =
          expected.look(camera.place, camera.turned(camera.ray(x, y)));
      depth += std::abs(double{seen[4 * n + 3]} - meant.along) < 1e-3;
      on_hand += meant.solid >= scene.solids.size();
      double off = 0, sum = 0;
      for (size_t c = 0; c < 3; ++c) {
        off = std::max(off, std::abs(double{found[4 * n + c]} - meant.reflectance[c]));
        sum = std::max(sum, std::abs(double{seen[4 * n + c]} -
                                     double{found[4 * n + c]} * double{found[4 * n + 3]}));
      }
      paint += off < 1e-4;
      EXPECT_LT(sum, 1e-5);
      // Openness is interpolated between places of a face.
      light += std::abs(double{found[4 * n + 3]} - meant.direct -
                        expected.ambient * meant.openness) < 0.1 * expected.ambient;
    }
    // Edges of solids, paint and shadows fall between pixels differently.
    EXPECT_GT(depth, extent.pixels() * 99 / 100);
    EXPECT_GT(paint, extent.pixels() * 98 / 100);
    EXPECT_GT(light, extent.pixels() * 93 / 100);
    EXPECT_EQ(on_hand > extent.pixels() / 50, target != HandTarget::none) << on_hand;
  }
}

TEST_F(VirtualRoomTest, SensorHasTheNoiseAndHolesOfItsModel) {
  const VirtualRoom room(device, furnished_room());
  const Extent extent{200, 100};
  // A wall at 2 m in front of one at 3 m; a quarter of its paint is black.
  Pixels layers(4 * extent.pixels()), truth(4 * extent.pixels(), 0.5F);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    const size_t x = n % extent.width, y = n / extent.width;
    layers[4 * n + 3] = x < 100 ? 2 : 3;
    if (x < 100 && y < 50) truth[4 * n] = truth[4 * n + 1] = truth[4 * n + 2] = 0;
  }
  const auto layer_buffer = upload(layers), truth_buffer = upload(truth),
             depth = gpu::Buffer::create(device, gpu::Element::scalar, extent.pixels());
  const auto measured = [&](const VirtualRoom::Sensor& sensor, uint32_t frame) {
    run([&](gpu::Commands& commands) {
      room.record_sensor(commands, extent, layer_buffer, truth_buffer, sensor, frame, depth);
    });
    return download(depth);
  };
  const Pixels exact = measured({.noise = 0, .max_depth = 2.5F}, 0), noisy = measured({}, 0);
  double near = 0, far = 0, near_square = 0, far_square = 0, edges = 0, lost = 0;
  for (size_t n = 0; n < extent.pixels(); ++n) {
    const size_t x = n % extent.width, y = n / extent.width;
    const double z = layers[4 * n + 3], found = noisy[n];
    EXPECT_EQ(exact[n], z < 2.5 ? layers[4 * n + 3] : 0);
    if (x == 99 || x == 100) {
      if (y < 50) continue;
      ++edges;
      lost += found == 0;
    } else if (x < 100 && y < 50) {
      EXPECT_EQ(found, 0) << "black";
    } else {
      const double steps = 580 * 0.075 / found / 0.125;
      EXPECT_NEAR(steps, std::round(steps), 1e-2);
      (z < 2.5 ? near : far) += 1;
      (z < 2.5 ? near_square : far_square) += (found - z) * (found - z);
    }
  }
  EXPECT_NEAR(lost / edges, 0.6, 0.15);
  // The noise and that of rounding to steps of z² / (8 B).
  const auto expected = [](double z) {
    const double noise = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4), step = z * z / (8 * 580 * 0.075);
    return std::sqrt(noise * noise + step * step / 12);
  };
  EXPECT_NEAR(std::sqrt(near_square / near), expected(2), 0.05 * expected(2));
  EXPECT_NEAR(std::sqrt(far_square / far), expected(3), 0.05 * expected(3));
  EXPECT_EQ(measured({}, 0), noisy);
  EXPECT_NE(measured({}, 1), noisy);
}

TEST_F(VirtualRoomTest, PathsReturnAndStayInside) {
  for (const RoomPath path : {RoomPath::orbit, RoomPath::wall, RoomPath::still, RoomPath::table}) {
    const Pose first = room_pose(path, 0), last = room_pose(path, kPathPeriod);
    for (size_t c = 0; c < 4; ++c) {
      EXPECT_NEAR(double{first.place[c]}, double{last.place[c]}, 1e-5);
      EXPECT_NEAR(std::abs(double{first.rotation[c]}), std::abs(double{last.rotation[c]}), 1e-5);
    }
    for (int quarter = 0; quarter < 4 * int(kPathPeriod); ++quarter) {
      const Pose pose = room_pose(path, 0.25 * quarter);
      EXPECT_LT(std::abs(double{pose.place[0]}), 2.2);
      EXPECT_LT(std::abs(double{pose.place[2]}), 1.9);
      double square = 0;
      for (const float q : pose.rotation) square += double{q} * double{q};
      EXPECT_NEAR(square, 1, 1e-5);
    }
  }
}

// It touches what it is to touch, from outside, and is elsewhere at other times.
TEST(HandTest, TouchesItsTarget) {
  const RoomScene scene = furnished_room();
  EXPECT_TRUE(room_hand(HandTarget::none, {}, 3).parts.empty());
  for (const HandTarget target : {HandTarget::ball, HandTarget::dark_ball, HandTarget::box,
                                  HandTarget::book, HandTarget::table, HandTarget::print}) {
    const RoomPath path = target == HandTarget::print ? RoomPath::wall : RoomPath::table;
    for (double t = 0; t < kHandPeriod; t += 0.1) {
      const Pose camera = room_pose(path, t);
      const Hand hand = room_hand(target, camera, t);
      const float free = clearance(scene, hand.parts);
      if (hand.touches) {
        EXPECT_LT(free, 1e-3F) << int(target) << " " << t;
        const HandPart& finger = hand.parts[0];
        EXPECT_NEAR(clearance(scene, {finger}), 0, 1e-3) << "the finger does";
        EXPECT_GT(clearance(scene, {hand.parts.begin() + 1, hand.parts.end()}), 0.005F)
            << int(target) << " " << t << ": nothing else does";
        double square = 0;
        for (size_t c = 0; c < 3; ++c)
          square += std::pow(double{finger.from[c] - hand.contact[c]}, 2);
        EXPECT_NEAR(std::sqrt(square), double{kFingerRadius}, 1e-4);
      } else if (t < 2.7 || t > 4.6) {
        EXPECT_GT(free, 0.03F) << int(target) << " " << t;
      }
      if (t > 0.4) continue;
      for (const HandPart& part : hand.parts)
        for (const auto& end : {part.from, part.to}) {
          const auto p = to_camera(camera, end);
          EXPECT_TRUE(p[2] < 0.05F || std::abs(p[0]) > p[2] || std::abs(p[1]) > p[2])
              << "out of sight";
        }
    }
  }
}

}  // namespace
}  // namespace inverse::testing
