#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// A thin stem from `foot` to `tip` that carries leaves.
struct Twig {
  glm::vec3 foot, tip;
};

/// Shape of a generated tree. Lengths are in metres; the foot is at the origin.
struct TreeShape {
  float height = 9;
  float girth = 0.3F;     ///< radius of the trunk at the ground
  float bare = 0.3F;      ///< fraction of the trunk's height without branches
  float reach = 3;        ///< length of the longest branch
  float rise = 0.5F;      ///< slope of the branches: 0 is horizontal, negative drooping
  float taper = 0;        ///< 0: a round crown; 1: branches get shorter towards the top, as on a fir
  float crooked = 0.15F;  ///< how much trunk and branches deviate from straight lines
  std::uint32_t branches = 11;
  std::uint32_t twigs = 6;  ///< number of twigs per branch
  std::uint32_t sides = 8;  ///< sides of the trunk's tube; branches have fewer
  std::uint64_t seed = 1;
};

struct Tree {
  Mesh wood;
  std::vector<Twig> twigs;
};

/// Makes a tree's trunk, branches and twigs as tubes. Bark repeats once around the trunk and every `bark` metres along.
Tree make_tree(std::string name, const TreeShape& shape, float bark = 1);

/// Shape of the leaves of a tree. Each leaf is two triangles. Leaves are spread over the twigs with random rotation and
/// face roughly away from `centre`. Each leaf shows a different small piece of the texture, so that colours vary.
struct LeafShape {
  float length = 0.25F, width = 0.14F;
  float scatter = 0.3F;  ///< largest distance of a leaf from its twig
  float along = 0.3F;    ///< direction of leaves; 1: parallel to the twig, as needles are
};
Mesh make_leaves(std::string name, std::span<const Twig> twigs, std::uint32_t count, const LeafShape& shape,
                 const glm::vec3& centre, std::uint64_t seed);

/// Adds a leaf to `mesh`: two triangles folded lengthwise, from `foot` to `foot + length`, `half_width` to each side.
void add_leaf(Mesh& mesh, const glm::vec3& foot, const glm::vec3& length, const glm::vec3& half_width,
              const glm::vec3& normal, const glm::vec2& uv, float uv_size);

/// Returns the twigs of a bush, which point out of a half dome.
std::vector<Twig> dome_twigs(const glm::vec3& radii, std::uint32_t count, std::uint64_t seed);

/// Makes bent blades of grass within `radius`, up to `height` high. Each has 2 x `segments` - 1 triangles.
Mesh make_grass(std::string name, std::uint32_t blades, std::uint32_t segments, float radius, float height, float width,
                std::uint64_t seed);

/// Makes a rock: a sphere displaced by noise, with its lowest fifth below y = 0.
Mesh make_rock(std::string name, const glm::vec3& radii, std::uint32_t cells, float rough, std::uint32_t seed);

/// Returns a texture of leaves in close-up, from `dark` to `light`. Colours are 0 to 1; it can be tiled.
Texture foliage_texture(std::string name, const glm::vec3& dark, const glm::vec3& light, std::uint32_t seed,
                        std::uint32_t size = 256);
/// Returns a texture of bark with furrows along v. It can be tiled.
Texture bark_texture(std::string name, const glm::vec3& dark, const glm::vec3& light, std::uint32_t furrows,
                     std::uint32_t seed, std::uint32_t size = 512);

}  // namespace traces
