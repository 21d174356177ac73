#pragma once
#include "traces/scenes/laboratory/looks.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::laboratory {

/// Adds foot, rod, and a clamp at height `clamp` that holds a vessel at distance `reach` from the rod (+x, rotated
/// about y).
void add_stand(Scene& scene, const Looks& looks, const glm::vec3& position, double turns, float clamp, float reach,
               const Detail& detail);
/// Adds a burner with its flame, below a tripod with a wire gauze at height 0.2.
void add_burner(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail);
/// Adds a wooden rack for six tubes, 0.04 apart along x, whose bottoms are 0.02 above the bench.
void add_rack(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail);
/// Adds a magnetic stirrer, its plate at height 0.055.
void add_stirrer(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail);
void add_mortar(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail);
void add_notebook(Scene& scene, const Looks& looks, const glm::vec3& position, double turns, const Detail& detail);

}  // namespace traces::laboratory
