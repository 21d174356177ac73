#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// Resolution of a generator: cells of curved surfaces, and numbers of leaves, tufts, bristles.
struct Detail {
  double share = 1;  ///< along a line; 1 makes the scene of its class

  /// Returns the cells along a line: `at_one` at detail 1, at least `least`.
  std::uint32_t cell_count(double at_one, std::uint32_t least = 1) const;
  /// Returns a number of objects that grows with the number of triangles: `at_one` at detail 1.
  std::uint32_t piece_count(double at_one, std::uint32_t least = 1) const;
  /// Returns a coarser profile for few triangles: every second point between the ends up to half of detail 1, every
  /// third up to a third.
  std::vector<glm::vec2> coarser_profile(std::span<const glm::vec2> points) const;
};

/// Returns the detail for `triangles`, which grow with its square, if detail 1 has `at_one`.
Detail detail_for(double triangles, double at_one);

/// Parameters of fit_detail().
struct DetailSearch {
  std::uint64_t made = 0;  ///< triangles of the scene's other parts, included in the wanted number
  int tries = 6;
  double near_enough = 0.01;  ///< relative error of the number
  double least = 0.1, most = 10;
};

/// Searches the detail at which `made` + triangles_at(detail) is close to `wanted`. Starts at detail 1, assumes growth
/// with the square of detail, and returns the best detail tried.
Detail fit_detail(std::uint64_t wanted, const std::function<std::uint64_t(const Detail& detail)>& triangles_at,
                  const DetailSearch& search = {});

/// Returns the scene made at the detail that gives about `triangles`, as instanced. `make` runs several times, so leave
/// textures out of it.
Scene build_to_size(std::uint32_t triangles, const std::function<Scene(const Detail& detail)>& make);

}  // namespace traces
