#pragma once
#include "traces/scenes/laboratory/looks.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::laboratory {

/// Adds bench (its top at y = 0), tiled wall with a chart and shelves, cupboards, window on the left, lamp above.
void add_room(Scene& scene, const Looks& looks, const Detail& detail);

inline constexpr float kShelf = 0.375F, kUpperShelf = 0.60F;  ///< heights
inline constexpr float kShelfFrom = 0.02F, kShelfTo = 0.98F;  ///< in x
inline constexpr float kShelfDepth = -0.43F;                  ///< z of its middle

}  // namespace traces::laboratory
