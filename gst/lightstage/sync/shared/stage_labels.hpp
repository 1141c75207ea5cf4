// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <map>
#include <mutex>

#include "gst/inverse/inverse_light_stage_meta.h"
#include "kernels/lightstage/program/light_program.hpp"

namespace inverse {

/// The light of a frame.
struct FrameLabel {
  uint64_t trigger = 0;
  LightProgram::Position position;
};

/// A light program, and its words for buffers. Thread-safe.
class StageLabels {
 public:
  explicit StageLabels(LightProgram program);
  StageLabels(const StageLabels&) = delete;
  StageLabels& operator=(const StageLabels&) = delete;
  ~StageLabels();

  const LightProgram& program() const { return program_; }
  /// Duration of a step, ns.
  GstClockTime period() const;
  /// Writes a label on a writable buffer.
  void attach(GstBuffer* buffer, const FrameLabel& label) const;

 private:
  GBytes* colors(const LightProgram::Position& position) const;

  LightProgram program_;
  uint64_t id_;
  mutable std::mutex mutex_;
  mutable std::map<uint64_t, GBytes*> colors_;  // by step, made when first used
};

}  // namespace inverse
