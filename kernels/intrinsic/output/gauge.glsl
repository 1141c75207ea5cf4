// The scale of the output: reflectance has a free one, R c and S / c make the same picture. It is chosen so that a given
// quantile of max_c R comes to a given value, and moves slowly from frame to frame.
const uint kGaugeBins = 512u;
const float kGaugeReach = 8.0;   // ln R from -8 to 8
const float kDarkest = -3.9;     // ln of 2 % of full scale

uint gauge_bin(float log_reflectance) {
  return uint(clamp((log_reflectance + kGaugeReach) * (float(kGaugeBins) / (2.0 * kGaugeReach)), 0.0,
                    float(kGaugeBins - 1u)));
}
float gauge_value(uint bin) { return (float(bin) + 0.5) * (2.0 * kGaugeReach / float(kGaugeBins)) - kGaugeReach; }
