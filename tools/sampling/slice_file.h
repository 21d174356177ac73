#pragma once
#include <nlohmann/json.hpp>

#include "tools/sampling/slice_play.h"

namespace tools {

/// A slice that was played where others of its frame were not, with the functional half of its own tiles.
struct SlicePart {
  PlayedSlice played;
  FrontEnd::Result function;
  double wall_seconds = 0;  ///< host
};

/// All digits of a part, for whoever adds up the frame. What a machine's units are called and made of is not in it.
nlohmann::ordered_json slice_json(const SlicePart& part);

/// Reads a part back; `nothing` is the slice's machine before its first cycle. InputError for what is no part of such a
/// machine.
SlicePart read_slice(const nlohmann::ordered_json& json, Stretch nothing);

}  // namespace tools
