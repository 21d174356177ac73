#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// Level of detail of a generated scene: scales the cells of curved surfaces and the numbers of leaves, tufts,
/// bristles.
struct Detail {
  double share = 1;  ///< number of cells along a line, relative to the standard detail of the scene (1)

  /// Returns the number of cells along a line: proportional to the detail, `at_detail_1` at detail 1, at least `least`.
  std::uint32_t cell_count(double at_detail_1, std::uint32_t least = 1) const;
  /// Returns a number of objects: proportional to the square of the detail (as the number of triangles is),
  /// `at_detail_1` at detail 1, at least `least`.
  std::uint32_t piece_count(double at_detail_1, std::uint32_t least = 1) const;
  /// Returns a profile with fewer points if the detail is low: every second point below detail 1/2, every third below
  /// 0.34. Both end points are always kept.
  std::vector<glm::vec2> coarser_profile(std::span<const glm::vec2> points) const;
};

/// Returns the detail at which a scene has `triangles` triangles, if it has `at_detail_1` triangles at detail 1. The
/// number of triangles grows with the square of the detail.
Detail detail_for(double triangles, double at_detail_1);

/// Parameters of the search for a level of detail.
struct DetailSearch {
  std::uint64_t made = 0;  ///< triangles of the scene's other parts, included in the wanted number
  int tries = 6;
  double near_enough = 0.01;  ///< relative error of the number of triangles at which the search ends
  double least = 0.1, most = 10;
};

/// Searches for the level of detail at which `made` + triangles_at(detail) is close to `wanted` triangles. Starts at
/// detail 1, assumes growth with the square of the detail, and returns the best detail tried.
Detail fit_detail(std::uint64_t wanted, const std::function<std::uint64_t(const Detail& detail)>& triangles_at,
                  const DetailSearch& search = {});

/// Searches for the level of detail at which `make` builds a scene of about `triangles` triangles (a mesh counts once
/// per instance), and returns that scene. `make` is called several times, so the caller should add textures afterwards.
Scene build_to_size(std::uint32_t triangles, const std::function<Scene(const Detail& detail)>& make);

}  // namespace traces
