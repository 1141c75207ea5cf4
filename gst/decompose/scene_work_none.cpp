// SPDX-License-Identifier: LGPL-2.1-or-later
// A build without depth (-Ddepth=disabled).
#include "gst/inverse/inverse_depth_meta.h"
#include "scene_work.hpp"

namespace inverse {
namespace {

class NoScene final : public SceneWork {
 public:
  void configure(const std::shared_ptr<gpu::Device>& /*device*/) override {}
  void release() override { warned_ = false; }
  const KnownReflectance* recall(FrameContext& frame, uint64_t /*number*/,
                                 const SceneParams& /*params*/, const Wanted& /*wanted*/) override {
    if (!warned_ && frame.in && gst_buffer_get_inverse_depth_meta(frame.in)) {
      warned_ = true;
      frame.warnings.emplace_back(
          "frames carry depth, but gst-inverse was built without it; build it with "
          "-Ddepth=enabled");
    }
    return nullptr;
  }
  const SeenStrokes* seen() const override { return nullptr; }
  std::optional<SceneView> view(uint64_t /*number*/) const override { return {}; }
  std::optional<Touch> touch(uint64_t /*number*/) const override { return {}; }
  bool began() const override { return false; }
  std::vector<Stroke> take_loaded() override { return {}; }
  void remember(FrameContext& /*frame*/) override {}
  void forget() override {}
  void save(const std::string& /*path*/) override {}
  bool requested() const override { return false; }
  void ended(const std::string& /*location*/) override {}
  void describe(GstStructure* /*stats*/, uint64_t /*number*/) const override {}

 private:
  bool warned_ = false;
};

}  // namespace

const bool kHasScene = false;

std::unique_ptr<SceneWork> make_scene_work() { return std::make_unique<NoScene>(); }

}  // namespace inverse
