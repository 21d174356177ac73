#pragma once
#include "sim/stop.h"
#include "traces/accel/build/material_tables.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

// Two levels (bvh.instances: two_level). Every mesh lies in memory once, in its own space, with a tree of its own;
// above them is a tree over instances, whose leaves name one each. All nodes are in one array, that of instances first;
// so are triangles. A ray is carried into the space of each instance that it comes to. Its direction keeps its length,
// so that distances mean the same everywhere.
//
// Not shared: a mesh that deforms, which has one instance anyhow, and an instance whose matrix has no inverse
// that single precision can hold. The latter's triangles lie in world space, and its own matrix is the identity.

/// Everything of the image that has to do with geometry; instances, boxes and scene bounds included.
MemoryImage two_levels(const Scene& scene, const MaterialTables& materials, const BvhConfig& config, unsigned threads,
                       sim::Stop stop = nullptr);

/// Carries a moved scene into its image: instances and the tree over them are made anew, and what deforms or stands in
/// world space by itself is refitted, or its trees rebuilt (bvh.update). Shared meshes and their trees stay. Depends on
/// `posed` and, of a refit, on the shape of those trees alone. False, and nothing is done, where meshes are no longer
/// shared as they were, since a matrix has lost its inverse or found it.
bool update_levels(const Scene& posed, const BvhConfig& config, unsigned threads, MemoryImage& image,
                   sim::Stop stop = nullptr);

/// The ray as the instance's mesh sees it.
Ray into_object(const InstanceRecord& instance, const Ray& ray);

}  // namespace traces
