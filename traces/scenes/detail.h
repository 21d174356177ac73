#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// How finely a generator cuts what is curved, and how many leaves, tufts, bristles ... it makes.
struct Detail {
  float share = 1;  ///< along a line; 1 makes the scene of its class

  /// Cells along a line: `at_one` of them at detail 1, never fewer than `least`.
  std::uint32_t cells(std::uint32_t at_one, std::uint32_t least = 1) const;
  /// Pieces of which there are more with more triangles.
  std::uint32_t pieces(std::uint32_t at_one, std::uint32_t least = 1) const;
  /// A profile for a scene of few triangles: from half of detail 1 down every second point between its ends, from a
  /// third down every third.
  std::vector<glm::vec2> profile(std::span<const glm::vec2> points) const;
};

/// What `make` makes at the detail at which it has about `triangles`, as instanced; tried from detail 1 on, at most
/// eight times. `make` should leave textures for later, as it runs several times.
Scene build_to_size(std::uint32_t triangles, const std::function<Scene(const Detail& detail)>& make);

}  // namespace traces
