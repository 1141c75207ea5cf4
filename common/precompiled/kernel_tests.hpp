// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once for programs that test what needs no pipeline. Each file still includes what it
// uses.

#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/image/plane.hpp"
