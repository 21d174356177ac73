#pragma once

#include "sim/io/json.h"
#include "tools/sampling/slice_player.h"

namespace tools {

/// Results of one slice that was simulated in another process than the others.
struct SlicePart {
  PlayedSlice played;
  RenderResult rendered;
  double wall_seconds = 0;  ///< host
};

/// Serialises a part exactly, for join_slices(). Names and structure of the machine are left out.
sim::Json slice_json(const SlicePart& part);

/// Parses a part. `nothing`: the slice's machine before its first cycle. InputError if the part does not match it.
SlicePart read_slice(const sim::Json& json, MachineSpan nothing);

}  // namespace tools
