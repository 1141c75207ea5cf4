// SPDX-License-Identifier: LGPL-2.1-or-later
// The corpus as a C library, for Python's ctypes (olat/corpus.py).
#include <exception>
#include <string>

#include "render.hpp"

using namespace inverse::olat;

namespace {
thread_local std::string last_error;

/// What a sample is made of, drawn by (seed, index) alone.
struct Drawn {
  float trait = 0;
  int family = 0;  ///< 0: ICT head, 1: bust
  View view;
  float exposure = 0;
};

/// A fifth of the shapes, in bands of the trait, is for tests only.
bool held_out(float trait) { return 5 * trait - std::floor(5 * trait) < 0.2f; }

float draw_trait(Random& random, bool test) {
  float trait = random.uniform();
  while (held_out(trait) != test) trait = random.uniform();
  return trait;
}
}  // namespace

struct OlatCorpus {
  HeadModel model;
};

extern "C" {

/// Why the last call of this thread failed.
const char* olat_error() { return last_error.c_str(); }

/// A head model, or none if `vertices` is 0. `deltas`: identities, then expressions. `faces`:
/// three indices each; `kinds`: 0 skin, 1 eye at x < 0, 2 eye at x > 0, 3 teeth, 4 mouth; -1: left
/// out.
OlatCorpus* olat_open(int vertices, const float* neutral, int identities, int expressions,
                      const float* deltas, int faces, const std::int32_t* indices,
                      const std::int32_t* kinds) {
  auto* corpus = new OlatCorpus;
  const auto shape = [&](const float* from) {
    std::vector<Vec> out(static_cast<std::size_t>(vertices));
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = {from[3 * i], from[3 * i + 1], from[3 * i + 2]};
    return out;
  };
  if (!vertices) return corpus;
  HeadModel& m = corpus->model;
  m.neutral = shape(neutral);
  for (int i = 0; i < identities + expressions; ++i)
    (i < identities ? m.identities : m.expressions)
        .push_back(shape(deltas + 3 * std::size_t(vertices) * std::size_t(i)));
  m.groups = {{Part::skin, 0, {}},
              {Part::eye, 1, {}},
              {Part::eye, 2, {}},
              {Part::teeth, 0, {}},
              {Part::mouth, 0, {}}};
  for (int f = 0; f < faces; ++f)
    if (kinds[f] >= 0)
      m.groups[std::size_t(kinds[f])].triangles.push_back({std::uint32_t(indices[3 * f]),
                                                           std::uint32_t(indices[3 * f + 1]),
                                                           std::uint32_t(indices[3 * f + 2])});
  return corpus;
}

void olat_close(OlatCorpus* corpus) { delete corpus; }

int olat_is_held_out(float trait) { return held_out(trait); }

/// Sample `index` of `seed` under `lights` directions (x right, y up, z to the camera). Flags: 1
/// test split, 2 bust only, 4 a white Lambertian sphere, 8 frontal and whole in the picture. olats:
/// 3 × height × width for each light whose `keep` is set, one after another, scaled by 1/share.
/// gradients: A, then B, each 3 × height × width: Σ shares · olat · (1 ± t)/2 · … of all lights.
/// `share`: what part of the sphere each light stands for. alpha: height × width; normals: 3 ×
/// height × width. parameters: trait, family, exposure, yaw, pitch, pixel. Returns 0, or −1 on
/// failure.
int olat_render(const OlatCorpus* corpus, std::uint64_t seed, std::uint64_t index, int width,
                int height, int samples, int flags, int lights, const float* directions,
                float share, const std::int32_t* keep, float* olats, float* gradients, float* alpha,
                float* normals, float* parameters) try {
  const bool test = flags & 1, sphere = flags & 4, calm = flags & 8;
  Random random(seed, index, test ? 1 : 0);
  const float trait = draw_trait(random, test);
  const bool ict = !(flags & 2) && !corpus->model.neutral.empty() && random.chance(0.6f);
  Subject subject = sphere ? sphere_subject()
                    : ict  ? head_of(corpus->model, random, trait)
                           : bust(random, trait);
  const Skin skin(random, subject.marks);
  if (!sphere) grow_hair(subject, random);
  View view;
  view.width = width, view.height = height, view.samples = samples;
  view.yaw = random.chance(0.8f) ? 0.45f * random.normal() : random.uniform(-1.7f, 1.7f);
  view.pitch = 0.18f * random.normal(), view.roll = 0.12f * random.normal();
  view.distance = random.log_uniform(70, 250);
  float filling = random.uniform(0.5f, 0.95f);  // height of the head over the picture's
  if (random.chance(0.3f)) filling = random.uniform(0.9f, 1.7f);
  view.shift_x = 0.08f * float(width) * random.normal(),
  view.shift_y = 0.06f * float(height) * random.normal();
  view.light_radius = random.uniform(0.01f, 0.04f);
  if (sphere) view.yaw = view.pitch = view.roll = view.light_radius = 0, view.plain = true;
  if (sphere) view.distance = 1e4f;
  if (calm || sphere) {
    view.yaw *= 0.6f, view.shift_x *= 0.3f, view.shift_y *= 0.3f;
    filling = random.uniform(0.6f, 0.8f);
  }
  view.pixel = subject.height / (filling * float(height));
  const float exposure = random.log_uniform(0.35f, 0.95f);
  Renderer renderer(std::move(subject), skin, view, Random(seed, index, 7));

  const auto pixels = std::size_t(width) * std::size_t(height);
  std::copy(renderer.alpha().begin(), renderer.alpha().end(), alpha);
  std::copy(renderer.normals().begin(), renderer.normals().end(), normals);
  std::fill(gradients, gradients + 6 * pixels, 0.f);
  std::vector<float> one(3 * pixels);
  for (int i = 0, kept = 0; i < lights; ++i) {
    const Vec d{directions[3 * i], directions[3 * i + 1], directions[3 * i + 2]};
    float* image = keep[i] ? olats + 3 * pixels * std::size_t(kept++) : one.data();
    renderer.light(d, image);
    for (std::size_t c = 0; c < 3; ++c) {
      const float t = (&d.x)[c], up = share * (1 + t) / 2, down = share * (1 - t) / 2;
      for (std::size_t p = 0; p < pixels; ++p) {
        gradients[c * pixels + p] += up * image[c * pixels + p];
        gradients[(3 + c) * pixels + p] += down * image[c * pixels + p];
      }
    }
  }
  const float out[] = {trait, float(ict ? 0 : 1), exposure, view.yaw, view.pitch, view.pixel};
  std::copy(std::begin(out), std::end(out), parameters);
  return 0;
} catch (const std::exception& error) {
  last_error = error.what();
  return -1;
}

}  // extern "C"
