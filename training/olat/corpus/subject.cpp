// SPDX-License-Identifier: LGPL-2.1-or-later
#include "subject.hpp"

namespace inverse::olat {

using namespace lime;

void Mesh::find_normals() {
  normals.assign(positions.size(), Vec{});
  for (const Triangle& t : triangles) {
    const Vec n = cross(positions[t.b] - positions[t.a], positions[t.c] - positions[t.a]);
    normals[t.a] += n;
    normals[t.b] += n;
    normals[t.c] += n;
  }
  for (Vec& n : normals) n = normalize(n);
}

namespace {

float bell(float x, float width) { return std::exp(-x * x / (2 * width * width)); }

Mesh eyeball(Vec center, float radius, Vec axis) {
  // The pole, where the grid is finest, is turned to where it looks.
  const Vec up = normalize(axis), side = normalize(cross(Vec{0, 1, 0.01f}, up)),
            third = cross(up, side);
  Mesh mesh = Mesh::sphere(Part::eye, 32, 48, [&](Vec d) {
    // The cornea bulges.
    const float bulge =
        1 + 0.05f * std::exp(-std::pow(std::acos(std::clamp(d.y, -1.f, 1.f)) / 0.4f, 4.f));
    return center + radius * bulge * (d.x * third + d.y * up + d.z * side);
  });
  mesh.center = center;
  mesh.axis = up;
  return mesh;
}

}  // namespace

Subject sphere_subject() {
  Subject subject;
  subject.meshes.push_back(Mesh::sphere(Part::skin, 256, 512, [](Vec d) { return 10.f * d; }));
  subject.height = 22;
  return subject;
}

Subject head_of(const HeadModel& model, Random& random, float trait) {
  Subject subject;
  std::vector<Vec> at = model.neutral;
  const auto add = [&](const std::vector<Vec>& delta, float weight) {
    for (std::size_t i = 0; i < at.size(); ++i) at[i] += weight * delta[i];
  };
  for (std::size_t i = 0; i < model.identities.size(); ++i)
    add(model.identities[i], i == 0 ? 4 * trait - 2 : std::clamp(random.normal(), -2.f, 2.f));
  for (const auto& expression : model.expressions)
    if (random.chance(0.25f))
      add(expression, random.uniform(0.1f, random.chance(0.5f) ? 0.4f : 0.9f));
  const float gaze_x = 0.25f * random.normal(), gaze_y = 0.12f * random.normal();
  for (const auto& group : model.groups) {
    Mesh mesh;
    mesh.part = group.part;
    std::vector<std::int64_t> index(at.size(), -1);
    const auto use = [&](std::uint32_t v) {
      if (index[v] < 0) {
        index[v] = std::int64_t(mesh.positions.size());
        mesh.positions.push_back(at[v]);
        mesh.rest.push_back(model.neutral[v]);
      }
      return std::uint32_t(index[v]);
    };
    for (const Triangle& t : group.triangles)
      mesh.triangles.push_back({use(t.a), use(t.b), use(t.c)});
    if (group.part == Part::eye) {
      Vec sum;
      float far = 0;
      for (Vec p : mesh.positions) sum += p;
      const Vec center = (1 / float(mesh.positions.size())) * sum;
      for (Vec p : mesh.positions) far += length(p - center);
      subject.meshes.push_back(
          eyeball(center, far / float(mesh.positions.size()), Vec{gaze_x, gaze_y, 1}));
      continue;
    }
    mesh.find_normals();
    subject.meshes.push_back(std::move(mesh));
  }
  subject.center = {0, 0, 2};
  subject.height = 27;
  if (random.chance(0.85f)) dress(subject, random, 12);
  return subject;
}

Subject bust(Random& random, float trait) {
  Subject subject;
  Landmarks& m = subject.marks;
  const bool abstract = random.chance(0.2f);
  const float x = 7 + 2.2f * trait, y = random.uniform(10.5f, 13), z = random.uniform(8.5f, 11);
  const float power = random.uniform(2, 2.5f), jaw = random.uniform(0.05f, 0.35f);
  const float nose = random.uniform(1.2f, 3), nose_width = random.uniform(0.8f, 1.5f);
  const float nose_low = random.uniform(-2.8f, -1.2f), brow = random.uniform(0.2f, 1);
  const float socket = random.uniform(0.5f, 1.3f), chin = random.uniform(0, 1.2f);
  const float cheek = random.uniform(0, 0.6f), lip = random.uniform(0.15f, 0.5f);
  const float rough = random.uniform(0.1f, abstract ? 2.5f : 0.6f),
              rough_size = random.uniform(3, 9);
  const float mouth_y = random.uniform(-6.2f, -4.8f), eye_y = random.uniform(0.8f, 2);
  const float eye_x = 0.4f * x, eye_radius = random.uniform(1.15f, abstract ? 2.2f : 1.5f);
  const auto salt = std::uint32_t(random.bits());
  const auto surface = [&](Vec d) {
    const float r =
        std::pow(std::pow(std::abs(d.x) / x, power) + std::pow(std::abs(d.y) / y, power) +
                     std::pow(std::abs(d.z) / z, power),
                 -1 / power);
    Vec p = r * d;
    const float low = std::clamp(-p.y / y, 0.f, 1.f);
    p.x *= 1 - jaw * low * low;
    const float front = std::clamp(d.z * 2, 0.f, 1.f), ax = std::abs(p.x);
    if (front > 0) {
      const float ridge = std::clamp((eye_y + 0.6f - p.y) / (eye_y + 0.6f - nose_low), 0.f, 1.f);
      const float tip = p.y < nose_low ? bell(p.y - nose_low, 0.55f) : 1;
      p.z += front * nose * ridge * tip * bell(p.x, nose_width * (0.5f + 0.5f * ridge));
      p.z -= front * socket * bell(ax - eye_x, 1.5f) * bell(p.y - eye_y, 1.0f);
      p.z += front * brow * bell(ax - eye_x, 2) * bell(p.y - eye_y - 1.9f, 0.6f);
      p.z += front * cheek * bell(ax - 1.2f * eye_x, 1.6f) * bell(p.y - nose_low, 1.6f);
      p.z += front * lip * bell(p.x, 1.7f) *
             (bell(p.y - mouth_y - 0.45f, 0.3f) + bell(p.y - mouth_y + 0.5f, 0.35f));
      p.z -= front * 0.35f * bell(p.x, 2) * bell(p.y - mouth_y, 0.18f);
      p.z += front * chin * bell(p.x, 1.8f) * bell(p.y - mouth_y + 3, 1.1f);
    }
    return p + (rough * (2 * noise((1 / rough_size) * p, salt, abstract ? 3 : 2) - 1)) * d;
  };
  subject.meshes.push_back(Mesh::sphere(Part::skin, 320, 400, surface));
  const auto face_z = [&](float px, float py) {
    const float inside = 1 - std::pow(std::abs(px) / x, power) - std::pow(std::abs(py) / y, power);
    return z * std::pow(std::max(inside, 0.05f), 1 / power);
  };
  if (!abstract || random.chance(0.6f)) {
    const Vec gaze{0.25f * random.normal(), 0.12f * random.normal(), 1};
    for (float s : {-1.f, 1.f})
      subject.meshes.push_back(
          eyeball({s * eye_x, eye_y, face_z(eye_x, eye_y) - socket - 0.35f * eye_radius},
                  eye_radius, gaze));
  }
  const float ear = random.uniform(abstract ? 1.5f : 2.2f, abstract ? 5 : 3.2f),
              lean = random.uniform(0.2f, 0.9f);
  for (float s : {-1.f, 1.f}) {  // a bowl that opens to the front and the side
    const Vec out = normalize({s * std::cos(lean), 0, std::sin(lean)});
    const Vec along = cross(Vec{0, 1, 0}, out), at{s * 0.97f * x, 0.3f, -0.5f};
    subject.meshes.push_back(Mesh::sphere(Part::skin, 48, 64, [&](Vec d) {
      const float dent = 0.8f * std::exp(-4 * (d.x * d.x + d.y * d.y)) * std::max(d.z, 0.f);
      return at + (0.62f * ear * d.x) * along + Vec{0, ear * d.y, 0} + (0.75f * d.z - dent) * out +
             (0.5f * ear) * Vec{s * 0.6f, 0, -0.3f};
    }));
  }
  if (!abstract || random.chance(0.5f)) {
    const float neck = random.uniform(0.55f, 0.75f) * x;
    subject.meshes.push_back(Mesh::sphere(Part::skin, 64, 96, [&](Vec d) {
      const float across = std::max(std::hypot(d.x, d.z), 1e-3f);
      const float ring = neck * std::min(1.f, across * 8) * (1 + 0.25f * d.y * d.y);
      return Vec{ring * d.x / across, -10 + 10 * d.y, -1.5f + ring * d.z / across};
    }));
    if (random.chance(0.9f)) dress(subject, random, x + 2);
  }
  m.mouth = {0, mouth_y, face_z(0, mouth_y)};
  m.mouth_width = random.uniform(1.8f, 2.6f), m.mouth_height = random.uniform(0.7f, 1.1f);
  m.brow = {eye_x, eye_y + 2.2f, face_z(eye_x, eye_y + 2.2f)};
  m.cheek = {1.1f * eye_x, nose_low, face_z(eye_x, nose_low)};
  m.hairline_front = random.uniform(0.48f, 0.8f) * y, m.front = z;
  m.hairline_back = -0.4f * y, m.back = -0.3f * z;
  m.chin = mouth_y - 3, m.jaw_back = 0.1f * z;
  subject.center = {0, -1, 0};
  subject.height = 2 * y + 2;
  return subject;
}

void dress(Subject& subject, Random& random, float width) {
  const float shoulders = width * random.uniform(1.5f, 1.9f), depth = random.uniform(7, 9.5f);
  const float y = random.uniform(-27, -22), folds = random.uniform(0, 1);
  const auto salt = std::uint32_t(random.bits());
  subject.meshes.push_back(Mesh::sphere(Part::cloth, 96, 160, [&](Vec d) {
    const Vec p = Vec{0, y, -2} + Vec{shoulders, 9, depth} * d;
    return p + (folds * (2 * noise(0.35f * p, salt, 2) - 1)) * d;
  }));
  if (random.chance(0.5f)) {  // a collar
    const float ring = random.uniform(0.55f, 0.72f) * width, tube = random.uniform(0.7f, 1.4f);
    subject.meshes.push_back(Mesh::sphere(Part::cloth, 24, 96, [&](Vec d) {
      const float across = std::max(std::hypot(d.x, d.z), 1e-4f);
      const float r = ring + tube * across;
      return Vec{r * d.x / across, y + 8 + tube * d.y, -2 + r * d.z / across};
    }));
  }
}

}  // namespace inverse::olat
