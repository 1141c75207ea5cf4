// SPDX-License-Identifier: LGPL-2.1-or-later
// A subject under one distant light at a time.
#pragma once

#include <memory>

#include "subject.hpp"

namespace inverse::olat {

struct View {
  int width = 128, height = 160, samples = 4;  ///< rays a pixel
  float yaw = 0, pitch = 0, roll = 0;          ///< of the head, radians
  float distance = 100;                        ///< of the camera from the head's center, cm
  float pixel = 0.2f;                          ///< size of a pixel at the head's center, cm
  float shift_x = 0, shift_y = 0;              ///< of the head's center in the picture, pixels
  float light_radius = 0.02f;                  ///< of the lights' disc, radians
  bool plain = false;                          ///< Lambertian and white, no scattering, no bounce
};

/// What the camera sees, kept so that each light costs shadow rays and shading alone.
class Renderer {
 public:
  Renderer(Subject subject, const Skin& skin, const View& view, Random random);
  ~Renderer();
  Renderer(const Renderer&) = delete;

  /// 0 … 1, height × width, row 0 on top.
  const std::vector<float>& alpha() const { return alpha_; }
  /// Mean normal, 3 × height × width: x right, y up, z to the camera.
  const std::vector<float>& normals() const { return normals_; }
  /// Radiance under a light that brings irradiance 1 to a surface that faces it, `direction` to the
  /// light: `image`, 3 × height × width, is set.
  void light(Vec direction, float* image);

 private:
  struct Hit;
  struct Bounce;
  struct Taps;
  struct Rays;
  struct State;

  void trace(const Skin& skin, Random& random);
  void find_taps(float scatter);
  std::unique_ptr<State> state_;
  View view_;
  std::vector<float> alpha_, normals_;
};

}  // namespace inverse::olat
