#pragma once
#include <set>
#include <string_view>

#include "block_harness.h"

// A room in which a check can be made to fail alone.

namespace kernels {

using traces::Material;
using Names = std::set<std::string_view>;

/// Checks that have failed, but for those at the picture's edge.
inline Names failing(const Sampling& sampling) {
  Names names;
  for (std::size_t check = 0; check < sampling.failed.size(); ++check) {
    if (sampling.failed[check] != 0) names.insert(names_of(Check{})[check]);
  }
  names.erase("border");
  return names;
}

inline std::uint64_t failed(const Sampling& sampling, Check check) {
  return sampling.failed[static_cast<std::size_t>(check)];
}

/// Seen from z = 4; the scene's longest side is 20.
struct Room {
  traces::Scene scene = empty_scene();
  Room() { scene.ambient = glm::vec3(1); }
  /// `part` with `material`, of one object.
  Room& add(const traces::Mesh& part, const Material& material = {}) {
    traces::add_object(scene, part, traces::add_material(scene, material));
    return *this;
  }
  Stage stage() const { return Stage(scene, traces::look_at("c", {0, 0, 4}, {0, 0, 0}, 0.5F)); }
  Sampling under(const UndersampleConfig& config = {}) const {
    return stage().undersample(small(16, 16), config).sampling;
  }
  Sampling multi(const MultirateConfig& config = {}) const { return stage().multirate(small(16, 16), config).sampling; }
};

/// Part of the plane z = `z` from x = `left` to `right`, facing +z.
inline traces::Mesh sheet(float left, float right, float z = 0) {
  return traces::make_quad("sheet", {left, -10, z}, {right - left, 0, 0}, {0, 20, 0}, 1);
}

/// The two sides of x = 0 as one object; `left` must not be smooth there.
inline traces::Mesh both_sides(traces::Mesh left, const traces::Mesh& right) {
  traces::append(left, right);
  return left;
}

/// An edge at x = 0 towards the viewer (`rise` < 0: away).
inline traces::Mesh fold(float rise) {
  return both_sides(traces::make_quad("left", {-10, -10, -10 * rise}, {10, 0, 10 * rise}, {0, 20, 0}, 1),
                    traces::make_quad("right", {0, -10, 0}, {10, 0, -10 * rise}, {0, 20, 0}, 1));
}

/// A mirror in the plane z = 0, in which the viewer sees what is behind.
inline Room mirror() {
  Room room;
  room.add(traces::make_quad("mirror", {-1.5F, -1.5F, 0}, {3, 0, 0}, {0, 3, 0}, 1),
           {.base_colour = glm::vec3(0), .mirror = 1});
  return room;
}

/// Part of the plane z = 8, facing -z.
inline traces::Mesh behind(float left, float right) {
  return traces::make_quad("behind", {right, -10, 8}, {left - right, 0, 0}, {0, 20, 0}, 1);
}

}  // namespace kernels
