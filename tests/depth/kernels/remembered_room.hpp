// SPDX-License-Identifier: LGPL-2.1-or-later
// A scene that some frames were added to, for what works on layers with one.
#pragma once
#include "kernels/camera/seen_scene.hpp"
#include "tests/depth/kernels/volume_fixture.hpp"

namespace inverse::testing {

class RememberedRoom : public VolumeFixture {
 protected:
  static constexpr Volume::Params kParams{.voxel = 0.02F, .blocks = 8192};
  inline static const Camera kCamera = camera_at(64, 48, {0.1, 0.25, 0.05}, {-0.1, 0.6, 2});

  void SetUp() override {
    VolumeFixture::SetUp();
    volume_.emplace(device, kParams);
    for (int i = 0; i < 4; ++i) {
      const double t = 0.4 * i;
      const Camera camera =
          camera_at(160, 120, {0.5 * std::sin(t) - 0.2, 0.2, 0.15 * std::cos(t)}, {-0.2, 0.6, 2});
      const Seen seen = look(camera);
      const reference::Plane surface = reference::normals(camera, seen.depth);
      integrate(*volume_, camera, surface, seen.layers);
      expected_.allocate(camera, surface);
      expected_.integrate(camera, surface, seen.layers);
    }
    surface_ = seen_by(kCamera);
  }

  Pixels seen_by(const Camera& camera) {
    Volume::View view(device, extent_of(camera));
    const auto pose = pose_of(camera);
    run([&](gpu::Commands& commands) {
      volume_->record_march(commands, lens_of(camera), pose, view);
    });
    return download(view.surface);
  }
  std::shared_ptr<SeenScene> scene(const Camera& camera, const Pixels& surface,
                                   const Volume& volume, bool found = true) {
    Pixels pose = download(pose_of(camera));
    pose.insert(pose.end(), {found ? 1.F : 0.F, 0, 0, 0});
    const Extent extent = extent_of(camera);
    return std::make_shared<SeenScene>(SeenScene{.extent = extent,
                                                 .lens = lens_of(camera),
                                                 .surface = shared_plane(extent, surface),
                                                 .pose = shared_plane({3, 1}, pose),
                                                 .table = volume.table(),
                                                 .voxels = volume.voxels(),
                                                 .table_mask = volume.table_mask(),
                                                 .voxel = kParams.voxel,
                                                 .truncation = kParams.truncation * kParams.voxel});
  }

  std::optional<Volume> volume_;
  reference::Volume expected_{double{kParams.voxel},
                              double{kParams.truncation * kParams.voxel},
                              double{kParams.max_depth},
                              double{kParams.memory},
                              {}};
  Pixels surface_;  // what kCamera sees
};

}  // namespace inverse::testing
