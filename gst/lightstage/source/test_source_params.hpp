// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <string>

#include "gst/base/property_table.hpp"

namespace inverse {

/// The parameters of lightstagetestsrc.
struct TestSourceParams {
  enum class FrameIdBits : uint8_t { bits16 = 16, bits64 = 64 };

  std::string device;
  bool live = true;
  std::string program = "performance";
  unsigned rate = 60;
  double start = 0;
  std::string location;
  std::string listen, listen_source;
  unsigned universe = 1;
  unsigned sync_universe = 0;
  unsigned camera = 0;
  unsigned stack_limit = 2048;
  bool label = false;
  bool frame_ids = false;
  unsigned first_frame_id = 0;
  FrameIdBits frame_id_bits = FrameIdBits::bits64;
  unsigned seed = 0;
  float gain = 1;
  float noise = 0;
  float motion = 0;
  float motion_period = 2;
  float drop_rate = 0, duplicate_rate = 0, late_rate = 0, jitter = 0;
};

const PropertyTable<TestSourceParams>& test_source_properties();

}  // namespace inverse
