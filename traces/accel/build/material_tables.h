#pragma once
#include <cstdint>
#include <vector>

#include "traces/accel/memory_image.h"

namespace traces {

/// A scene's material records, and which optional data they need.
struct MaterialTables {
  std::vector<MaterialRecord> records;        ///< at least one
  std::vector<MaterialDetailRecord> details;  ///< empty, or one per record
  bool needs_vertices = false;                ///< some material is kVertexed
  bool needs_white = false;                   ///< some triangle has flags but no base texture
  bool needs_density = false;                 ///< the length of normals is the texture density
};

/// Builds the tables. Throws sim::InputError if a material names a missing texture, or two uses of a texture need
/// different encodings.
MaterialTables material_tables(const Scene& scene, bool has_mip_maps);

/// Returns the flags that the triangles of a material pass to hits: kAlphaFlag, kTintFlag or neither.
std::uint32_t triangle_flags(const MaterialRecord& material);

/// Returns the texture and its mip levels down to one texel; each level has half the width and height (rounded down, at
/// least 1). A texel is the mean of the texels that it covers, in linear light, rounded to the texture's encoding at
/// the end. Along an odd side it covers three texels, weighted by overlap. Integer arithmetic only, so that every
/// compiler gives the same texels.
std::vector<Texture> mip_chain(const Texture& texture);

/// Replaces each texture of the image by its mip chain and makes material records name the first levels. Throws
/// InputError if there are more levels than a texture word can name.
void add_mip_levels(MaterialTables& materials, MemoryImage& image);

}  // namespace traces
