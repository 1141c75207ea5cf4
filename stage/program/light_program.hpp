#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace inverse {

/// A unit vector from the subject to a light, in the camera's directions: x right, y up, z to the
/// camera.
using Direction = std::array<double, 3>;
/// What a light emits, linear RGB; 1 is all it can.
using LightColor = std::array<float, 3>;

/// One light of a stage.
struct StageLight {
  Direction direction{};
  /// Where a controller finds its red, green and blue, counted from 1 over universes of 512 (DMX
  /// slots): 513 is the first of the second universe. One channel is gray, three are RGB, four RGB
  /// and white. Empty: it is not driven by channels.
  std::vector<uint32_t> channels;
};

/// What lights do in a step.
enum class StepKind : uint8_t {
  olat,        ///< one light at a time: `light` alone, white
  gradient_a,  ///< every light ((1 + θx)/2, (1 + θy)/2, (1 + θz)/2), θ its direction (7.3.1)
  gradient_b,  ///< ((1 − θx)/2, (1 − θy)/2, (1 − θz)/2)
  tracking,    ///< full on, white: what flow between frames is measured in (7.3.2)
  black,
  custom,  ///< `colors`
};
/// "olat", "gradient-a", "gradient-b", "tracking", "black", "custom".
const char* name_of(StepKind kind);

struct LightStep {
  StepKind kind = StepKind::black;
  uint32_t light = 0;              ///< of olat: which light
  std::vector<LightColor> colors;  ///< of custom: one for each light
  std::optional<double> exposure;  ///< in place of the program's
  std::optional<double> guard;     ///< the same
};

/// What the lights of a stage do from one trigger of the cameras to the next: a marker that shows
/// where the program starts, and steps, once or again and again. One step is one frame of a camera.
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
  double exposure = 0;  ///< seconds that a shutter is open in a step; 0: it is not known
  double guard = 0;     ///< seconds from a change of the lights to the opening of the shutter
  Marker marker = Marker::start;
  uint64_t repeat = 1;  ///< passes of the steps; 0: without end
  std::vector<StageLight> lights;
  std::vector<LightStep> steps;

  /// Throws Error(file) where it makes no sense: no lights or steps, directions that are not of
  /// length 1 (to 1e-3; they are made exactly so), lights with different numbers of channels or the
  /// same channel twice, steps that name lights that are not there or have another number of colors
  /// than lights, colors outside of 0…1, exposures and guards that do not fit into a step.
  void check();

  /// Reads JSON; throws Error(file) that says where and what. `name` is what the text calls it.
  static LightProgram parse(std::string_view json, const std::string& name = "light program");
  static LightProgram load(const std::string& path);
  std::string json() const;
  void save(const std::string& path) const;

  /// A fingerprint of all of it: programs with the same number are the same.
  uint64_t id() const;

  /// Where the program is at a trigger, counted from 0.
  struct Position {
    enum class Part : uint8_t { marker, step, ended } part = Part::ended;
    uint32_t index = 0;  ///< of the marker's three, or of `steps`
    uint64_t pass = 0;
  };
  Position at(uint64_t trigger) const;
  /// Triggers from start to end; nothing where it has none.
  std::optional<uint64_t> triggers() const;

  StepKind kind(Position position) const;
  /// What every light emits; black where the program has ended.
  std::vector<LightColor> colors(Position position) const;
  std::vector<LightColor> colors(const LightStep& step) const;
};

/// The vertices of an icosahedron whose edges are divided, as many as it takes, the lowest left out
/// where the stage has its floor: 331 are those of frequency 6 (362) without 31. From the top down.
std::vector<Direction> geodesic_directions(uint32_t count);

/// Lights in these directions, with three channels each from address 1 on; a light's channels are
/// in one universe.
std::vector<StageLight> stage_lights(const std::vector<Direction>& directions);

/// The thesis' program for a subject that keeps still (7.3.2): every light once, full on after
/// every 11 of them and after the last, then the two gradients.
LightProgram static_capture(std::vector<StageLight> lights, uint32_t rate = 60);

/// The thesis' program for performances: gradients A and B without end.
LightProgram performance(std::vector<StageLight> lights, uint32_t rate = 60);

/// "performance" and "static" with 331 lights, "performance:96" with as many as that,
/// "performance:FOLDER" with those of the folder's lights.json (LightList), at `rate` steps a
/// second; else the file of this path. Throws Error(file).
LightProgram light_program(const std::string& name_or_path, uint32_t rate = 60);
/// Whether that is no file's path.
bool is_built_in_program(const std::string& name_or_path);

}  // namespace inverse
