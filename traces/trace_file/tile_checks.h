#pragma once
#include "traces/stream.h"

namespace traces {

// Checks that any machine can play a decoded tile. They throw InputError, without a file name.

/// True if the node's items occupy ray slots.
bool has_slots(const WorkNode& node);
/// A node with ray slots must have one launch as its source.
void check_rays(const WorkNode& rays, const TileWork& work);
/// All hits must be read: a ray's slot is released when its hit has been read.
void check_readers(const TileWork& work);
/// All imports must be read, because the end of a tile implies that its borders have arrived.
void check_imports(const TileWork& work);

}  // namespace traces
