#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "kernels/material/object/crop_change.hpp"
#include "kernels/material/object/object_tracker.hpp"
#include "object_light.hpp"

namespace inverse {

/// The light around the followed object, from frame to frame: which views of it are of one light,
/// how much that has changed, and what is known of it. Knows no device.
class LightHistory {
 public:
  /// What is taken from now on is of another light; the one before stays known until then.
  void begin();
  /// Nothing is known any more.
  void forget();
  /// The object rests here. Elsewhere than before other light falls on it: however often it was
  /// seen where it was and on its way, that is one view.
  void rest(const ObjectTracker::Box& here);
  /// Takes a view of the object, which is here and of this material; `anew`: those before are of
  /// another light. The rest as ObjectLight::add and light.
  void take(const ObjectLight::View& view, const ObjectTracker::Box& here, bool anew,
            const NormalMap* map, const Material& material, const ObjectLight::Params& params);
  /// Lamps that fade change little from one estimate to the next: compares the picture (as
  /// CropChange's) with the one since which this light falls, or the object rests. `begins`: that
  /// is this one; `in_place`: the object has not moved since the last look.
  void compare(std::span<const float> image, std::span<const uint8_t> mask, uint32_t side,
               bool begins, bool in_place);

  /// The light; null while it is not known.
  const std::shared_ptr<const Environment>& light() const { return known_; }
  uint64_t views() const { return light_.views(); }
  bool lacks_normals() const { return light_.lacks_normals(); }
  /// What compare found; none: the object moves.
  std::optional<CropChange::Difference> changed() const;
  /// Whether there is a picture that compare compares with.
  bool watched() const { return change_.kept(); }

 private:
  ObjectLight light_;
  std::optional<ObjectTracker::Box> at_;  // where it began, or the object came to rest since
  std::shared_ptr<const Environment> known_;
  CropChange change_;
  CropChange::Difference changed_;
};

}  // namespace inverse
