// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once for the references. Each file still includes what it uses.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>
