#pragma once
#include <vector>

#include "traces/accel/memory_image.h"

namespace traces {

/// A scene's materials as memory holds them.
struct MaterialTables {
  std::vector<MaterialRecord> records;        ///< at least one
  std::vector<MaterialDetailRecord> details;  ///< empty, or one per record
  bool needs_vertices = false;                ///< some material is kVertexed
  bool needs_white = false;                   ///< some triangle is flagged and has no base texture
  bool needs_density = false;                 ///< normals say how dense textures are
};

/// Throws sim::InputError if a material names a texture that is not there, or one encoded as another use wants it.
MaterialTables material_tables(const Scene& scene, bool has_mip_maps);

/// Flags that a triangle of that material hands to its hits: kAlphaFlag, kTintFlag or neither.
std::uint32_t triangle_flags(const MaterialRecord& material);

}  // namespace traces
