// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <memory>
#include <optional>
#include <string>

#include "gst/inverse/inverse_material_meta.h"
#include "kernels/environment/environment.hpp"
#include "kernels/environment/lit_sphere.hpp"

namespace inverse {

/// The light on a cloned object: from a file, else from the stream, else of a studio.
class CloneLight {
 public:
  /// Before a stream: reads the file, if one is named. Throws Error as load_environment; `warning`
  /// gets what is misconfigured with the file and does not hinder.
  void start(const std::string& file, std::string& warning);
  /// Lights a sphere that has no light yet.
  void begin(LitSphere& sphere);
  /// Lights it by what comes with a frame, if that is another light. Throws as Environment if
  /// the stream's is none; the one before stays. Returns whether limematerial made a new map in
  /// this frame, also one that is hardly another light.
  bool take(const GstMaterialMeta* meta, LitSphere& sphere);
  /// Takes no map that comes with this frame, nor if it comes again.
  void ignore(const GstMaterialMeta* meta);
  /// Where it is from: "file", "estimate" or "studio".
  const char* from() const { return from_; }

 private:
  struct Unref {
    void operator()(GBytes* bytes) const { g_bytes_unref(bytes); }
  };
  bool is_new(const GstMaterialMeta* meta) const;
  void choose(LitSphere& sphere);

  const Environment studio_ = Environment::studio();
  std::optional<PrefilteredLight> given_;  // by a file, which may be large: what is needed of it
  std::unique_ptr<GBytes, Unref> stream_environment_;  // the environment of the last meta
  std::optional<Environment> estimated_;               // the same
  std::optional<Environment> light_;  // that the object is lit by if no file gives it
  const char* from_ = "studio";
};

}  // namespace inverse
