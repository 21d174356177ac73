#pragma once
#include <cstdint>
#include <vector>

#include "traces/accel/build/material_tables.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Returns the texture and its mip levels down to one texel; each level has half the width and height (rounded down, at
/// least 1). A texel is the mean of the texels that it covers, in linear light, rounded to the texture's encoding at
/// the end. Along an odd side it covers three texels, weighted by overlap. Integer arithmetic only, so that every
/// compiler gives the same texels.
std::vector<Texture> mip_chain(const Texture& texture);

/// Replaces each texture of the image by its mip chain and makes material records name the first levels. Throws
/// InputError if there are more levels than a texture word can name.
void add_mip_levels(MaterialTables& materials, MemoryImage& image);

}  // namespace traces
