// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames of depth cameras with known poses, for benchmarks.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernels/camera/camera.hpp"
#include "kernels/depth/memory/scene_memory.hpp"
#include "kernels/depth/virtual_room/hand.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/lab.hpp"

namespace inverse::bench {

struct RgbdSettings {
  int frames = 240;
  Extent size{320, 240};               ///< of the virtual room
  double rate = 30, noise = 1;         ///< of its frames a second; of depth (0: exact)
  int seed = 0;                        ///< 0: the furnished room; else another one, seen later
  int gap = 0;                         ///< after each of its frames 0 to `gap` are lost, at random
  HandTarget hand = HandTarget::none;  ///< what a hand in it touches
  int hand_from = 0;                   ///< the frame at which its time begins
};

/// --frames, --rate, --gap, --noise, --seed and --size, and what `own` are.
Options rgbd_options(RgbdSettings& settings, Options own);

/// What the camera gives: on the device.
struct RgbdFrame {
  gpu::BufferPtr picture, depth;
  gpu::BufferPtr layers;  ///< true reflectance and shading; of a recording the picture
  Pose pose;
  std::vector<float> true_depth;  ///< meters
  Hand hand;
  std::vector<float> bare_depth = {};  ///< true depth without the hand; empty: there is none
};

class RgbdSource {
 public:
  virtual ~RgbdSource() = default;
  virtual int frames() const = 0;
  virtual Extent extent() const = 0;
  virtual Lens lens() const = 0;
  virtual RgbdFrame frame(const Lab& lab, int n) = 0;
};

/// `name`: orbit, wall, table or still, paths in the virtual room (kernels/depth/virtual_room),
/// whose depth has the noise and holes of a structured-light sensor, times `noise`, or with a seed
/// in one with other furniture, paint and lamps, to choose parameters by; or a folder as desk_rgbd
/// in the given data: meta.json, I8/NNN.png, Z/NNN.png and Zkinect/NNN.png, which is its depth
/// unless `noise` is 0.
std::unique_ptr<RgbdSource> open_rgbd(const Lab& lab, const std::string& name,
                                      const RgbdSettings& settings);

/// The depth of a frame in millimeters, as a camera sends it.
std::vector<uint16_t> millimeters_of(const Lab& lab, const RgbdFrame& frame);
/// The same for a memory; refers to `millimeters`.
SceneMemory::Depth depth_of(const std::vector<uint16_t>& millimeters, const RgbdSource& source,
                            const std::optional<Pose>& pose);
/// Shows all frames of a path to a memory, which is given their true layers. Of every 15th one from
/// the second half on calls `score` with its number and what it sees of the scene.
void walk_scene(const Lab& lab, RgbdSource& source, float voxel,
                const std::function<void(int number, const RgbdFrame& frame,
                                         const std::shared_ptr<const SeenScene>& scene)>& score);

/// An option X,Y,Z, meters, that may be given more than once.
Option places(std::vector<std::array<float, 3>>& field);

/// Two vec4 on the device.
gpu::BufferPtr pose_on(const Lab& lab, const Pose& pose);

}  // namespace inverse::bench
