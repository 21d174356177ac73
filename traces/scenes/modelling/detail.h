#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// How finely a generator cuts what is curved, and how many leaves, tufts, bristles ... it makes.
struct Detail {
  double share = 1;  ///< along a line; 1 makes the scene of its class

  /// Cells along a line: `at_one` of them at detail 1, never fewer than `least`.
  std::uint32_t cells(double at_one, std::uint32_t least = 1) const;
  /// Pieces of which there are more with more triangles.
  std::uint32_t pieces(double at_one, std::uint32_t least = 1) const;
  /// A profile for a scene of few triangles: from half of detail 1 down every second point between its ends, from a
  /// third down every third.
  std::vector<glm::vec2> profile(std::span<const glm::vec2> points) const;
};

/// The detail at which surfaces have `triangles` that have `at_one` at detail 1: they grow with its square.
Detail detail_for(double triangles, double at_one);

/// When a search for the detail of a number of triangles ends, and where it looks.
struct DetailSearch {
  std::uint64_t made = 0;  ///< triangles of the scene's other parts, which are among the wanted ones
  int tries = 6;
  double near_enough = 0.01;  ///< relative error of the number
  double least = 0.1, most = 10;
};

/// The detail at which `triangles_at`, which grows about with its square, comes near to what is `made` short of
/// `wanted`: the best one tried, from detail 1 on.
Detail fit_detail(std::uint64_t wanted, const std::function<std::uint64_t(const Detail& detail)>& triangles_at,
                  const DetailSearch& search = {});

/// The scene that `make` makes at the detail at which it has about `triangles`, as instanced. `make` should leave
/// textures for later, as it runs several times.
Scene build_to_size(std::uint32_t triangles, const std::function<Scene(const Detail& detail)>& make);

}  // namespace traces
