#include "traces/scene/gltf_export/transforms.h"

#include <algorithm>
#include <cmath>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace traces::gltf_export {
namespace {

/// Makes columns p and q of `m` orthogonal by a rotation, accumulated in `v`: a step of one-sided Jacobi. m x
/// transpose(v) is unchanged.
void rotate_columns(glm::dmat3& m, glm::dmat3& v, int p, int q) {
  const double alpha = glm::dot(m[p], m[p]), beta = glm::dot(m[q], m[q]), gamma = glm::dot(m[p], m[q]);
  if (!(std::abs(gamma) > 1e-16 * std::sqrt(alpha * beta))) return;
  const double zeta = (beta - alpha) / (2 * gamma);
  const double t = (zeta < 0 ? -1 : 1) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
  const double c = 1 / std::sqrt(1 + t * t), s = c * t;
  for (glm::dmat3* each : {&m, &v}) {
    const glm::dvec3 a = (*each)[p], b = (*each)[q];
    (*each)[p] = c * a - s * b;
    (*each)[q] = s * a + c * b;
  }
}

/// Returns the columns of `m` at unit length. Columns without direction, as in a flat matrix, are replaced so that all
/// three are orthogonal; their lengths become 0.
glm::dmat3 unit_columns(const glm::dmat3& m, glm::dvec3& lengths) {
  const double least = 1e-12 * std::max({lengths.x, lengths.y, lengths.z});
  glm::dmat3 out(1);
  int known = 0, last = 0;
  for (int i = 0; i < 3; ++i) {
    if (!(lengths[i] > least)) {
      lengths[i] = 0;
      continue;
    }
    out[i] = m[i] / lengths[i];
    last = i;
    ++known;
  }
  if (known == 0) return out;
  const auto next = [](int i, int by) { return (i + by) % 3; };
  if (known == 1) {
    const glm::dvec3 other = std::abs(out[last].x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    out[next(last, 1)] = glm::normalize(glm::cross(other, out[last]));
    out[next(last, 2)] = glm::cross(out[last], out[next(last, 1)]);
  }
  for (int i = 0; known == 2 && i < 3; ++i) {
    if (lengths[i] == 0) out[i] = glm::cross(out[next(i, 1)], out[next(i, 2)]);
  }
  return out;
}

void set(std::vector<double>& list, const glm::dvec3& v, const glm::dvec3& normal) {
  if (v != normal) list = {v.x, v.y, v.z};
}

}  // namespace

bool is_placement(const glm::mat4& matrix) {
  constexpr double kMost = 1e-5;  // absolute, as in the validator
  const glm::dmat3 m(matrix);
  if (matrix[0].w != 0 || matrix[1].w != 0 || matrix[2].w != 0 || matrix[3].w != 1) return false;
  const double longest = std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
  const double shear =
      std::max({std::abs(glm::dot(m[0], m[1])), std::abs(glm::dot(m[1], m[2])), std::abs(glm::dot(m[2], m[0]))});
  return shear <= kMost * std::max(longest, 1e-300) && glm::determinant(m) != 0;
}

TwoPlacements split(const glm::mat4& matrix) {
  glm::dmat3 m(matrix), turns(1);
  for (int sweep = 0; sweep < 30; ++sweep) {
    rotate_columns(m, turns, 0, 1);
    rotate_columns(m, turns, 0, 2);
    rotate_columns(m, turns, 1, 2);
  }
  // matrix = m x transpose(turns), and the columns of m are orthogonal: their lengths are the scale.
  TwoPlacements out;
  out.outer.translation = glm::dvec3(matrix[3]);
  for (int i = 0; i < 3; ++i) out.outer.scale[i] = glm::length(m[i]);
  glm::dmat3 outer = unit_columns(m, out.outer.scale);
  if (glm::determinant(outer) < 0) {
    outer[2] = -outer[2];
    out.outer.scale[2] = -out.outer.scale[2];
  }
  out.outer.rotation = glm::normalize(glm::quat_cast(outer));
  out.inner.rotation = glm::normalize(glm::quat_cast(glm::transpose(turns)));
  return out;
}

void set_transform(tinygltf::Node& node, const Placement& placement) {
  const glm::dquat& q = placement.rotation;
  set(node.translation, placement.translation, glm::dvec3(0));
  if (q != glm::dquat(1, 0, 0, 0)) node.rotation = {q.x, q.y, q.z, q.w};
  set(node.scale, placement.scale, glm::dvec3(1));
}

void set_transform(tinygltf::Node& node, const Transform& transform) {
  const glm::quat& q = transform.rotation;
  set_transform(
      node, Placement{glm::dvec3(transform.translation), glm::dquat(double{q.w}, double{q.x}, double{q.y}, double{q.z}),
                      glm::dvec3(transform.scale)});
}

void set_transform(tinygltf::Node& node, const glm::mat4& matrix) {
  if (matrix == glm::mat4(1)) return;
  for (int i = 0; i < 16; ++i) node.matrix.push_back(double{matrix[i / 4][i % 4]});
}

}  // namespace traces::gltf_export
