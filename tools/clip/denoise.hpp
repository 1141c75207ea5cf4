// SPDX-License-Identifier: LGPL-2.1-or-later
// Removes sampling noise from the soft layers of a rendered frame.
#pragma once

#include "transport.hpp"

namespace inverse::clip {

/// Edge-avoiding à-trous wavelet on window and indirect shading together (Dammertz et al. 2010,
/// with the variance-guided luminance weight of Schied et al. 2017). Guided by normals, positions
/// and the shading's own variance, never by reflectance. Pixels that mix surfaces are antialiased
/// afterwards. The lamp's shading and the reflectance
/// stay as rendered.
void denoise(Layers& layers, int passes, int threads);

}  // namespace inverse::clip
