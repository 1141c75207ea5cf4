// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "kernels/material/object/crop_change.hpp"
#include "kernels/material/object/object_tracker.hpp"
#include "object_light.hpp"

namespace inverse {

/// Estimates the light around the tracked object from frame to frame: decides which views share a
/// light, measures its change, and fits it. Does not use the device.
class LightHistory {
 public:
  /// Later views belong to a new light; the present estimate stays valid until then.
  void begin();
  /// Discards the estimate.
  void forget();
  /// The object rests here. The light may differ from that at another position: all views before
  /// count as one.
  void rest(const ObjectTracker::Box& here);
  /// Adds a view of the object at this position with this material. `restart`: earlier views belong
  /// to another light. Other arguments as in ObjectLight::add and light.
  void take(const ObjectLight::View& view, const ObjectTracker::Box& here, bool restart,
            const std::shared_ptr<const NormalMap>& map, const Material& material,
            const ObjectLight::Params& params);
  /// Detects slowly changing lamps: compares the image (as CropChange) with the first one under
  /// this light or since the object came to rest. `begins`: this is that first image; `in_place`:
  /// the object has not moved since the last analysis.
  void compare(std::span<const float> image, std::span<const uint8_t> mask, uint32_t side,
               bool begins, bool in_place);

  /// The light; null before it is known.
  const std::shared_ptr<const Environment>& light() const { return known_; }
  uint64_t views() const { return light_.views(); }
  bool lacks_normals() const { return light_.lacks_normals(); }
  /// Result of the last `compare`; empty: the object moves.
  std::optional<CropChange::Difference> changed() const;
  /// Whether there is a reference image for `compare`.
  bool watched() const { return change_.kept(); }

 private:
  ObjectLight light_;
  std::optional<ObjectTracker::Box> at_;  // where it began, or the object came to rest since
  std::shared_ptr<const Environment> known_;
  CropChange change_;
  CropChange::Difference changed_;
};

}  // namespace inverse
