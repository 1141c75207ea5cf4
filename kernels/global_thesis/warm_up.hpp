#pragma once
#include <memory>

#include "../gpu/device.hpp"

namespace inverse {

/// As GlobalThesis::warm_up, for marked regions and MisclusteringCorrection: corrects a region of a
/// tiny frame once. Waits for the device. Throws Error(out_of_memory), and Error(internal) where
/// the correction does not end.
void warm_up_correction(const std::shared_ptr<gpu::Device>& device);

}  // namespace inverse
