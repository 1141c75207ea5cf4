// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "hand.hpp"
#include "kernels/camera/camera.hpp"
#include "kernels/depth_virtual_room_open.spv.hpp"
#include "kernels/depth_virtual_room_room.spv.hpp"
#include "kernels/depth_virtual_room_sensor.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// A painted box or ball, or the room itself (room.glsl). Meters; x right, y down, z forward.
struct Solid {
  enum class Kind : uint8_t { box, ball, inside };
  enum class Paint : uint8_t { plain, checker, stripes, rings, letters };
  Kind kind = Kind::box;
  std::array<float, 3> center{};
  std::array<float, 3> half_size{};  ///< of a ball its radius, three times
  float turn = 0;                    ///< about y, radians
  Paint paint = Paint::plain;
  float side = 0.1F;                      ///< of a square of the paint
  std::array<float, 3> color{}, other{};  ///< reflectance, linear
};

struct RoomLamp {
  std::array<float, 3> place{};
  float power = 1;  ///< irradiance / pi at 1 m
};

/// A scene: the first solid is the room.
struct RoomScene {
  std::vector<Solid> solids;
  std::vector<RoomLamp> lamps;
  float ambient = 0.35F;  ///< irradiance / pi where nothing occludes
};

/// A furnished room with paint of many values: prints, checkers, stripes, dark and bright
/// furniture.
RoomScene furnished_room();

/// How the camera of the room moves.
enum class RoomPath : uint8_t {
  orbit,  ///< around the table, once in kPathPeriod, and back to where it began
  wall,   ///< along a flat wall with pictures, and back
  still,
  table,  ///< at the table, in reach of its things, swaying by some centimeters
};
constexpr double kPathPeriod = 24;  ///< seconds
Pose room_pose(RoomPath path, double seconds);
/// A lens with a horizontal field of view of 62 degrees.
Lens room_lens(Extent extent);

/// Renders a RoomScene: color, depth and their truth.
class VirtualRoom {
 public:
  /// Computes where ambient light reaches; waits for the device.
  VirtualRoom(const std::shared_ptr<gpu::Device>& device, const RoomScene& scene);
  /// `layers`: linear RGB, and depth in meters along the optical axis; `truth`: reflectance and
  /// shading, means over a pixel. `pose`: two vec4. A pixel is the mean of `side`² rays. `hand`:
  /// what is in the room besides.
  void record(gpu::Commands& commands, const Lens& lens, Extent extent, const gpu::BufferPtr& pose,
              uint32_t side, const gpu::BufferPtr& layers, const gpu::BufferPtr& truth,
              const std::vector<HandPart>& hand = {});

  /// Errors of a depth sensor.
  struct Sensor {
    float noise = 1;      ///< of that of a structured-light sensor; 0: exact
    float max_depth = 8;  ///< meters, beyond which it sees nothing
    uint32_t seed = 1;
  };
  /// `depth`: what it measures, a scalar a pixel, meters, 0 where nothing.
  void record_sensor(gpu::Commands& commands, Extent extent, const gpu::BufferPtr& layers,
                     const gpu::BufferPtr& truth, const Sensor& sensor, uint32_t frame,
                     const gpu::BufferPtr& depth) const;

 private:
  gpu::Program<shaders::depth_virtual_room_room> room_;
  gpu::Program<shaders::depth_virtual_room_sensor> sensor_;
  gpu::BufferPtr scene_, openness_, hand_;
  uint32_t solids_, lamps_;
  float ambient_;
};

}  // namespace inverse
