// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once for each library of kernels. Each file still includes what it uses.

#include <vulkan/vulkan.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
