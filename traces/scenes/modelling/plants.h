#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// A thin stem from `foot` to `tip` that leaves can sit on.
struct Twig {
  glm::vec3 foot, tip;
};

/// Shape of a tree; lengths in metres, its foot at the origin.
struct TreeShape {
  float height = 9;
  float girth = 0.3F;     ///< radius of the trunk at the ground
  float bare = 0.3F;      ///< share of the trunk that carries no branches
  float reach = 3;        ///< length of the longest branch
  float rise = 0.5F;      ///< slope of the branches: 0 horizontal, below 0 drooping
  float taper = 0;        ///< 0: a round crown, 1: branches shrink towards the top as on a fir
  float crooked = 0.15F;  ///< how far the wood strays from straight
  std::uint32_t branches = 11;
  std::uint32_t twigs = 6;  ///< on each branch
  std::uint32_t sides = 8;  ///< sides of the trunk's tube; branches have fewer
  std::uint64_t seed = 1;
};

struct Tree {
  Mesh wood;
  std::vector<Twig> twigs;
};

/// Trunk, branches and twigs as tubes. Bark repeats once round the trunk and every `bark` metres along it.
Tree make_tree(std::string name, const TreeShape& shape, float bark = 1);

/// Leaves of two triangles, spread over the twigs and turned by chance, facing more or less away from `centre`. Each
/// shows a small piece of the texture from elsewhere, so that no two have the same colour.
struct LeafShape {
  float length = 0.25F, width = 0.14F;
  float scatter = 0.3F;  ///< distance from the twig
  float along = 0.3F;    ///< 1: they lie along the twig, as needles do
};
Mesh make_leaves(std::string name, std::span<const Twig> twigs, std::uint32_t count, const LeafShape& shape,
                 const glm::vec3& centre, std::uint64_t seed);

/// Adds a leaf: a lengthwise folded blade of two triangles from `foot` to `foot + length`, `half_width` to each side.
void add_leaf(Mesh& mesh, const glm::vec3& foot, const glm::vec3& length, const glm::vec3& half_width,
              const glm::vec3& normal, const glm::vec2& uv, float uv_size);

/// Twigs that stand out of a half dome, for bushes.
std::vector<Twig> dome_twigs(const glm::vec3& radii, std::uint32_t count, std::uint64_t seed);

/// Bent blades of grass within `radius`, each of 2 x `segments` - 1 triangles, up to `height` high.
Mesh make_grass(std::string name, std::uint32_t blades, std::uint32_t segments, float radius, float height, float width,
                std::uint64_t seed);

/// A lump: a sphere pushed in and out by noise, resting on y = 0 with its lower fifth below.
Mesh make_rock(std::string name, const glm::vec3& radii, std::uint32_t cells, float rough, std::uint32_t seed);

/// Leaves seen from near, from dark to light, in 0..1 colours, tileable.
Texture foliage_texture(std::string name, const glm::vec3& dark, const glm::vec3& light, std::uint32_t seed,
                        std::uint32_t size = 256);
/// Bark with furrows along v, tileable.
Texture bark_texture(std::string name, const glm::vec3& dark, const glm::vec3& light, std::uint32_t furrows,
                     std::uint32_t seed, std::uint32_t size = 512);

}  // namespace traces
