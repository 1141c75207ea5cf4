// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/depth/volume.hpp"
#include "tests/depth/kernels/scene.hpp"
#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {

inline Lens lens_of(const Camera& camera) {
  return {float(camera.fx), float(camera.fy), float(camera.cx), float(camera.cy)};
}
inline Extent extent_of(const Camera& camera) {
  return {uint32_t(camera.width), uint32_t(camera.height)};
}

inline Pose host_pose(const Camera& camera) {
  Pose pose;
  for (size_t c = 0; c < 4; ++c) pose.rotation[c] = float(camera.rotation[c]);
  for (size_t c = 0; c < 3; ++c) pose.place[c] = float(camera.place[c]);
  return pose;
}

inline Pixels to_pixels(const reference::Plane& plane) {
  Pixels pixels;
  for (const auto& p : plane.data)
    for (const double v : p) pixels.push_back(float(v));
  return pixels;
}

class VolumeFixture : public GpuTest {
 protected:
  gpu::BufferPtr pose_of(const Camera& camera) {
    Pixels values;
    for (const double v : camera.rotation) values.push_back(float(v));
    for (const double v : camera.place) values.push_back(float(v));
    values.push_back(0);
    return upload(values);
  }
  void integrate(Volume& volume, const Camera& camera, const reference::Plane& surface,
                 const reference::Plane& layers) {
    Pixels depth;
    for (const auto& p : surface.data) depth.push_back(float(p[3]));
    const Volume::Frame frame{lens_of(camera), extent_of(camera), pose_of(camera),
                              upload(gpu::Element::scalar, depth.data(), depth.size()),
                              upload(to_pixels(surface))};
    const auto colors = upload(to_pixels(layers));
    run([&](gpu::Commands& commands) { volume.record_integrate(commands, frame, colors, {}); });
  }
  std::vector<uint32_t> words(const gpu::BufferPtr& buffer) {
    const Pixels floats = download(buffer);
    std::vector<uint32_t> result(floats.size());
    memcpy(result.data(), floats.data(), 4 * floats.size());
    return result;
  }
};

}  // namespace inverse::testing
