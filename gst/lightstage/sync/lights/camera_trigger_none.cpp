// SPDX-License-Identifier: LGPL-2.1-or-later
// Replaces camera_trigger.cpp in builds without Aravis.
#include "camera_trigger.hpp"

namespace inverse {

struct CameraTrigger::Camera {};

std::unique_ptr<CameraTrigger> CameraTrigger::find(GstPad*) {
  throw Error(ErrorKind::unsupported,
              "this build cannot trigger cameras: build it with libaravis-dev");
}
CameraTrigger::~CameraTrigger() = default;
void CameraTrigger::prepare() {}
void CameraTrigger::configure() {}
void CameraTrigger::end() {}
std::string CameraTrigger::name() const { return {}; }
void CameraTrigger::fire() {}
uint32_t CameraTrigger::frame_id_bits() const { return 0; }
bool CameraTrigger::has_times() const { return false; }

}  // namespace inverse
