// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "light_driver.hpp"

// The backends of make_light_driver.
namespace inverse {

std::unique_ptr<LightDriver> make_sacn_driver(const LightDriverSettings& settings);
std::unique_ptr<LightDriver> make_ola_driver(const LightDriverSettings& settings);
std::unique_ptr<LightDriver> make_serial_driver(const LightDriverSettings::Serial& settings);

}  // namespace inverse
