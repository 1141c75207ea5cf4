// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

namespace inverse::gpu {

/// The number in an environment variable, `fallback` if that is unset or empty. Throws
/// Error(unsupported) if it is anything but a whole number of at most `max`.
uint32_t environment_number(const char* name, uint32_t fallback, uint32_t max = 1);

}  // namespace inverse::gpu
