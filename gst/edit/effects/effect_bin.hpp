// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <cstdint>
#include <string>
#include <vector>

#include "gst/base/pads/pads.hpp"
#include "gst/base/property_table.hpp"

namespace inverse {

struct EffectParams {
  enum class Layer : uint8_t { reflectance, shading, direct, indirect, mask };
  Layer layer = Layer::shading;
  std::string effect;
  std::string decomposer = "intrinsicdecomp";
  float strength = 1;
  bool use_mask = true;
};

/// The work behind intrinsicedit, a bin:
///
///   sink → tee → split → effect → merge → src        layers in, layers out
///            └────→ queue ─────────↗
///   sink → decomposer → tee … merge → compose → src  frames in, frames out
///
/// The caps that come in decide which. Without an effect everything passes.
class EffectBin final : public PropertyStore {
 public:
  explicit EffectBin(GstBin* bin);
  EffectBin(const EffectBin&) = delete;
  EffectBin& operator=(const EffectBin&) = delete;

  static const PropertyTable<EffectParams>& table();
  PropertyStore& parameters() { return *this; }
  /// Those of intrinsicmerge.
  GstStructure* stats() const;

  /// READY → PAUSED: links the effect; posts one error and returns false if that is not possible.
  bool assemble();
  /// PAUSED → READY, or assemble() failed.
  void dismantle();

  // PropertyStore.
  void install(GObjectClass* object_class, guint first_id, std::string_view child) const override;
  void get(size_t index, GValue* value) const override { parameters_.get(index, value); }
  void set(size_t index, const GValue* value) override;

 private:
  enum class Kind : uint8_t { unknown, layers, frames };

  /// Makes the effect of the property, and notes what is wrong with that.
  void parse_effect();
  void link_effect();
  /// Of the ghost pad `sink`.
  GstPadProbeReturn frame(GstPadProbeInfo* info);
  gboolean event(GstEvent* event);
  gboolean query(GstQuery* query);
  GstCaps* caps(GstCaps* filter) const;
  /// Makes the bin one for layers or for frames, before any. Throws Error.
  void arrange(const GstCaps* caps);
  void add_frame_elements();
  void remove(GstElement*& element);

  GstBin* bin_;
  Parameters<EffectParams> parameters_{table()};
  GstPad *sink_, *src_;                                    // ghost pads
  GstElement *tee_, *split_, *queue_, *merge_;             // children
  GstElement* effect_ = nullptr;                           // child
  GstElement *decomposer_ = nullptr, *compose_ = nullptr;  // children if frames come in
  std::vector<PadPtr> requested_;                          // of the children
  std::string parsed_, wrong_;                             // text of effect_; what is wrong with it
  Kind kind_ = Kind::unknown;
  bool refused_ = false;  // caps, with an error: frames end there
};

}  // namespace inverse
