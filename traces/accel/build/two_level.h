#pragma once
#include "sim/error.h"
#include "traces/accel/build/material_tables.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

// Two-level images (bvh.instances: two_level).
//
// 1. Every mesh is stored once, in its own space, with its own tree. A tree over instances has one instance per leaf.
// 2. All nodes are in one array, the tree over instances first; all triangles are in one array.
// 3. A ray is transformed into the space of each instance that it enters. Its direction is not normalised, so distances
//    are the same in both spaces.
// 4. Two kinds of meshes are not shared: a mesh that deforms, which has only one instance, and an instance whose matrix
//    has no inverse in single precision. The triangles of such a flat instance are in world space; its matrix is the
//    identity.

/// Builds the geometry of a two-level image: trees, triangles, shading records, instances and scene bounds.
MemoryImage build_two_levels(const Scene& scene, const MaterialTables& materials, const BvhConfig& config,
                             unsigned threads, sim::Stop stop = nullptr);

/// Updates the two-level image of a scene that has moved.
///
/// 1. Instances and the tree over them are rebuilt. Shared meshes and their trees stay.
/// 2. Trees of deforming meshes and of meshes in world space are refitted or rebuilt (bvh.update).
/// 3. The result depends on `posed` and, for a refit, on the shape of those trees.
///
/// Returns false, with no change, if other meshes than before can be shared, because a matrix lost or gained its
/// inverse.
bool update_two_levels(const Scene& posed, const BvhConfig& config, unsigned threads, MemoryImage& image,
                       sim::Stop stop = nullptr);

/// Transforms a ray into the space of an instance's mesh.
Ray to_object_space(const InstanceRecord& instance, const Ray& ray);

}  // namespace traces
