#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "traces/scene/scene.h"
#include "traces/scenes/forest/things.h"
#include "traces/scenes/modelling/plants.h"

namespace traces::forest {

inline constexpr std::uint32_t kTriangles = 174'000;

/// Returns the height of the ground: uneven, but flat in the clearing.
float ground(float x, float z);
inline glm::vec3 on_ground(float x, float z, float above = 0) { return {x, ground(x, z) + above, z}; }

/// The generator's state: the scene and its detail.
class Forest {
 public:
  Forest(Scene& scene, std::uint32_t triangles)
      : scene_(scene),
        triangles_(triangles),
        detail_(std::sqrt(static_cast<float>(triangles) / static_cast<float>(kTriangles))) {}

  void build();

 private:
  std::uint32_t fine(float n, std::uint32_t least) const {
    return std::max(static_cast<std::uint32_t>(n * detail_ + 0.5F), least);
  }

  /// Returns a number of objects: n, or fewer in a scene of few triangles.
  std::uint32_t few(float n) const { return static_cast<std::uint32_t>(n * std::min(detail_, 1.0F) + 0.5F); }

  std::uint32_t material(Texture texture, float mirror = 0);

  void show(const Pieces& pieces, const glm::mat4& at, bool focus);

  void add_floor();
  /// Adds a panorama of deeper forest on all sides.
  void add_backdrop();
  void add_trees();
  void add_focus();
  void add_stones_and_logs();
  void add_ferns();
  void add_mushrooms();
  /// Adds undergrowth, bushes and canopy up to the wanted number of triangles.
  void fill();
  // `left`: remaining triangles.
  void add_undergrowth(float left);
  void add_bushes(float left);
  void add_canopy();

  struct Crown {
    std::vector<Twig> twigs;
    std::vector<glm::mat4> at;
  };
  Scene& scene_;
  std::uint32_t triangles_;
  float detail_;
  std::vector<Crown> crowns_;
  std::vector<std::uint32_t> caps_, rocks_;
  std::uint32_t gills_ = 0, stem_ = 0, log_bark_ = 0, litter_ = 0;
};

}  // namespace traces::forest
