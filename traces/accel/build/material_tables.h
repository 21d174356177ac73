#pragma once
#include <cstdint>
#include <vector>

#include "traces/accel/memory_image.h"

namespace traces {

/// The material records of a scene, and which optional data its materials need.
struct MaterialTables {
  std::vector<MaterialRecord> records;        ///< one record per material, at least one
  std::vector<MaterialDetailRecord> details;  ///< empty if no material needs details, otherwise one entry per record
  bool needs_vertices = false;                ///< some material needs vertex records (kVertexed)
  bool needs_white = false;                   ///< some triangle needs a transparency test but has no base texture
  bool needs_density = false;                 ///< normals have the texture density as their length
};

/// Builds the material tables of a scene. Throws sim::InputError if a material names a missing texture, or if two uses
/// of a texture need different encodings.
MaterialTables material_tables(const Scene& scene, bool has_mip_maps, Roughness roughness = Roughness::kOff);

/// Returns the flags that hits on triangles of a material carry: kAlphaFlag, kTintFlag or neither.
std::uint32_t triangle_flags(const MaterialRecord& material);

/// Returns a texture and its mip levels down to one texel. Each level has half the width and height (rounded down, at
/// least 1). A texel is the mean of the texels that it covers, in linear light, rounded to the texture's encoding at
/// the end. Along an odd side it covers three texels, weighted by overlap. All arithmetic is integer, so every compiler
/// gives the same texels.
std::vector<Texture> mip_chain(const Texture& texture);

/// Replaces each texture of the image by its mip levels, and makes material records name the first levels. `earlier`:
/// an image of the same scene, from which the levels are moved; null: they are computed. Throws InputError if there are
/// more levels than a texture number can express.
void add_mip_levels(MaterialTables& materials, MemoryImage& image, MemoryImage* earlier = nullptr);

}  // namespace traces
