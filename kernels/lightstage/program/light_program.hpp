// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace inverse {

/// A unit vector from the subject to a light, in camera axes: x right, y up, z to the camera.
using Direction = std::array<double, 3>;
/// Emitted light, linear RGB; 1 is the maximum.
using LightColor = std::array<float, 3>;

/// One light of a stage.
struct StageLight {
  Direction direction{};
  /// DMX slots, counted from 1 over universes of 512: 513 is the first of the second universe. One
  /// channel is gray, three are RGB, four RGB and white. Empty: not driven by DMX.
  std::vector<uint32_t> channels;
};

/// Pattern of the lights in a step.
enum class StepKind : uint8_t {
  olat,        ///< one light at a time: `light` alone, white
  gradient_a,  ///< every light ((1 + θx)/2, (1 + θy)/2, (1 + θz)/2), θ its direction (7.3.1)
  gradient_b,  ///< ((1 − θx)/2, (1 − θy)/2, (1 − θz)/2)
  tracking,    ///< full on, white: optical flow is measured between these (7.3.2)
  black,
  custom,  ///< `colors`
};
/// "olat", "gradient-a", "gradient-b", "tracking", "black", "custom".
const char* name_of(StepKind kind);

struct LightStep {
  StepKind kind = StepKind::black;
  uint32_t light = 0;              ///< of olat: index of the light
  std::vector<LightColor> colors;  ///< of custom: one per light
  std::optional<double> exposure;  ///< overrides the program's, seconds
  std::optional<double> guard;     ///< overrides the program's, seconds
};

/// Light patterns of a stage, one per camera trigger: a marker that shows where the program starts,
/// then the steps, repeated `repeat` times. One step is one frame of a camera.
///
/// As JSON: docs/reference/light-program.md.
struct LightProgram {
  static constexpr size_t kMaxLights = 4096, kMaxSteps = 65536;
  static constexpr size_t kMaxFileBytes = size_t{64} << 20;
  /// Black, full on, black.
  static constexpr uint32_t kMarkerSteps = 3;
  enum class Marker : uint8_t {
    none,
    start,
    pass
  };  ///< never, once, before every pass of the steps

  std::string name;
  uint32_t rate_numerator = 60, rate_denominator = 1;  ///< steps a second
  double exposure = 0;  ///< shutter time in a step, seconds; 0: unknown
  double guard = 0;     ///< seconds from a change of the lights to the opening of the shutter
  Marker marker = Marker::start;
  uint64_t repeat = 1;  ///< passes of the steps; 0: endless
  std::vector<StageLight> lights;
  std::vector<LightStep> steps;

  /// Normalizes the directions. Throws Error(file) for: no lights or steps; directions whose length
  /// differs from 1 by more than 1e-3; lights with different numbers of channels; a channel used
  /// twice; a step with an unknown light or a wrong number of colors; colors outside of 0…1;
  /// exposure and guard longer than a step.
  void check();

  /// Reads JSON. Throws Error(file) with place and cause; messages call the text `name`.
  static LightProgram parse(std::string_view json, const std::string& name = "light program");
  static LightProgram load(const std::string& path);
  std::string json() const;
  void save(const std::string& path) const;

  /// A 64-bit hash of the whole program.
  uint64_t id() const;

  /// Position in the program at a trigger, counted from 0.
  struct Position {
    enum class Part : uint8_t { marker, step, ended } part = Part::ended;
    uint32_t index = 0;  ///< of the marker's three, or of `steps`
    uint64_t pass = 0;
  };
  Position at(uint64_t trigger) const;
  /// Number of triggers; empty for an endless program.
  std::optional<uint64_t> triggers() const;

  StepKind kind(Position position) const;
  /// Color of every light; black after the end of the program.
  std::vector<LightColor> colors(Position position) const;
  std::vector<LightColor> colors(const LightStep& step) const;
};

/// Vertices of a subdivided icosahedron of sufficient frequency, from the top down, without the
/// lowest ones, at the floor of a stage. 331 are the 362 of frequency 6 without 31.
std::vector<Direction> geodesic_directions(uint32_t count);

/// Lights in these directions with three channels each from channel 1 on; the channels of a light
/// are in one universe.
std::vector<StageLight> stage_lights(const std::vector<Direction>& directions);

/// The thesis' program for a static subject (7.3.2): every light once, a tracking frame after every
/// 11 lights and after the last, then the two gradients.
LightProgram static_capture(std::vector<StageLight> lights, uint32_t rate = 60);

/// The thesis' program for performances: gradients A and B, endless.
LightProgram performance(std::vector<StageLight> lights, uint32_t rate = 60);

/// Makes "performance" or "static" with 331 lights, with N lights ("performance:96"), or with those
/// of a folder's lights.json ("performance:FOLDER", LightList), at `rate` steps per second. Any
/// other text is the path of a program file. Throws Error(file).
LightProgram light_program(const std::string& name_or_path, uint32_t rate = 60);
/// Whether the text names a built-in program, not a file.
bool is_built_in_program(const std::string& name_or_path);

}  // namespace inverse
