#include "traces/scene/pose/pose_mesh.h"

#include <algorithm>
#include <cassert>
#include <iterator>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "traces/scene/normals.h"

namespace traces {
namespace {

void add_targets(const std::vector<std::vector<glm::vec3>>& targets, std::span<const double> weights,
                 std::vector<glm::dvec3>& sums) {
  for (std::size_t target = 0; target < std::min(targets.size(), weights.size()); ++target) {
    const std::vector<glm::vec3>& displacements = targets[target];
    if (weights[target] == 0 || displacements.empty()) continue;
    assert(displacements.size() >= sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += weights[target] * glm::dvec3(displacements[i]);
  }
}

glm::dmat4x3 blend(std::span<const glm::dmat4x3> joints, const std::array<std::uint16_t, 4>& which,
                   const glm::vec4& weights) {
  glm::dmat4x3 sum(0);
  for (int i = 0; i < 4; ++i) {
    if (weights[i] != 0) sum += static_cast<double>(weights[i]) * joints[which[static_cast<std::size_t>(i)]];
  }
  return sum;
}

/// Returns the cofactor matrix, which transforms normals; it exists for singular matrices, too.
glm::dmat3 cofactors(const glm::dmat4x3& m) {
  const glm::dmat3 c(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::dot(m[0], c[0]) < 0 ? -c : c;
}

glm::vec3 unit_or_null(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? glm::vec3(v / length) : glm::vec3(0);
}

template <class T>
bool replace(std::vector<T>& old, std::vector<T>& by) {
  old.swap(by);
  return old != by;
}

}  // namespace

bool deform(Mesh& mesh, std::span<const glm::dmat4x3> joints, std::span<const double> morph_weights) {
  const Deformation& rest = *mesh.deformation;
  std::vector<glm::dvec3> positions(rest.positions.begin(), rest.positions.end());
  std::vector<glm::dvec3> normals(rest.normals.begin(), rest.normals.end());
  std::vector<glm::dvec3> tangents(rest.tangents.begin(), rest.tangents.end());
  add_targets(rest.target_positions, morph_weights, positions);
  add_targets(rest.target_normals, morph_weights, normals);
  if (!rest.joints.empty()) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const glm::dmat4x3 m = blend(joints, rest.joints[i], rest.weights[i]);
      positions[i] = m * glm::dvec4(positions[i], 1);
      if (!normals.empty()) normals[i] = cofactors(m) * normals[i];
      if (!tangents.empty()) tangents[i] = glm::dmat3(m) * tangents[i];
    }
  }

  Mesh posed;
  posed.positions.assign(positions.begin(), positions.end());
  std::ranges::transform(normals, std::back_inserter(posed.normals), unit_or_null);
  for (std::size_t i = 0; i < tangents.size(); ++i) {
    posed.tangents.emplace_back(unit_or_null(tangents[i]), rest.tangents[i].w);
  }
  bool changed = replace(mesh.positions, posed.positions);
  if (normals.empty()) {
    posed.normals = triangle_normals(mesh);
  } else if (std::ranges::find(posed.normals, glm::vec3(0)) != posed.normals.end()) {
    mesh.normals.swap(posed.normals);
    repair_normals(mesh);
    mesh.normals.swap(posed.normals);
  }
  changed = replace(mesh.normals, posed.normals) || changed;
  return replace(mesh.tangents, posed.tangents) || changed;
}

}  // namespace traces
