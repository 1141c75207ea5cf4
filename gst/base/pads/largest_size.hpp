// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <functional>
#include <optional>

#include "kernels/image/plane.hpp"

namespace inverse {

/// The largest extent of the shape of `asked` that `fits`, or up to 1/64 less; none if `asked`
/// itself fits or nothing does. `pixels` is a bound that is tried first.
std::optional<Extent> largest_extent(Extent asked, uint64_t pixels,
                                     const std::function<bool(Extent)>& fits);

}  // namespace inverse
