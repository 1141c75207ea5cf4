// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "gst/base/property_table.hpp"
#include "kernels/lightstage/controllers/light_driver.hpp"

namespace inverse {

/// The parameters of lightstagesync.
struct SyncParams {
  enum class FrameId : uint8_t { none, offset };
  enum class FrameIdBits : uint8_t { automatic = 0, bits16 = 16, bits32 = 32, bits64 = 64 };
  enum class Assemble : uint8_t { none, pairs, olat };
  enum class Align : uint8_t { none, flow };
  enum class Sets : uint8_t { complete, all };
  enum class CameraTrigger : uint8_t { none, aravis_software };

  std::string program = "performance";
  unsigned rate = 60;
  FrameId frame_id = FrameId::none;
  FrameIdBits frame_id_bits = FrameIdBits::automatic;
  double jitter = 0.34;
  double marker_timeout = 5;
  Sets sets = Sets::complete;
  double timeout = 0.2;
  unsigned max_frames = 0;
  bool drop_unlabeled = true;
  Assemble assemble = Assemble::none;
  Align align = Align::none;
  std::string location;
  CameraTrigger camera_trigger = CameraTrigger::none;
  double trigger_timeout = 1;
  unsigned trigger_retries = 2;
  std::string device;

  LightDriverSettings lights;
  double lead_in = 1;
};

const PropertyTable<SyncParams>& sync_properties();

}  // namespace inverse
