#pragma once
#include "traces/stream.h"

namespace traces {

// Checks, beyond bounds, that a tile that is read is one that any machine can play. InputError, without the file's
// name, for one that is not.

/// Its items have ray slots.
bool has_slots(const WorkNode& node);
/// A node that has slots comes from one launch.
void check_rays(const WorkNode& rays, const TileWork& work);
/// Slots of rays are given back by those who read their hits: unread rays would keep theirs for ever.
void check_readers(const TileWork& work);
/// A machine takes a tile's end as a sign that all of its borders have come.
void check_imports(const TileWork& work);

}  // namespace traces
