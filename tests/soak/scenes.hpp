#pragma once
#include <string>

#include "growth.hpp"

namespace inverse::soak {

/// So many frames whose scenes change in extreme ways, every few frames and sometimes every frame,
/// through a decomposer and intrinsiccompose. Throws where a frame does not come back, unedited as
/// it is, within one code value.
Growth soak_scenes(const std::string& decomposer, unsigned frames, const Slack& slack);

}  // namespace inverse::soak
