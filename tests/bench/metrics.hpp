// Error measures for intrinsic decompositions.
//
// All of them are invariant to a positive scale of the estimate: reflectance and shading are only
// determined up to one factor, and the MIT set leaves a further factor per color channel open.
// Estimate and truth have equal size and channels; the mask (one channel, 1 counts, 0 does not) may
// be empty, which counts every pixel.
#pragma once

#include <vector>

#include "tests/bench/image.hpp"

namespace inverse::bench {

/// Local mean squared error of Grosse et al. (ICCV 2009): in k x k windows that overlap by half,
/// the estimate is scaled to the truth by least squares; the squared errors, summed over windows
/// and channels, are divided by the squared truth summed alike. 0 is perfect, 1 is as bad as black.
double lmse(const Image& estimate, const Image& truth, const Image& mask, int k = 20);

/// Scale-invariant mean squared error: one least-squares factor per channel for the whole image,
/// mean over pixels and channels of the squared error, truth scaled to a largest value of 1.
double scale_invariant_mse(const Image& estimate, const Image& truth, const Image& mask);

/// (1 - SSIM) / 2 after the same scaling; 11 x 11 Gaussian windows of sigma 1.5, dynamic range 1.
/// Windows lose the weight of pixels outside the mask.
double dssim(const Image& estimate, const Image& truth, const Image& mask);

/// The three measures, each the mean of reflectance and shading.
struct Scores {
  double lmse20 = 0, lmse10 = 0, mse = 0, dssim = 0;
};

/// Scores an estimated reflectance (3 channels) and shading (1 channel).
Scores score(const Image& reflectance, const Image& shading, const Image& true_reflectance,
             const Image& true_shading, const Image& mask);

/// Flicker: the standard deviation over time of the logarithm of the mean channel of reflectance,
/// averaged over pixels (natural log units). Frames show a scene whose true reflectance is static.
/// The per-frame mean over pixels is removed first when `remove_gauge` is set, since one global
/// factor a frame is a matter of the gauge and not of the decomposition.
double flicker(const std::vector<Image>& reflectance, bool remove_gauge);

/// As flicker without the gauge, of changes from frame to frame: the root mean square of successive
/// differences over the square root of 2, which is the standard deviation where frames are
/// independent. Slow drift, which nobody sees, hardly counts.
double jitter(const std::vector<Image>& reflectance);

}  // namespace inverse::bench
