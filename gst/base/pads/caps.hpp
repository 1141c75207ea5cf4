// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <string>

namespace inverse {

/// What flows through a pad of a filter.
enum class Flow {
  pixels,            ///< ordinary video in system memory or, if built with them, images
                     ///< in memory:VulkanImage
  layers,            ///< buffers with GstInverseLayersMeta
  pixels_or_layers,  ///< either, pixels first
  layers_or_pixels,  ///< either, layers first; an element that works on layers refuses pixels, with
                     ///< an error that says what to insert
};

/// Ordinary video in system memory, of every format that the kernels read and write
/// (video_format.hpp) and any size; the formats of one kind before the others. New reference.
enum class Prefer { color, gray };
GstCaps* pixel_caps(Prefer prefer = Prefer::color);

/// Kinds of layers, as caps name them: reflectance and shading; these, and layers of light; an
/// object's highlights and what is under them; a subject under the two gradients of a light stage.
inline constexpr const char* kIntrinsicLayers = "intrinsic";
inline constexpr const char* kGlobalLayers = "global";
inline constexpr const char* kMaterialLayers = "material";
inline constexpr const char* kGradientLayers = "gradients";
/// Both that have reflectance and shading.
inline constexpr const char* kAnyLayers = "{ intrinsic, global }";
/// All that make up one picture.
inline constexpr const char* kAllLayers = "{ intrinsic, global, material }";

/// Template caps for a pad of this kind; `layers` is one of the kinds above. New reference.
GstCaps* template_caps(Flow flow, const char* layers);

/// The kind of layers of the first of these caps; empty if it has none.
std::string kind_of(const GstCaps* caps);

/// Whether these (fixed) caps carry layers of this kind.
bool carries_kind(const GstCaps* caps, const char* layers);

/// Whether these (fixed) caps carry layers.
bool carries_layers(const GstCaps* caps);

/// Whether these (fixed) caps are of images in memory:VulkanImage.
bool carries_images(const GstCaps* caps);

/// GstBaseTransform::transform_caps for filters: size, frame rate, aspect ratio and the kind of
/// layers stay; format and colorimetry are free, as our own kernels convert. `templates`, which it
/// takes over, are those of the other pad. New reference.
GstCaps* transform_caps(GstCaps* caps, GstCaps* templates, GstCaps* filter);

/// The same for an element that sends layers if layers come, else pixels: the order of `caps`
/// stays.
GstCaps* same_content(GstPadDirection direction, GstCaps* caps, GstCaps* templates,
                      GstCaps* filter);

/// The same caps with layers first: GstBaseTransform lists first what can pass unchanged, which may
/// be pixels that the element refuses. New reference.
GstCaps* prefer_layers(const GstCaps* caps);

/// GstBaseTransform::fixate_caps: takes the kind of memory that the other side lists first, and of
/// the formats there the input's if it is allowed, so that nothing is converted without need, else,
/// if the input has more than eight bits, the nearest to it (nearest_format), else the first. If
/// the output's colorimetry is open, it becomes the input's. Consumes `other`.
GstCaps* fixate_caps(GstCaps* caps, GstCaps* other);

/// Removes mastering display and light level, which describe PQ and HLG, from fixed caps of any
/// other transfer function.
void drop_hdr_metadata(GstCaps* caps);

/// What a caps query's filter, which may be null, leaves of `caps`, in the filter's order. Consumes
/// `caps`.
GstCaps* filter_caps(GstCaps* caps, GstCaps* filter);

/// Caps of both pads, or of none.
class CapsPair {
 public:
  CapsPair() = default;
  ~CapsPair() { set(nullptr, nullptr); }
  CapsPair(const CapsPair&) = delete;
  CapsPair& operator=(const CapsPair&) = delete;

  /// Keeps references.
  void set(GstCaps* in, GstCaps* out);
  bool is(const GstCaps* in, const GstCaps* out) const;
  /// Whether frames of these caps are the same: in their rate and the shape of pixels caps may
  /// differ.
  bool same_frames(const GstCaps* in, const GstCaps* out) const;

 private:
  GstCaps *in_ = nullptr, *out_ = nullptr;
};

}  // namespace inverse
