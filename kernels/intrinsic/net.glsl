// What the fitted functions of EdgePrior are evaluated on and what their outputs mean
// (docs/method-intrinsicdecomp.md, 2).
const float kLogLow = -4.5, kLogHigh = 3.0;
float cue(float x, float center) { return (log(x + 0.01) + center) / 1.5; }
float weight(float log_weight) { return exp(clamp(log_weight, kLogLow, kLogHigh)); }
