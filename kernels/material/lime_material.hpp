// SPDX-License-Identifier: LGPL-2.1-or-later
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

/// Live material estimation (thesis chapter 6): mask of the object in front of the camera, its
/// specular and mirror layers, and its diffuse albedo, specular albedo and shininess.
///
/// A frame's mask is known when the device has finished the frame (`done`), so the analyzed square
/// and the material lag by the number of frames in flight. Without an object in the last finished
/// frame, only SegmentationNet runs. The same holds while an object rests and its material is
/// known, except for one frame in `estimate_interval`; if the image is unchanged as well, no
/// network runs. If layers or the light are requested, an object whose image changes does not count
/// as resting.
class LimeMaterial {
 public:
  struct Params {
    MaterialFusion::Params fusion;
    /// Frames between searches of a resting object whose material is known.
    uint32_t estimate_interval = 8;
    /// Limit of MaterialFusion::converged below which a material is known.
    float converged_error = 0.02F;
    bool adaptive = true;       ///< false: skip nothing
    bool layers_asked = false;  ///< layers are output with the frame
    bool light_asked = false;   ///< the light is requested
    ObjectLight::Params light;
  };
  /// Networks that ran for a frame and their results; for `stats`.
  struct Report {
    bool segmented = false, estimated = false;
    uint64_t segmentations = 0, estimates = 0;  ///< total
    const char* skipped = "";                   ///< skipped work and the reason
  };
  /// What is known of the object now.
  struct Object {
    bool found = false;
    Material material;      ///< zero before the first estimate
    Material latest;        ///< the last estimate alone
    uint64_t averaged = 0;  ///< estimates in the material; 0 for the frame in which the object is
                            ///< found
    float spread = 0;
    float share = 0;  ///< of the analyzed square
    ObjectTracker::Box box;
    /// Whether the object's material is known.
    bool known() const { return found && averaged > 0; }
  };

  /// For frames of this size. Throws as network::Network.
  LimeMaterial(const std::shared_ptr<gpu::Device>& device, Extent extent, LimeModels models);

  using Layers = LimeNetworks::Layers;
  /// Records the networks that a frame needs. `unchanged`: its pixels within `square()` are.
  void record(gpu::Commands& commands, const Plane& frame, const Params& params, bool unchanged);
  /// Records drawing the layers of the last recorded frame.
  Layers record_layers(gpu::Commands& commands, const Plane& frame);
  /// Reports that the device has finished a frame, by its index in the calls of `record` from 0.
  /// Call it once per frame, in order.
  void done(uint64_t number);
  /// Discards the object, its material and all earlier frames; frames in flight are ignored.
  void reset();

  /// Normals of the following frames, for the light; null: none.
  void set_normal_map(std::shared_ptr<const NormalMap> map) { normal_map_ = std::move(map); }
  /// The light according to the last finished frame that updated it; null if unknown or not
  /// requested. It stays when the object leaves, until another object updates it.
  const std::shared_ptr<const Environment>& light() const { return light_.light(); }
  /// Number of views of the object in the light.
  uint64_t light_views() const { return light_.views(); }

  uint64_t recorded() const { return recorded_; }
  /// The square that the next frame is analyzed in.
  const Square& square() const { return tracker_.square(); }
  const Object& object() const { return object_; }
  const Report& report(uint64_t number) const { return slot(number).report; }
  /// Bytes of device memory of the networks.
  uint64_t network_bytes() const { return networks_.bytes(); }
  /// Whether normals for the object's light were looked up and are missing.
  bool lacks_normals() const { return light_.lacks_normals(); }
  /// Changes whenever layers, object or light may have changed for a reason other than the frame's
  /// content.
  uint64_t message_count() const { return message_count_; }

 private:
  struct Slot {
    gpu::BufferPtr probability, albedo, exponent;  // read back
    gpu::BufferPtr image, codes;                   // the same, made when needed
    std::vector<uint8_t> foreign_mask;             // by points, what the tracker calls foreign
    gpu::BufferPtr foreign;                        // the same on the device, made when needed
    Square square;
    NetworkSchedule::Plan plan;
    Report report;
    Params params;
    uint64_t epoch = 0;
  };
  const Slot& slot(uint64_t number) const { return slots_[number]; }
  bool finds_light(const Params& params) const;
  NetworkSchedule::Known known(const Params& params, bool unchanged) const;
  void find_object(gpu::Commands& commands, const Plane& frame, Slot& slot);
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
  uint64_t recorded_ = 0, epoch_ = 0, message_count_ = 0;
  uint64_t segmentations_ = 0, estimates_ = 0;  // so far

  LightHistory light_;
  std::shared_ptr<const NormalMap> normal_map_;
};

}  // namespace inverse
