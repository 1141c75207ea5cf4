// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sample.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "background.hpp"
#include "blinn_phong.hpp"
#include "raster.hpp"
#include "room.hpp"
#include "shapes.hpp"

namespace inverse::lime {
namespace {

/// Streams of random numbers, so that a change to one thing leaves the others as they are.
enum Stream {
  kShape,
  kPose,
  kLight,
  kMaterial,
  kBackground,
  kSensor,
  kPaint,
  kSurroundings,
  kPrint,
  kFraming,
  kPale
};

/// Subpixels along a pixel's side.
constexpr int kOversampling = 2;

struct Lighting {
  Environment map;
  int name;
};

Lighting draw_light(Random& random, const std::vector<NamedMap>& maps, bool held_out) {
  std::vector<int> usable;
  for (std::size_t i = 0; i < maps.size(); ++i)
    if (maps[i].held_out == held_out) usable.push_back(int(i));
  if (usable.empty() || random.chance(0.55f)) return {make_room(random), -1};
  const int name = usable[std::size_t(random.below(int(usable.size())))];
  Environment turned;
  for (int attempt = 0; attempt < 12; ++attempt) {
    const int columns = random.below(Environment::kColumns);
    turned = turn(maps[std::size_t(name)].map, columns, random.chance(0.5f));
    if (is_lit_from_front(turned)) break;
  }
  balance_white(turned, random.uniform(0.6f, 1.f));
  return {std::move(turned), name};
}

void draw_material(Random& random, Parameters& p) {
  do {  // uniform in YUV within the cube of plausible RGB
    const float y = random.uniform(0.05f, 0.9f), u = random.uniform(-0.436f, 0.436f),
                v = random.uniform(-0.615f, 0.615f);
    p.diffuse[0] = y + 1.13983f * v;
    p.diffuse[1] = y - 0.39465f * u - 0.5806f * v;
    p.diffuse[2] = y + 2.03211f * u;
  } while (*std::min_element(p.diffuse, p.diffuse + 3) < 0.02f ||
           *std::max_element(p.diffuse, p.diffuse + 3) > 0.95f);
  p.alpha = random.uniform(0.03f, 0.9f);
  const int bin = random.below(8);
  p.bin = float(bin);
  p.shininess = std::exp2(1 + 9 * (float(bin) + random.uniform()) / 8);
  p.specular = p.shininess > 8 ? p.alpha * (p.shininess + 8) / 16 : p.alpha;
  p.ambient = random.chance(0.5f) ? 0.f : random.uniform(0.f, 0.05f);
}

/// What most things are that people make: white, gray or black, with a hint of m_d's color.
void make_pale(Random& random, Parameters& p) {
  const float gray = random.uniform(0.04f, 0.9f), share = random.uniform(0.f, 0.3f);
  const float mean = (p.diffuse[0] + p.diffuse[1] + p.diffuse[2]) / 3;
  for (float& c : p.diffuse) c = std::clamp(gray + share * (c - mean), 0.02f, 0.95f);
}

struct View {
  Camera camera;
  Pose pose;
};

/// The sphere around the object fills 48 … 98 % of the picture (8 % of them less; `scale` of that),
/// seldom reaches over its edge unless it is larger than the picture, and may lie off the axis of
/// the lens, as in a crop from a larger picture.
View draw_view(Random& random, bool upright, float scale, int size) {
  const float half = 0.5f * float(size);
  const float focal = random.log_uniform(2.2f, 6.f) * half;  // 49° … 19° across
  const float radius =
      scale * (random.chance(0.08f) ? random.uniform(0.24f, 0.45f) : random.uniform(0.48f, 0.98f));
  const float room = scale > 1 ? std::max(radius - 0.6f, 0.3f)
                               : std::clamp(1.04f - radius, 0.05f, scale < 1 ? 0.7f : 0.3f);
  const float x = random.uniform(-room, room), y = random.uniform(-room, room);
  const bool crop = random.chance(0.35f);
  const float off_x = crop ? random.uniform(-1.f, 1.f) : 0.f,
              off_y = crop ? random.uniform(-0.7f, 0.7f) : 0.f;

  Rotation turn;
  if (upright && random.chance(0.6f)) {
    // The lathe's z becomes the picture's up, then leans toward or away from the camera.
    const float lean = random.uniform(-0.3f, 0.7f) - 0.5f * kPi, roll = 0.2f * random.normal(),
                spin = random.uniform(0.f, 2 * kPi);
    const Rotation a = rotation_of({std::cos(spin / 2), 0, 0, std::sin(spin / 2)});
    const Rotation b = rotation_of({std::cos(lean / 2), std::sin(lean / 2), 0, 0});
    const Rotation c = rotation_of({std::cos(roll / 2), 0, 0, std::sin(roll / 2)});
    const auto column = [&](Vec v) { return c(b(a(v))); };
    const Vec i = column({1, 0, 0}), j = column({0, 1, 0}), k = column({0, 0, 1});
    turn.rows = {Vec{i.x, j.x, k.x}, Vec{i.y, j.y, k.y}, Vec{i.z, j.z, k.z}};
  } else {
    turn = rotation_of(random.quaternion());
  }
  const Camera camera{focal, half - off_x * half, half - off_y * half};
  // A sphere of radius 1 at distance d covers focal / sqrt(d² − 1) on the axis.
  const float distance = std::sqrt(1 + (focal * focal) / (radius * half * radius * half));
  const Vec position{(x + off_x) * half / focal * distance, -(y + off_y) * half / focal * distance,
                     -distance};
  return {camera, {turn, 1, position}};
}

/// Share of the picture that is covered.
float share_of(const Raster& raster) {
  int covered = 0;
  for (int y = 0; y < raster.size(); ++y)
    for (int x = 0; x < raster.size(); ++x) covered += raster.covered(x, y);
  return float(covered) / float(raster.size() * raster.size());
}

/// What one pixel shows of the object; means over its covered subpixels.
struct Pixel {
  float coverage = 0;
  Vec diffuse, specular, mirror;
};

std::vector<Pixel> shade(const Raster& raster, const Camera& camera, const Environment& map,
                         float shininess) {
  // Texels of 7.5° are fine enough for D and for wide lobes; of 3.75° for narrow ones (s =
  // 1024: 8.4° between half maxima).
  const Lights wide(shrink(map, 24));
  const Lights narrow(shrink(map, shininess > 100 ? 48 : 24));
  // Subpixels are shaded one by one only where the lobe resolves the difference of their normals.
  const float spread = std::min(0.35f / std::sqrt(shininess), 0.12f),
              flat = 1 - 0.5f * spread * spread;
  const int size = raster.size() / kOversampling;
  std::vector<Pixel> pixels(std::size_t(size * size));
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      std::array<Vec, kOversampling * kOversampling> normals, views;
      int count = 0;
      Vec normal, view;
      for (int k = 0; k < kOversampling * kOversampling; ++k) {
        const int x = kOversampling * column + k % kOversampling,
                  y = kOversampling * row + k / kOversampling;
        if (!raster.covered(x, y)) continue;
        const Vec o = camera.view(x, y);
        Vec n = normalize(raster.normal(x, y));
        // Interpolated normals may face away at the silhouette: turned until they are seen edge-on.
        if (const float facing = dot(n, o); facing < 0.01f) n = normalize(n + (0.01f - facing) * o);
        normals[std::size_t(count)] = n;
        views[std::size_t(count++)] = o;
        normal += n;
        view += o;
      }
      if (count == 0) continue;
      normal = normalize(normal);
      view = normalize(view);
      bool is_flat = true;
      for (int k = 0; k < count; ++k) is_flat &= dot(normal, normals[std::size_t(k)]) > flat;
      if (is_flat) {
        normals[0] = normal;
        views[0] = view;
      }
      const int points = is_flat ? 1 : count;
      Pixel& pixel = pixels[std::size_t(row * size + column)];
      for (int k = 0; k < points; ++k) {
        const Vec n = normals[std::size_t(k)], o = views[std::size_t(k)];
        pixel.diffuse += wide.diffuse(n);
        pixel.specular += narrow.specular(n, o, shininess);
        pixel.mirror += map.look(2 * dot(n, o) * n - o);
      }
      const float share = 1 / float(points);
      pixel.diffuse = share * pixel.diffuse;
      pixel.specular = share * pixel.specular;
      pixel.mirror = share * pixel.mirror;
      pixel.coverage = float(count) / float(kOversampling * kOversampling);
    }
  return pixels;
}

/// The object in as many albedos as it has pixels: m_d becomes their mean, and D what makes m_d D
/// the painted one's.
void wear(const std::vector<Vec>& albedo, std::vector<Pixel>& pixels, Parameters& p) {
  Vec mean;
  float area = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    mean += pixels[i].coverage * albedo[i];
    area += pixels[i].coverage;
  }
  if (area == 0) return;
  constexpr float kLeast = 0.02f;  // as of other objects
  const auto limit = [&](float v) { return std::max(v / area, kLeast); };
  mean = {limit(mean.x), limit(mean.y), limit(mean.z)};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Vec a = albedo[i];
    pixels[i].diffuse = Vec{a.x / mean.x, a.y / mean.y, a.z / mean.z} * pixels[i].diffuse;
  }
  p.diffuse[0] = mean.x;
  p.diffuse[1] = mean.y;
  p.diffuse[2] = mean.z;
}

/// A picture of the kind that backgrounds are, more or less of it over the object's own color.
std::vector<Vec> paint(Random& random, const Environment& map, int size, Vec own) {
  std::vector<Vec> albedo = make_background(random, size, map);
  const float share = random.uniform(0.1f, 0.9f);
  for (Vec& a : albedo) a = own + share * (a - own);
  return albedo;
}

/// Mean of D at 0.45 … 0.95, but no more than leaves 98 % of the object's values below white; a
/// fifth of the pictures are exposed differently by up to 0.4 stops. k absorbs 1/π and the camera's
/// gain.
float draw_exposure(Random& random, const std::vector<Pixel>& pixels, const Parameters& p) {
  double mean = 0;
  std::vector<float> values;
  const Vec albedo{p.diffuse[0], p.diffuse[1], p.diffuse[2]};
  for (const Pixel& pixel : pixels)
    if (pixel.coverage > 0) {
      mean += double(pixel.diffuse.x + pixel.diffuse.y + pixel.diffuse.z);
      const Vec v = albedo * pixel.diffuse + p.specular * pixel.specular;
      values.insert(values.end(), {v.x, v.y, v.z});
    }
  const float level = random.uniform(0.45f, 0.95f);
  const float jitter = random.chance(0.2f) ? std::exp2(random.uniform(-0.4f, 0.4f)) : 1.f;
  if (values.empty()) return 1;
  mean /= double(values.size());
  const auto rank = values.begin() + std::ptrdiff_t(0.98 * double(values.size() - 1));
  std::nth_element(values.begin(), rank, values.end());
  return jitter *
         std::min(level / std::max(float(mean), 1e-9f), (1 - p.ambient) / std::max(*rank, 1e-9f));
}

/// A soft shadow below the object, as on a table that it stands on, or beside it on a wall.
void throw_shadow(Random& random, int size, const std::vector<Pixel>& pixels,
                  std::vector<Vec>& background) {
  float left = 1, right = 0, bottom = 0;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column)
      if (pixels[std::size_t(row * size + column)].coverage > 0) {
        left = std::min(left, float(column) / float(size));
        right = std::max(right, float(column) / float(size));
        bottom = std::max(bottom, float(row) / float(size));
      }
  if (right <= left) return;
  const float wide = right - left;
  const float x = 0.5f * (left + right) + wide * random.uniform(-0.5f, 0.5f),
              y = bottom - wide * random.uniform(0.f, 0.25f), a = wide * random.uniform(0.4f, 1.f),
              b = wide * random.uniform(0.08f, 0.4f), dark = random.uniform(0.15f, 0.8f),
              soft = random.uniform(0.2f, 1.f);
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const float u = ((float(column) + 0.5f) / float(size) - x) / a,
                  v = ((float(row) + 0.5f) / float(size) - y) / b;
      const float inside = std::clamp((1 - std::sqrt(u * u + v * v)) / soft, 0.f, 1.f);
      Vec& p = background[std::size_t(row * size + column)];
      p = (1 - dark * inside) * p;
    }
}

/// Exposure and white balance of a camera that was not set for the object.
void misadjust(Random& random, std::vector<Vec>& linear) {
  const float exposure = random.chance(0.4f) ? std::exp2(random.uniform(-3.f, 0.5f)) : 1.f;
  const auto gain = [&] { return exposure * std::exp2(random.uniform(-0.3f, 0.3f)); };
  const Vec gains{gain(), gain(), gain()};
  for (Vec& p : linear) p = gains * p;
}

/// A third of the lenses blur by the kernel 1 2 1; a border keeps its pixels.
void blur(int size, std::vector<Vec>& pixels) {
  for (const int step : {1, size}) {
    std::vector<Vec> in = pixels;
    for (int row = 1; row + 1 < size; ++row)
      for (int column = 1; column + 1 < size; ++column) {
        const auto i = std::size_t(row * size + column), s = std::size_t(step);
        pixels[i] = 0.25f * (in[i - s] + 2 * in[i] + in[i + s]);
      }
  }
}

/// sRGB's transfer curve, 8 bit, by a table over the square root.
std::uint8_t encode(float linear) {
  static const std::array<std::uint8_t, 4097> table = [] {
    std::array<std::uint8_t, 4097> t{};
    for (int i = 0; i <= 4096; ++i) {
      const double x = double(i) / 4096 * double(i) / 4096;
      const double y = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
      t[std::size_t(i)] = std::uint8_t(std::lround(255 * y));
    }
    return t;
  }();
  return table[std::size_t(std::sqrt(std::clamp(linear, 0.f, 1.f)) * 4096 + 0.5f)];
}

void expose(Random& random, int size, bool clean, std::vector<Vec>& linear, std::uint8_t* image) {
  const bool soft = random.chance(0.3f), noisy = random.chance(0.7f);
  const float read = std::pow(10.f, random.uniform(-4.f, -2.3f)),
              shot = std::pow(10.f, random.uniform(-5.f, -3.f));
  if (soft && !clean) blur(size, linear);
  const auto plane = std::size_t(size * size);
  for (std::size_t i = 0; i < plane; ++i) {
    std::array<float, 3> rgb{linear[i].x, linear[i].y, linear[i].z};
    for (std::size_t c = 0; c < 3; ++c) {
      if (noisy && !clean)
        rgb[c] += std::sqrt(read * read + shot * std::max(rgb[c], 0.f)) * random.rough_normal();
      image[c * plane + i] = encode(rgb[c]);
    }
  }
}

/// A frame of 16:9 to 5:4, seldom upright, in the square as limematerial has it: its first and last
/// rows (or columns) go on beyond it.
void letterbox(Random& random, int size, const Images& images) {
  const int kept = int(float(size) * random.uniform(0.55f, 0.8f)), first = (size - kept) / 2;
  const bool upright = random.chance(0.2f);
  const int across = upright ? size : 1, along = upright ? 1 : size;
  for (std::uint8_t* plane :
       {images.image, images.image + size * size, images.image + 2 * size * size, images.coverage})
    for (int line = 0; line < size; ++line)
      for (int i = 0; i < size; ++i)
        plane[line * along + i * across] =
            plane[std::clamp(line, first, first + kept - 1) * along + i * across];
}

}  // namespace

void render(const Request& request, const std::vector<NamedMap>& maps, const Images& images,
            Parameters& parameters) {
  // Test samples have a seed space of their own; shapes and maps are told apart below.
  const bool held_out = request.split == Split::test;
  const std::uint64_t seed = 2 * request.seed + held_out;
  const auto stream = [&](Stream s) { return Random(seed, request.index, std::uint64_t(s)); };
  Random shape = stream(kShape), pose = stream(kPose), light = stream(kLight),
         material = stream(kMaterial);
  Random background = stream(kBackground), sensor = stream(kSensor), brush = stream(kPaint),
         surroundings = stream(kSurroundings), print = stream(kPrint), framing = stream(kFraming),
         pale = stream(kPale);

  parameters = {};
  const Object object = make_object(shape, held_out);
  const Lighting lighting = draw_light(light, maps, held_out);
  draw_material(material, parameters);
  const bool is_pale = request.everyday && pale.chance(0.3f);
  if (is_pale) make_pale(pale, parameters);
  parameters.family = float(object.family);
  parameters.trait = object.trait;
  parameters.map = float(lighting.name);
  float scale = 1;
  if (request.whole_frame)
    scale = surroundings.chance(0.33f) ? surroundings.uniform(0.3f, 0.8f)
            : framing.chance(0.3f)     ? framing.uniform(1.2f, 2.2f)
                                       : 1.f;
  View view = draw_view(pose, object.upright, scale, kOversampling * request.size);
  const bool is_empty = request.whole_frame && (pose.chance(0.05f) || framing.chance(0.1f));
  parameters.empty = float(is_empty);

  const auto drawn = [&] {
    Raster raster(kOversampling * request.size);
    if (!is_empty)
      for (const Grid& part : object.parts) raster.draw(part, view.pose, view.camera);
    return raster;
  };
  Raster raster = drawn();
  // What fills the picture could as well be the background.
  for (int attempt = 0; attempt < 3 && scale > 1 && share_of(raster) > 0.7f; ++attempt) {
    view = draw_view(framing, object.upright, scale, kOversampling * request.size);
    raster = drawn();
  }
  std::vector<Pixel> pixels = shade(raster, view.camera, lighting.map, parameters.shininess);
  const auto plane = std::size_t(request.size * request.size);
  const Vec own{parameters.diffuse[0], parameters.diffuse[1], parameters.diffuse[2]};
  std::vector<Vec> albedo;
  if (request.may_be_painted && brush.chance(0.25f))
    albedo = paint(brush, lighting.map, request.size, own);
  const bool is_marked = request.everyday && print.chance(0.25f);
  if (is_marked) {
    if (albedo.empty()) albedo.assign(plane, own);
    print_marks(print, request.size, albedo);
  }
  if (!albedo.empty()) wear(albedo, pixels, parameters);
  if (request.everyday && print.chance(is_pale || is_marked ? 0.4f : 0.12f))
    parameters.alpha = parameters.specular = 0;
  const float k = parameters.exposure = draw_exposure(sensor, pixels, parameters);

  std::vector<Vec> linear = request.whole_frame && surroundings.chance(0.4f)
                                ? make_plain_background(surroundings, request.size)
                                : make_background(background, request.size, lighting.map);
  if (request.whole_frame && surroundings.chance(0.4f))
    throw_shadow(surroundings, request.size, pixels, linear);
  const Vec diffuse{parameters.diffuse[0], parameters.diffuse[1], parameters.diffuse[2]};
  const Vec ambient{parameters.ambient, parameters.ambient, parameters.ambient};
  for (std::size_t i = 0; i < plane; ++i) {
    Pixel& p = pixels[i];
    p.diffuse = k * p.diffuse;
    p.specular = k * p.specular;
    p.mirror = k * p.mirror;
    const Vec lit = ambient + diffuse * p.diffuse + parameters.specular * p.specular;
    linear[i] = p.coverage * lit + (1 - p.coverage) * linear[i];
    images.coverage[i] = std::uint8_t(255 * p.coverage + 0.5f);
    const auto put = [&](float* to, Vec v) {
      to[i] = v.x;
      to[plane + i] = v.y;
      to[2 * plane + i] = v.z;
    };
    put(images.diffuse, p.diffuse);
    put(images.specular, p.specular);
    put(images.mirror, p.mirror);
  }
  if (request.whole_frame) misadjust(surroundings, linear);
  expose(sensor, request.size, request.clean, linear, images.image);
  if (request.whole_frame && framing.chance(0.5f)) letterbox(framing, request.size, images);
}

}  // namespace inverse::lime
