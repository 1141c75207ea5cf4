// SPDX-License-Identifier: LGPL-2.1-or-later
// How surfaces and hair send light on.
#pragma once

#include "skin.hpp"

namespace inverse::olat {

/// Reflected radiance of the specular lobes under irradiance 1 from l; n, v, l: normal, to the
/// camera, to the light.
float specular(const Material& m, Vec n, Vec v, Vec l);
/// A fiber with a diffuse part and two highlights, after Kajiya and Kay (1989) and Marschner et al.
/// (2003): the first white and shifted to the root, the second colored and shifted to the tip.
Vec fiber(const Material& m, Vec tangent, Vec v, Vec l);

}  // namespace inverse::olat
