#pragma once
#include <cstdint>
#include <vector>

#include "traces/accel/build/material_tables.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// The texture and its mip levels, each half as wide and high as the one before (rounded down, at least 1), down to a
/// single texel. A texel is the mean of those that it covers: of linear light, rounded to the texture's own encoding
/// only at the end; where a side is odd, of three texels by how much of each it covers. Whole numbers throughout, so
/// that every compiler makes the same texels.
std::vector<Texture> mip_chain(const Texture& texture);

/// Puts a chain in the place of each of the image's textures, and has the records name the first level of each.
/// InputError if there are more levels than a texture word can name.
void add_mip_levels(MaterialTables& materials, MemoryImage& image);

}  // namespace traces
