// SPDX-License-Identifier: LGPL-2.1-or-later
// Error measures for intrinsic decompositions. A library of its own (`metrics`): no dependencies,
// double precision inside. The program `metrics A B` gives them to scripts.
//
// Reflectance and shading are only determined up to one factor, and the MIT set leaves a further
// one per color channel open: measures named scale-invariant, LMSE and DSSIM fit such a factor,
// the others compare values as they are. Estimate and truth have equal size and channels
// (std::invalid_argument otherwise). A mask has one channel, above 0.5 counts; empty: all counts.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "image.hpp"

namespace inverse::bench {

// Squared error (metrics/squared_error.cpp).

/// Mean squared error over pixels and channels.
double mse(const Image& estimate, const Image& truth, const Image& mask);

/// Peak signal-to-noise ratio, 10 log10(peak² / MSE), dB; infinite for equal images.
double psnr(const Image& estimate, const Image& truth, const Image& mask, double peak = 1);

/// Scale-invariant mean squared error: one least-squares factor per channel for the whole image,
/// mean over pixels and channels of the squared error, truth scaled to a largest value of 1.
double scale_invariant_mse(const Image& estimate, const Image& truth, const Image& mask);

/// Local mean squared error of Grosse et al. (ICCV 2009): in k x k windows that overlap by half,
/// the estimate is scaled to the truth by least squares; the squared errors, summed over windows
/// and channels, are divided by the squared truth summed alike. 0 is perfect, 1 is as bad as black.
/// Grosse et al. take k = 20, the thesis k = 10 (section 3.6.2).
double lmse(const Image& estimate, const Image& truth, const Image& mask, int k = 20);

/// The same with one factor for all channels of a window: counts wrong colors, too.
double color_lmse(const Image& estimate, const Image& truth, const Image& mask, int k = 20);

// Structure (metrics/structure.cpp).

/// Structural similarity (Wang et al. 2004), mean over pixels and channels; 11 x 11 Gaussian
/// windows of sigma 1.5, population variances; `range` is that of the values. Windows that reach
/// over the border are ignored if the frame has others; windows lose the weight of pixels
/// outside the mask. 1 for equal images.
double ssim(const Image& estimate, const Image& truth, const Image& mask, double range = 1);

/// (1 - SSIM) / 2 after one least-squares factor per channel, truth scaled to a largest value of 1.
double dssim(const Image& estimate, const Image& truth, const Image& mask);

/// Multi-scale SSIM (Wang, Simoncelli and Bovik 2003): contrast and structure on scales that halve
/// by 2 x 2 means, luminance on the coarsest; exponents .0448 .2856 .3001 .2363 .1333, of the first
/// few only, scaled to the same sum, where the frame is too small for 11 x 11 windows on all five.
double ms_ssim(const Image& estimate, const Image& truth, const Image& mask, double range = 1);

// Order of reflectances (metrics/order.cpp).

/// A judgment, by a person or the truth, of two points' reflectances.
struct Judgment {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  enum class Darker : std::uint8_t { neither, first, second } darker = Darker::neither;
  double weight = 1;  ///< how sure they are
};

/// Compares the mean channels of two points: darker by more than the factor 1 + delta, or neither.
Judgment::Darker compare(const Image& reflectance, const Judgment& points, double delta);

/// `count` judgments by the truth about points drawn at random inside the mask, half of the pairs
/// near each other (16 pixels), of weight 1.
std::vector<Judgment> judge(const Image& truth, const Image& mask, int count, std::uint32_t seed,
                            double delta = 0.1);

/// Weighted human disagreement rate (Bell, Bala and Snavely 2014): the share of the judgments'
/// weight that the estimate contradicts, 0…1.
double whdr(const Image& reflectance, const std::vector<Judgment>& judgments, double delta = 0.1);

// Time (metrics/flicker.cpp). Values are natural log units of the mean channel of reflectance.

/// Standard deviation over time, averaged over the pixels of the mask, which show the same true
/// reflectance in every frame. The per-frame mean over these pixels is removed first when
/// `remove_scale` is set, since one global factor a frame is a matter of the scale and not of the
/// decomposition.
double flicker(const std::vector<Image>& reflectance, bool remove_scale, const Image& mask = {});

/// Where one surface point is seen, frame by frame, in pixels (the center of the first is 0, 0);
/// not seen where a coordinate is NaN.
using Track = std::vector<std::array<double, 2>>;

/// The same along known motion, by bilinear sampling; points seen in fewer than two frames do not
/// count. The scale of a frame is the mean over its points of their deviation from their own mean.
double flicker_along(const std::vector<Image>& reflectance, const std::vector<Track>& tracks,
                     bool remove_scale);

/// Change of the scale of what stays in view: mean over frames k of |median over points seen in
/// both of ln R(k + span) - ln R(k)|. Frames that share fewer than 15 points do not count; 0 if
/// none do.
double common_drift(const std::vector<Image>& reflectance, const std::vector<Track>& tracks,
                    std::size_t span);

/// How much the mean reflectance of a patch of a surface changes, whose points have these tracks:
/// linear units, Euclidean norm over channels. Means are over points that are seen in what is
/// compared; fewer than 15 do not count.
struct PatchVariation {
  double step = 0;    ///< from frame to frame, mean over frames
  double spread = 0;  ///< from its points' means over time, mean over frames
};
PatchVariation patch_variation(const std::vector<Image>& reflectance,
                               const std::vector<Track>& patch);

/// As flicker without the scale, of changes from frame to frame: the root mean square of successive
/// differences over the square root of 2, which is the standard deviation where frames are
/// independent. Slow, invisible drift hardly counts.
double jitter(const std::vector<Image>& reflectance, const Image& mask = {});

/// Pixels (1 or 0) whose true reflectance stays within 1 % in all frames.
Image static_pixels(const std::vector<Image>& true_reflectance);

// Together (metrics/score.cpp).

/// Means of reflectance and shading, but for `whdr`, which is the reflectance's.
struct Scores {
  double lmse20 = 0, lmse10 = 0, mse = 0, dssim = 0, ms_ssim = 0, psnr = 0, whdr = 0;
};

/// The fields of Scores by name, for whoever goes through all of them.
inline constexpr std::array<std::pair<const char*, double Scores::*>, 7> kScoreFields{
    {{"lmse20", &Scores::lmse20},
     {"lmse10", &Scores::lmse10},
     {"mse", &Scores::mse},
     {"dssim", &Scores::dssim},
     {"ms_ssim", &Scores::ms_ssim},
     {"psnr", &Scores::psnr},
     {"whdr", &Scores::whdr}}};

/// Scores an estimated reflectance (3 channels) and shading (1 channel): `mse` is the
/// scale-invariant one; MS-SSIM and PSNR are taken after the scale of DSSIM; WHDR asks the truth
/// about 2000 pairs of points.
Scores score(const Image& reflectance, const Image& shading, const Image& true_reflectance,
             const Image& true_shading, const Image& mask);

/// The least-squares factor from estimate to truth, one for all channels; 0 if the estimate is.
double best_scale(const Image& estimate, const Image& truth, const Image& mask);

/// Squared error of scale times the estimate over the squared truth, both summed over pixels and
/// channels: 0 is perfect, 1 is as bad as black.
double relative_error(const Image& estimate, const Image& truth, const Image& mask, double scale);

/// Error of the color of RGB shading: root mean square over pixels of the distance of the two
/// coordinates of ln(S + .003) across the gray axis, natural log units, the estimate brought to the
/// truth's scale first. Gray shading scores the root mean square of the truth's own tint.
double tint_error(const Image& shading, const Image& truth, const Image& mask);

/// Of layers beyond two: direct and indirect RGB shading, whose sum is the shading.
struct LayerScores {
  double ind = 0;               ///< relative error of the indirect layer at its own best scale
  double dir_j = 0, ind_j = 0;  ///< of both at the scale that fits their sum best: counts the split
  double tint = 0;              ///< tint_error of the sum
};
inline constexpr std::array<std::pair<const char*, double LayerScores::*>, 4> kLayerScoreFields{
    {{"ind", &LayerScores::ind},
     {"dirJ", &LayerScores::dir_j},
     {"indJ", &LayerScores::ind_j},
     {"tint", &LayerScores::tint}}};
LayerScores score_layers(const Image& direct, const Image& indirect, const Image& true_direct,
                         const Image& true_indirect, const Image& mask);

/// LMSE (k = 20) alone, the mean of reflectance and shading: score() for many frames that are
/// alike.
double score_lmse(const Image& reflectance, const Image& shading, const Image& true_reflectance,
                  const Image& true_shading, const Image& mask);

/// The estimate times one least-squares factor per channel, over the largest true value (`peak`).
Image fitted(const Image& estimate, const Image& truth, const Image& mask, double* peak = nullptr);

/// Distance of two decompositions of one frame: root mean square over pixels and channels of the
/// difference of ln R, one common factor removed, natural log units; R below 1e-4 counts as 1e-4.
double log_distance(const Image& reflectance, const Image& other, const Image& mask);

}  // namespace inverse::bench
