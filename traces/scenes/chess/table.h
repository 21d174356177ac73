#pragma once
#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::chess {

/// Height of the table below the squares of the board.
inline constexpr float kTableTop = -0.42F;

/// Adds board (64 squares of 1 x 1 about the origin, their tops at y = 0), table, clock and the room with its window.
/// `detail` scales the resolution of curves.
void add_surroundings(Scene& scene, const Detail& detail);

}  // namespace traces::chess
