// SPDX-License-Identifier: LGPL-2.1-or-later
// Indoor environment maps without a photograph: a room with furniture and area lights.
#pragma once

#include "environment.hpp"
#include "random.hpp"

namespace inverse::lime {

/// A box room seen from a random place in it. One of its lights (windows, ceiling panels, strips,
/// lamps) is in the frontal hemisphere (z > 0). Walls have radiance about 0.2 … 0.8, lights 4 … 80.
Environment make_room(Random& random);

}  // namespace inverse::lime
