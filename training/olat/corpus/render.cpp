// SPDX-License-Identifier: LGPL-2.1-or-later
#include "render.hpp"

#include <embree3/rtcore.h>

#include <cstring>
#include <limits>
#include <stdexcept>

#include "lobes.hpp"

namespace inverse::olat {

using namespace lime;

/// One ray of a pixel that met the subject.
struct Renderer::Hit {
  int pixel;
  Vec at, normal, geometric, tangent, view;
  Material material;
  float shadow_start;    ///< where shadow rays begin
  float disc_x, disc_y;  ///< its point of the lights' disc, the same for every light
};

/// Where light comes from that a hit receives from other surfaces: one direction, drawn by cosine.
struct Renderer::Bounce {
  int pixel;
  Vec at, normal, geometric, albedo;
  float start, disc_x, disc_y;
};

/// Weights of the pixels around one, a color each.
struct Renderer::Taps {
  std::vector<std::uint32_t> first;  ///< pixel → index; one more at the end
  std::vector<std::uint32_t> pixel;
  std::vector<Vec> weight;
  void apply(const std::vector<Vec>& from, std::vector<Vec>& to) const {
    for (std::size_t p = 0; p + 1 < first.size(); ++p) {
      Vec sum;
      for (std::uint32_t i = first[p]; i < first[p + 1]; ++i) sum += weight[i] * from[pixel[i]];
      to[p] = sum;
    }
  }
};

/// Shadow rays, 16 at a time.
struct Renderer::Rays {
  alignas(64) int valid[16];
  RTCRay16 rays;
  int count = 0;
  std::size_t owner[16];
};

struct Renderer::State {
  Subject subject;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<std::uint32_t> strand_of;  ///< curve segment → strand
  unsigned curves = RTC_INVALID_GEOMETRY_ID;
  std::vector<Hit> hits;
  std::vector<Bounce> bounces;
  std::vector<Vec> place,
      albedo_sum;               ///< of a pixel's scattering hits: mean place, Σ albedo / samples
  std::vector<int> scattering;  ///< how many of a pixel's hits scatter
  std::vector<Vec> body_sum;    ///< of all solid hits: Σ albedo / samples
  std::vector<int> bodies;
  Taps skin, smooth;
  std::vector<char> dark;
  std::vector<Vec> irradiance, spread, bounced;
  Random random{0, 0, 0};

  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

Rotation pose(const View& v) {
  const float cy = std::cos(v.yaw), sy = std::sin(v.yaw), cp = std::cos(v.pitch),
              sp = std::sin(v.pitch);
  const float cr = std::cos(v.roll), sr = std::sin(v.roll);
  const Rotation yaw{{Vec{cy, 0, sy}, Vec{0, 1, 0}, Vec{-sy, 0, cy}}};
  const Rotation pitch{{Vec{1, 0, 0}, Vec{0, cp, -sp}, Vec{0, sp, cp}}};
  const Rotation roll{{Vec{cr, -sr, 0}, Vec{sr, cr, 0}, Vec{0, 0, 1}}};
  Rotation out;
  const auto column = [&](Vec e) { return roll(pitch(yaw(e))); };
  const Vec x = column({1, 0, 0}), y = column({0, 1, 0}), z = column({0, 0, 1});
  out.rows = {Vec{x.x, y.x, z.x}, Vec{x.y, y.y, z.y}, Vec{x.z, y.z, z.z}};
  return out;
}

/// Two unit vectors across n.
std::pair<Vec, Vec> frame(Vec n) {
  const Vec a = normalize(cross(std::abs(n.x) > 0.7f ? Vec{0, 1, 0} : Vec{1, 0, 0}, n));
  return {a, cross(n, a)};
}

}  // namespace

Renderer::Renderer(Subject subject, const Skin& skin, const View& view, Random random)
    : state_(std::make_unique<State>()), view_(view) {
  State& s = *state_;
  s.subject = std::move(subject);
  const Rotation turn = pose(view);
  const Vec center = s.subject.center;
  for (Mesh& mesh : s.subject.meshes) {
    for (Vec& p : mesh.positions) p = turn(p - center);
    for (Vec& n : mesh.normals) n = turn(n);
    mesh.center = turn(mesh.center - center);
    mesh.axis = turn(mesh.axis);
  }
  for (Strand& strand : s.subject.strands)
    for (Vec& p : strand.points) p = turn(p - center);

  s.device = rtcNewDevice("threads=1,user_threads=1");
  if (!s.device) throw std::runtime_error("Embree cannot be started");
  s.scene = rtcNewScene(s.device);
  rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST);
  for (const Mesh& mesh : s.subject.meshes) {
    RTCGeometry g = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    std::memcpy(v, mesh.positions.data(), 12 * mesh.positions.size());
    auto* t = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    std::memcpy(t, mesh.triangles.data(), 12 * mesh.triangles.size());
    rtcCommitGeometry(g);
    rtcAttachGeometry(s.scene, g);
    rtcReleaseGeometry(g);
  }
  if (!s.subject.strands.empty()) {
    std::vector<std::array<float, 4>> points;
    std::vector<std::uint32_t> segments;
    for (std::size_t i = 0; i < s.subject.strands.size(); ++i) {
      const Strand& strand = s.subject.strands[i];
      const std::size_t n = strand.points.size();
      for (std::size_t k = 0; k < n; ++k) {
        if (k + 1 < n) {
          segments.push_back(std::uint32_t(points.size()));
          s.strand_of.push_back(std::uint32_t(i));
        }
        const float t = float(k) / float(n - 1);
        const Vec p = strand.points[k];
        points.push_back({p.x, p.y, p.z, (1 - t) * strand.root + t * strand.tip});
      }
    }
    RTCGeometry g = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE);
    std::memcpy(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, points.size()),
        points.data(), 16 * points.size());
    std::memcpy(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, 4, segments.size()),
        segments.data(), 4 * segments.size());
    rtcCommitGeometry(g);
    s.curves = rtcAttachGeometry(s.scene, g);
    rtcReleaseGeometry(g);
  }
  rtcCommitScene(s.scene);
  s.random = random;
  trace(skin, random);
  find_taps(skin.scatter());
}

Renderer::~Renderer() = default;

void Renderer::trace(const Skin& skin, Random& random) {
  State& s = *state_;
  const int w = view_.width, h = view_.height;
  const auto pixels = std::size_t(w) * std::size_t(h);
  alpha_.assign(pixels, 0);
  normals_.assign(3 * pixels, 0);
  s.place.assign(pixels, {});
  s.albedo_sum.assign(pixels, {});
  s.body_sum.assign(pixels, {});
  s.scattering.assign(pixels, 0);
  s.bodies.assign(pixels, 0);
  const float share = 1 / float(view_.samples);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);

  const auto cast = [&](Vec o, Vec d, float start, RTCRayHit& ray) {
    ray.ray = {o.x, o.y, o.z, start, d.x, d.y, d.z, 0, std::numeric_limits<float>::infinity(),
               ~0u, 0,   0};
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(s.scene, &context, &ray);
    return ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  };
  const auto surface = [&](const RTCRayHit& ray, Vec o, Vec d) {
    Hit hit{};
    const float radius = view_.light_radius * std::sqrt(random.uniform()),
                turn = 2 * kPi * random.uniform();
    hit.disc_x = radius * std::cos(turn), hit.disc_y = radius * std::sin(turn);
    hit.at = o + ray.ray.tfar * d;
    hit.view = -1.f * d;
    if (ray.hit.geomID == s.curves) {
      const std::uint32_t i = s.strand_of[ray.hit.primID];
      const Strand& strand = s.subject.strands[i];
      // Segments of a strand follow each other.
      std::uint32_t first = ray.hit.primID;
      while (first > 0 && s.strand_of[first - 1] == i) --first;
      const std::uint32_t k = ray.hit.primID - first;
      hit.tangent = normalize(strand.points[k + 1] - strand.points[k]);
      hit.normal = hit.geometric = normalize(hit.view - dot(hit.view, hit.tangent) * hit.tangent);
      hit.material = skin.hair(i, strand.brow);
      hit.shadow_start = 3.5f * strand.root;
      return hit;
    }
    const Mesh& mesh = s.subject.meshes[ray.hit.geomID];
    const Triangle& t = mesh.triangles[ray.hit.primID];
    const float u = ray.hit.u, v = ray.hit.v, r = 1 - u - v;
    hit.normal = normalize(r * mesh.normals[t.a] + u * mesh.normals[t.b] + v * mesh.normals[t.c]);
    hit.geometric = normalize(Vec{ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z});
    if (dot(hit.geometric, hit.view) < 0) hit.geometric = -1.f * hit.geometric;
    if (dot(hit.normal, hit.geometric) < 0) hit.normal = -1.f * hit.normal;
    const Vec rest = r * mesh.rest[t.a] + u * mesh.rest[t.b] + v * mesh.rest[t.c];
    switch (mesh.part) {
      case Part::eye: {
        const Vec out = normalize(hit.at - mesh.center);
        const auto [a, b] = frame(mesh.axis);
        hit.material = skin.eye(mesh.axis, out, std::atan2(dot(out, a), dot(out, b)));
        break;
      }
      case Part::cloth:
        hit.material = skin.cloth(rest);
        break;
      case Part::teeth:
        hit.material = skin.teeth();
        break;
      case Part::mouth:
        hit.material = skin.mouth();
        break;
      default:
        hit.material = skin.skin(rest);
    }
    if (view_.plain) hit.material = {Part::cloth, {1, 1, 1}, 0, 1, 1, 0};
    hit.shadow_start = 0.01f;
    return hit;
  };

  const float focal = view_.distance / view_.pixel;
  const Vec eye{0, 0, view_.distance};
  const int grid = int(std::lround(std::ceil(std::sqrt(float(view_.samples)))));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const auto pixel = std::size_t(y * w + x);
      for (int k = 0; k < view_.samples; ++k) {
        const float jx = (float(k % grid) + random.uniform()) / float(grid);
        const float jy = (float(k / grid) + random.uniform()) * float(grid) /
                         (float(grid) * std::ceil(float(view_.samples) / float(grid)));
        const Vec d = normalize({float(x) + jx - 0.5f * float(w) - view_.shift_x,
                                 0.5f * float(h) + view_.shift_y - float(y) - jy, -focal});
        RTCRayHit ray;
        if (!cast(eye, d, 0, ray)) continue;
        Hit hit = surface(ray, eye, d);
        hit.pixel = int(pixel);
        alpha_[pixel] += share;
        for (int c = 0; c < 3; ++c)
          normals_[std::size_t(c) * pixels + pixel] += share * (&hit.normal.x)[c];
        const bool solid = hit.material.part != Part::hair;
        if (solid) {
          s.body_sum[pixel] += share * hit.material.albedo;
          ++s.bodies[pixel];
          s.place[pixel] += hit.at;
        }
        if (hit.material.part == Part::skin) {
          s.albedo_sum[pixel] += share * hit.material.albedo;
          ++s.scattering[pixel];
        }
        s.hits.push_back(hit);
        if (!solid || view_.plain) continue;
        const auto [a, b] = frame(hit.normal);
        const float r2 = random.uniform(), phi = 2 * kPi * random.uniform(), r = std::sqrt(r2);
        const Vec way =
            (r * std::cos(phi)) * a + (r * std::sin(phi)) * b + std::sqrt(1 - r2) * hit.normal;
        if (dot(way, hit.geometric) <= 0) continue;
        const Vec start = hit.at + 0.01f * hit.geometric;
        if (!cast(start, way, 0.01f, ray)) continue;
        const Hit other = surface(ray, start, way);
        s.bounces.push_back({int(pixel), other.at,
                             other.material.part == Part::hair ? Vec{} : other.normal,
                             other.geometric, other.material.albedo, other.shadow_start,
                             other.disc_x, other.disc_y});
      }
      if (s.bodies[pixel]) s.place[pixel] = (1 / float(s.bodies[pixel])) * s.place[pixel];
    }
  s.irradiance.resize(pixels);
  s.spread.resize(pixels);
  s.bounced.resize(pixels);
}

void Renderer::find_taps(float scatter) {
  State& s = *state_;
  const int w = view_.width, h = view_.height;
  // Mean distances that red, green and blue travel in skin (cm), as widths of Gaussians.
  const Vec sigma = view_.plain ? Vec{1e-3f, 1e-3f, 1e-3f} : scatter * Vec{0.28f, 0.14f, 0.08f};
  const int reach = std::clamp(int(std::ceil(2.2f * sigma.x / view_.pixel)), 1, 6);
  const auto build = [&](Taps& taps, const std::vector<int>& counts, int radius, Vec width) {
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const auto pixel = std::size_t(y * w + x);
        taps.first.push_back(std::uint32_t(taps.pixel.size()));
        if (!counts[pixel]) continue;
        const std::size_t begin = taps.pixel.size();
        Vec total;
        for (int j = std::max(y - radius, 0); j <= std::min(y + radius, h - 1); ++j)
          for (int i = std::max(x - radius, 0); i <= std::min(x + radius, w - 1); ++i) {
            const auto other = std::size_t(j * w + i);
            if (!counts[other]) continue;
            const Vec apart = s.place[other] - s.place[pixel];
            const float d2 = dot(apart, apart), n = float(counts[other]);
            const Vec weight{n * std::exp(-d2 / (2 * width.x * width.x)),
                             n * std::exp(-d2 / (2 * width.y * width.y)),
                             n * std::exp(-d2 / (2 * width.z * width.z))};
            if (weight.x < 2e-3f) continue;
            taps.pixel.push_back(std::uint32_t(other));
            taps.weight.push_back(weight);
            total += weight;
          }
        for (std::size_t k = begin; k < taps.weight.size(); ++k)
          taps.weight[k] = taps.weight[k] * Vec{1 / total.x, 1 / total.y, 1 / total.z};
      }
    taps.first.push_back(std::uint32_t(taps.pixel.size()));
  };
  build(s.skin, s.scattering, reach, sigma);
  const float smooth = 2 * view_.pixel;
  build(s.smooth, s.bodies, 3, {smooth, smooth, smooth});
}

void Renderer::light(Vec direction, float* image) {
  State& s = *state_;
  const auto pixels = alpha_.size();
  std::fill(image, image + 3 * pixels, 0.f);
  std::fill(s.irradiance.begin(), s.irradiance.end(), Vec{});
  std::fill(s.bounced.begin(), s.bounced.end(), Vec{});
  const auto [a, b] = frame(direction);
  const float share = 1 / float(view_.samples);

  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  Rays rays;
  s.dark.assign(s.hits.size(), 1);
  const auto flush = [&](std::vector<char>& dark) {
    if (!rays.count) return;
    for (int i = 0; i < 16; ++i) rays.valid[i] = i < rays.count ? -1 : 0;
    rtcOccluded16(rays.valid, s.scene, &context, &rays.rays);
    for (int i = 0; i < rays.count; ++i) dark[rays.owner[i]] = rays.rays.tfar[i] < 0;
    rays.count = 0;
  };
  const auto ask = [&](std::vector<char>& dark, std::size_t owner, Vec from, Vec to, float start) {
    const int i = rays.count++;
    rays.owner[i] = owner;
    rays.rays.org_x[i] = from.x, rays.rays.org_y[i] = from.y, rays.rays.org_z[i] = from.z;
    rays.rays.dir_x[i] = to.x, rays.rays.dir_y[i] = to.y, rays.rays.dir_z[i] = to.z;
    rays.rays.tnear[i] = start, rays.rays.tfar[i] = std::numeric_limits<float>::infinity();
    rays.rays.time[i] = 0, rays.rays.mask[i] = ~0u, rays.rays.id[i] = 0, rays.rays.flags[i] = 0;
    if (rays.count == 16) flush(dark);
  };
  const auto toward = [&](const auto& hit) {
    return normalize(direction + hit.disc_x * a + hit.disc_y * b);
  };
  for (std::size_t i = 0; i < s.hits.size(); ++i) {
    const Hit& hit = s.hits[i];
    const Vec l = toward(hit);
    if (hit.material.part != Part::hair && dot(hit.normal, l) <= 0) continue;
    if (hit.material.part == Part::hair)
      ask(s.dark, i, hit.at, l, hit.shadow_start);
    else
      ask(s.dark, i, hit.at + 0.01f * hit.geometric, l, hit.shadow_start);
  }
  flush(s.dark);
  for (std::size_t i = 0; i < s.hits.size(); ++i) {
    if (s.dark[i]) continue;
    const Hit& hit = s.hits[i];
    const Vec l = toward(hit);
    const auto p = std::size_t(hit.pixel);
    Vec out;
    if (hit.material.part == Part::hair) {
      out = fiber(hit.material, hit.tangent, hit.view, l);
    } else {
      const float cosine = dot(hit.normal, l);
      if (hit.material.part == Part::skin)
        s.irradiance[p] += (cosine / float(s.scattering[p])) * Vec{1, 1, 1};
      else
        out = (cosine / kPi) * hit.material.albedo;
      if (hit.material.f0 > 0) {
        const float shine = specular(hit.material, hit.normal, hit.view, l);
        out += Vec{shine, shine, shine};
      }
    }
    image[p] += share * out.x;
    image[pixels + p] += share * out.y;
    image[2 * pixels + p] += share * out.z;
  }

  s.dark.assign(s.bounces.size(), 1);
  for (std::size_t i = 0; i < s.bounces.size(); ++i) {
    const Bounce& at = s.bounces[i];
    if (dot(at.normal, direction) <= 0) continue;
    ask(s.dark, i, at.at + 0.01f * at.geometric, toward(at), at.start);
  }
  flush(s.dark);
  for (std::size_t i = 0; i < s.bounces.size(); ++i) {
    if (s.dark[i]) continue;
    const Bounce& at = s.bounces[i];
    const auto p = std::size_t(at.pixel);
    s.bounced[p] += (dot(at.normal, direction) / float(s.bodies[p])) * at.albedo;
  }
  if (!s.bounces.empty()) {
    s.smooth.apply(s.bounced, s.spread);
    for (std::size_t p = 0; p < pixels; ++p) {
      if (!s.bodies[p]) continue;
      const Vec rest = s.body_sum[p] - s.albedo_sum[p];  // what does not scatter
      const Vec out = (1 / kPi) * (rest * s.spread[p]);
      image[p] += out.x, image[pixels + p] += out.y, image[2 * pixels + p] += out.z;
      if (s.scattering[p]) s.irradiance[p] += s.spread[p];
    }
  }
  s.skin.apply(s.irradiance, s.spread);
  for (std::size_t p = 0; p < pixels; ++p) {
    if (!s.scattering[p]) continue;
    const Vec out = (1 / kPi) * (s.albedo_sum[p] * s.spread[p]);
    image[p] += out.x, image[pixels + p] += out.y, image[2 * pixels + p] += out.z;
  }
}

}  // namespace inverse::olat
