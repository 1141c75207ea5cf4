// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

#include "commands.hpp"

namespace inverse::gpu {

/// Invocations of a kernel that runs as a single workgroup.
constexpr uint32_t kOneGroup = 128;

/// How many vec4 slots SUM_PARTIALS (common.glsl) may write for a dispatch of `items` with this
/// kernel. A buffer that holds them is zeroed once, when it is made.
inline uint32_t partial_count(const Kernel& kernel, Items items) {
  const Items groups = kernel.groups(items);
  return groups.x * groups.y * groups.z * kernel.max_subgroups();
}

}  // namespace inverse::gpu
