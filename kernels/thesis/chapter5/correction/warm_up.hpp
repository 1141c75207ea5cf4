// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/device.hpp"

namespace inverse {

/// As GlobalThesis::warm_up, for MarkedRegions, RegionProposals and MisclusteringCorrection:
/// corrects a region of a tiny frame, once a device. Waits for the device. False if the correction
/// did not end: some kernels may then be built in mid-stream. Throws Error(out_of_memory).
bool warm_up_correction(const std::shared_ptr<gpu::Device>& device);

}  // namespace inverse
