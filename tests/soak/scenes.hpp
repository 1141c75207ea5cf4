// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "growth.hpp"

namespace inverse::soak {

/// Plays this many frames with extreme changes of scene, every few frames and sometimes every
/// frame, through a decomposer and intrinsiccompose. Throws if an unedited frame differs by more
/// than one code value.
Growth soak_scenes(const std::string& decomposer, unsigned frames, const Slack& slack);

}  // namespace inverse::soak
