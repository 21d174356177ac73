#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "sim/config/field.h"
#include "sim/named.h"
#include "traces/scene/limits.h"
#include "traces/scene/scene.h"

namespace traces {

/// Which lights a run uses.
enum class LightRig : std::uint8_t {
  kScene,      ///< all lights of the scene
  kStrongest,  ///< only the light of the scene that makes the first camera's view brightest
  kPoint,      ///< a point light from the configuration instead of the scene's lights
  kSun,        ///< a directional light from the configuration instead of the scene's lights
};
constexpr std::array<std::string_view, 4> names_of(LightRig) { return {"scene", "strongest", "point", "sun"}; }

enum class Sky : std::uint8_t { kScene, kOwn };
constexpr std::array<std::string_view, 2> names_of(Sky) { return {"scene", "own"}; }

/// Whether rays hit the back faces of single-sided materials.
enum class BackFaces : std::uint8_t { kShown, kCulled };
constexpr std::array<std::string_view, 2> names_of(BackFaces) { return {"shown", "culled"}; }

enum class ViewSource : std::uint8_t { kScene, kOwn };
constexpr std::array<std::string_view, 2> names_of(ViewSource) { return {"scene", "own"}; }

enum class CameraPath : std::uint8_t {
  kScene,  ///< the camera moves as the scene animates it
  kOrbit,  ///< the camera circles the middle of the scene at constant distance and height
};
constexpr std::array<std::string_view, 2> names_of(CameraPath) { return {"scene", "orbit"}; }

struct LightsConfig {
  LightRig rig = LightRig::kScene;
  sim::Triple position{0, 10, 0};
  sim::Triple direction{-1, -2, -1};
  sim::Triple intensity{1, 1, 1};

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.rig), "",
          "lights of the run: the scene's, only the one that makes its first camera's view brightest, or a given point "
          "light or sun",
          sim::any(), Affects::kFunction);
    field(NAMED(c.position), "", "position of the given point light", sim::any(), Affects::kFunction);
    field(NAMED(c.direction), "", "direction in which the light of the given sun travels", sim::any(),
          Affects::kFunction);
    field(NAMED(c.intensity), "", "linear RGB; point: per steradian, sun: irradiance (1 makes white shine white)",
          sim::at_least(0), Affects::kFunction);
  }
  void check(auto&& complain) const {
    if (direction == sim::Triple{}) complain("direction", "0 0 0 points nowhere; allowed: any other direction");
  }
};

struct SkyConfig {
  Sky source = Sky::kScene;
  sim::Triple background{0.6, 0.7, 0.85};
  sim::Triple ambient{0.15, 0.15, 0.15};

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.source), "", "the scene's sky, or one given by the keys below", sim::any(), Affects::kFunction);
    field(NAMED(c.background), "", "linear RGB of rays that leave the scene, if own", sim::at_least(0),
          Affects::kFunction);
    field(NAMED(c.ambient), "", "linear RGB of constant irradiance on every surface, if own", sim::at_least(0),
          Affects::kFunction);
  }
};

struct ViewConfig {
  ViewSource source = ViewSource::kScene;
  sim::Triple position{0, 1, 5};
  sim::Triple target{0, 1, 0};
  sim::Triple up{0, 1, 0};
  double fov = 45;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    constexpr double kFar = 1e9;  // the largest distance, whose square is a finite float
    const sim::Limits anywhere = sim::between(-kFar, kFar);
    field(NAMED(c.source), "", "a camera of the scene, or one given by the keys below", sim::any(), Affects::kFunction);
    field(NAMED(c.position), "", "position of the given camera, in the scene's units", anywhere, Affects::kFunction);
    field(NAMED(c.target), "", "point that the given camera shows in the middle of its picture", anywhere,
          Affects::kFunction);
    field(NAMED(c.up), "", "upward direction of the given camera's picture", anywhere, Affects::kFunction);
    field(NAMED(c.fov), "degrees", "vertical field of view of the given camera", sim::between(0.01, 179),
          Affects::kFunction);
  }
  void check(auto&& complain) const {
    const sim::Triple to{target.x - position.x, target.y - position.y, target.z - position.z};
    if (to == sim::Triple{}) return complain("target", "is the camera's position; allowed: any other point");
    const sim::Triple right{to.y * up.z - to.z * up.y, to.z * up.x - to.x * up.z, to.x * up.y - to.y * up.x};
    if (right == sim::Triple{}) complain("up", "lies along the view, or is 0 0 0; allowed: any other direction");
  }
};

/// Configuration keys of a run's scene, camera and frames (group `scene`); also the content of a workload file.
struct WorkloadConfig {
  std::string name = "cornell";
  std::uint32_t triangles = 0;
  std::string camera;
  ViewConfig view;
  CameraPath camera_path = CameraPath::kScene;
  double orbit = 30;
  std::uint32_t first_frame = 0, last_frame = 0;
  double frame_rate = 30;
  BackFaces back_faces = BackFaces::kShown;
  LightsConfig lights;
  SkyConfig sky;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.name), "", "built-in scene, or a .gltf or .glb file (relative to the workload file)", sim::any(),
          Affects::kFunction);
    field(NAMED(c.triangles), "triangles",
          "approximate number of triangles of a built-in scene; 0: that of its class in the literature",
          sim::between(0, 67108864), Affects::kFunction);
    field(NAMED(c.camera), "", "camera of the scene, by name or index; empty: its first", sim::any(),
          Affects::kFunction);
    field(NAMED(c.camera_path), "", "motion of the camera: the scene's animation, or an orbit around the scene",
          sim::any(), Affects::kFunction);
    field(NAMED(c.orbit), "degrees/s", "angular speed of a camera on an orbit", sim::between(-3600, 3600),
          Affects::kFunction);
    field(NAMED(c.first_frame), "", "first frame rendered; frame 0 is time 0", sim::between(0, 1000000),
          Affects::kFunction);
    field(NAMED(c.last_frame), "", "last frame rendered", sim::between(0, 1000000), Affects::kFunction);
    field(NAMED(c.frame_rate), "frames/s", "frames per second of animation time, not of the machine",
          sim::between(0.01, 10000), Affects::kFunction);
    field(NAMED(c.back_faces), "",
          "back faces of single-sided materials (glTF doubleSided: false): hit by rays, or passed through; materials "
          "that transmit light keep both faces",
          sim::any(), Affects::kFunction);
    field.group(NAMED(c.view), "camera instead of the scene's");
    field.group(NAMED(c.lights), "lights instead of the scene's");
    field.group(NAMED(c.sky), "sky instead of the scene's");
  }
  void check(auto&& complain) const {
    if (!camera.empty() && view.source == ViewSource::kOwn) {
      complain("camera", "names one of the scene's, and view.source is own; allowed: one of the two");
    }
    if (last_frame < first_frame) complain("last_frame", "is before first_frame; allowed: first_frame and later");
  }

  double seconds_of(std::uint32_t frame) const { return frame / frame_rate; }
};

/// Opens a workload's scene with its lights and sky, posed at its first frame. Its camera becomes the only entry of
/// Scene::cameras. Throws InputError, listing the valid names, for an unknown scene or camera.
Scene open_workload(const WorkloadConfig& workload, const SceneLimits& limits = {});

/// Poses a workload's scene at frame `frame`. Returns what has moved.
Moved pose_workload(Scene& scene, const WorkloadConfig& workload, std::uint32_t frame);

}  // namespace traces
