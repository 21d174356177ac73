#pragma once

#include "sim/io/json.h"
#include "tools/sampling/slice_play.h"

namespace tools {

/// A slice that was played where others of its frame were not, with the functional half of its own tiles.
struct SlicePart {
  PlayedSlice played;
  FrontEnd::Result function;
  double wall_seconds = 0;  ///< host
};

/// All digits of a part, for whoever adds up the frame. What a machine's units are called and made of is not in it.
sim::Json slice_json(const SlicePart& part);

/// Reads a part back; `nothing` is the slice's machine before its first cycle. InputError for what is no part of such a
/// machine.
SlicePart read_slice(const sim::Json& json, Stretch nothing);

}  // namespace tools
