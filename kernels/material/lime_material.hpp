#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/material/estimate/material_fusion.hpp"
#include "kernels/material/light/light_history.hpp"
#include "kernels/material/networks/lime_models.hpp"
#include "kernels/material/networks/lime_networks.hpp"
#include "kernels/material/networks/network_schedule.hpp"
#include "kernels/material/object/crop_change.hpp"
#include "kernels/material/object/object_tracker.hpp"

namespace inverse {

/// Live material estimation (thesis chapter 6): the mask of the object in front of the camera, its
/// specular and mirror layers, and its diffuse and specular albedo and shininess.
///
/// What a frame's mask says is known when the frame is done on the device (`done`), so that the
/// square that is looked at, and the material, follow by as many frames as are in flight. Where the
/// last frame that is done had no object, SegmentationNet runs alone; so it does where an object
/// rests and its material is known, but for one frame in `recheck`; and where the picture rests as
/// well, not even that. Where layers or the light are asked for an object whose picture changes
/// does not rest.
class LimeMaterial {
 public:
  struct Params {
    MaterialFusion::Params fusion;
    uint32_t recheck =
        8;  ///< a resting object with a steady material is looked at every so many frames
    float steady = 0.02F;       ///< MaterialFusion::steady's limit, below which a material is known
    bool adaptive = true;       ///< whether anything is left out at all
    bool layers_asked = false;  ///< whether layers go out with the frame, drawn for it or before
    bool light_asked = false;   ///< whether anybody wants to know the light
    ObjectLight::Params light;
  };
  /// What ran for a frame, and what it found; for `stats`.
  struct Report {
    bool segmented = false, estimated = false;
    uint64_t segmentations = 0, estimates = 0;  ///< so far
    const char* skipped = "";                   ///< what was left out, and why
  };
  /// What is known of the object now.
  struct Object {
    bool found = false;
    Material material;      ///< all zero until there is an estimate
    Material latest;        ///< the last estimate alone
    uint64_t averaged = 0;  ///< estimates in the material; none with the frame in which it is found
    float spread = 0;
    float share = 0;  ///< of the square that was looked at
    ObjectTracker::Box box;
    /// Whether its material is.
    bool known() const { return found && averaged > 0; }
  };

  /// For frames of this size. Throws as network::Network.
  LimeMaterial(const std::shared_ptr<gpu::Device>& device, Extent extent, LimeModels models);

  using Layers = LimeNetworks::Layers;
  /// Records the networks that a frame needs. `still`: within `square()` it is, pixel by pixel, the
  /// one before.
  void record(gpu::Commands& commands, const Plane& frame, const Params& params, bool still);
  /// Records drawing the layers of the frame that was recorded last.
  Layers record_layers(gpu::Commands& commands, const Plane& frame);
  /// A frame, by its place in the calls of `record` from 0, is done on the device. In order, each
  /// once.
  void done(uint64_t number);
  /// Forgets the object, its material and all earlier frames; frames in flight are not looked at.
  void reset();

  /// Normals of the frames to come, for the light; null: none are known.
  void set_normal_map(std::shared_ptr<const NormalMap> map) { normal_map_ = std::move(map); }
  /// The light, by the last frame that is done and told of it; null while it is not known, or not
  /// asked for. It stays when the object goes, until another one tells of it.
  const std::shared_ptr<const Environment>& light() const { return light_.light(); }
  /// Views of the object that are in the light.
  uint64_t light_views() const { return light_.views(); }

  /// Runs everything once on a black frame, so that no kernel is built while frames come.
  void warm_up();

  uint64_t recorded() const { return recorded_; }
  /// The square that the next frame is looked at in.
  const Square& square() const { return tracker_.square(); }
  const Object& object() const { return object_; }
  const Report& report(uint64_t number) const { return slot(number).report; }
  /// Bytes of device memory that the networks take.
  uint64_t network_bytes() const { return networks_.bytes(); }
  /// Whether normals were looked for where the object is, for its light, and there are none.
  bool lacks_normals() const { return light_.lacks_normals(); }
  /// Another number where layers, object or light may be others than they were, but for what is
  /// another in the frame itself.
  uint64_t news() const { return news_; }

 private:
  struct Slot {
    gpu::BufferPtr probability, albedo, exponent;  // read back
    gpu::BufferPtr image, codes;                   // the same, made when needed
    std::vector<uint8_t> left_out;                 // by points, what the tracker calls foreign
    gpu::BufferPtr foreign;                        // the same on the device, made when needed
    Square square;
    NetworkSchedule::Plan plan;
    Report report;
    Params params;
    uint64_t epoch = 0;
  };
  const Slot& slot(uint64_t number) const { return slots_[number]; }
  bool finds_light(const Params& params) const;
  NetworkSchedule::Known known(const Params& params, bool still) const;
  void look(gpu::Commands& commands, const Plane& frame, Slot& slot);
  void estimate(gpu::Commands& commands, Slot& slot);
  static void read_back(gpu::Commands& commands, const gpu::BufferPtr& source,
                        gpu::BufferPtr& copy);
  void take_light(const Slot& slot);
  void compare(const Slot& slot);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  LimeNetworks networks_;
  gpu::FrameRing<Slot> slots_;

  ObjectTracker tracker_;
  MaterialFusion fusion_;
  Material latest_;
  Object object_;
  Square estimated_in_;       // the square that the networks' results are of
  bool have_layers_ = false;  // of the object, from some frame since the last reset
  CropChange change_;         // since the frame that they are of
  CropChange::Difference changed_;
  NetworkSchedule schedule_;
  uint64_t recorded_ = 0, epoch_ = 0, news_ = 0;
  uint64_t segmentations_ = 0, estimates_ = 0;  // so far

  LightHistory light_;
  std::shared_ptr<const NormalMap> normal_map_;
};

}  // namespace inverse
