#include "traces/scene/pose.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "sim/error.h"
#include "traces/scene/limits.h"
#include "traces/scene/normals_tangents.h"
#include "traces/scene/scene.h"

namespace traces {
namespace {

using Interpolation = Track::Interpolation;

/// The two animation keys between which a time is. Before the first and after the last key, both are that key.
struct KeyInterval {
  std::size_t from = 0, to = 0;
  double share = 0;    ///< position between the two keys, 0 to 1
  double seconds = 0;  ///< seconds between the two animation keys
};

KeyInterval find_keys(const Track& track, double seconds) {
  const auto& times = track.times;
  const auto later = std::upper_bound(times.begin(), times.end(), seconds,
                                      [](double t, float key) { return t < static_cast<double>(key); });
  const auto to = static_cast<std::size_t>(later - times.begin());
  if (to == 0) return {0, 0, 0, 0};
  if (to == times.size()) return {to - 1, to - 1, 0, 0};
  const double begin = static_cast<double>(times[to - 1]), length = static_cast<double>(times[to]) - begin;
  return {to - 1, to, (seconds - begin) / length, length};
}

/// Parts of an animation key; a cubic spline has all three, other tracks only the value.
enum class Part : std::uint8_t { kInTangent, kValue, kOutTangent };

double key_number(const Track& track, std::size_t key, Part part, std::size_t i, std::size_t count) {
  const bool spline = track.interpolation == Interpolation::kCubicSpline;
  const std::size_t row = spline ? 3 * key + static_cast<std::size_t>(part) : key;
  return static_cast<double>(track.values[row * count + i]);
}

double spline_value(const Track& track, const KeyInterval& span, std::size_t i, std::size_t count) {
  const double s = span.share, s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * key_number(track, span.from, Part::kValue, i, count) +
         (s3 - 2 * s2 + s) * span.seconds * key_number(track, span.from, Part::kOutTangent, i, count) +
         (3 * s2 - 2 * s3) * key_number(track, span.to, Part::kValue, i, count) +
         (s3 - s2) * span.seconds * key_number(track, span.to, Part::kInTangent, i, count);
}

/// Returns sin(share x angle) / sin(angle) by its series in 1 - cosine. For a cosine of 0 to 1 each term is at most
/// half the previous one.
double arc_weight(double share, double cosine) {
  constexpr double kSmallest = 1e-18;
  double term = share, sum = share;
  for (double i = 1; term > kSmallest; ++i) {
    term *= (i * i - share * share) / (i * (2 * i + 1)) * (1 - cosine);
    sum += term;
  }
  return sum;
}

double dot_product(std::span<const double> a, std::span<const double> b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

void normalise_rotation(std::span<double> q) {
  const double length = std::sqrt(dot_product(q, q));
  if (!(length > 0)) {
    std::ranges::fill(q, 0.0);
    q[3] = 1;
    return;
  }
  for (double& x : q) x /= length;
}

void interpolate_arc(const Track& track, const KeyInterval& span, std::span<double> out) {
  double from[4], to[4];
  for (std::size_t i = 0; i < 4; ++i) {
    from[i] = key_number(track, span.from, Part::kValue, i, 4);
    to[i] = key_number(track, span.to, Part::kValue, i, 4);
  }
  normalise_rotation(from);
  normalise_rotation(to);
  const double cosine = dot_product(from, to);
  const double angle_cosine = std::min(std::abs(cosine), 1.0);
  const double a = arc_weight(1 - span.share, angle_cosine);
  const double b = arc_weight(span.share, angle_cosine) * (cosine < 0 ? -1 : 1);
  for (std::size_t i = 0; i < 4; ++i) out[i] = a * from[i] + b * to[i];
}

}  // namespace

void sample_track(const Track& track, double seconds, std::span<double> out) {
  const std::size_t count = out.size();
  assert(!track.times.empty() && "a track has at least one key");
  assert(track.values.size() ==
         track.times.size() * count * (track.interpolation == Interpolation::kCubicSpline ? 3 : 1));
  const bool rotation = track.path == Track::Path::kRotation;
  const KeyInterval span = find_keys(track, seconds);
  if (span.from == span.to || track.interpolation == Interpolation::kStep) {
    for (std::size_t i = 0; i < count; ++i) out[i] = key_number(track, span.from, Part::kValue, i, count);
  } else if (track.interpolation == Interpolation::kCubicSpline) {
    for (std::size_t i = 0; i < count; ++i) out[i] = spline_value(track, span, i, count);
  } else if (rotation) {
    interpolate_arc(track, span, out);
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      const double from = key_number(track, span.from, Part::kValue, i, count);
      out[i] = from + span.share * (key_number(track, span.to, Part::kValue, i, count) - from);
    }
  }
  if (rotation) normalise_rotation(out);
}

void sample_track_slope(const Track& track, double seconds, std::span<double> out) {
  assert(track.interpolation == Interpolation::kCubicSpline);
  const std::size_t count = out.size();
  const KeyInterval span = find_keys(track, seconds);
  std::ranges::fill(out, 0.0);
  if (span.from == span.to) return;
  const double s = span.share, s2 = s * s;
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = (6 * s2 - 6 * s) / span.seconds *
                 (key_number(track, span.from, Part::kValue, i, count) -
                  key_number(track, span.to, Part::kValue, i, count)) +
             (3 * s2 - 4 * s + 1) * key_number(track, span.from, Part::kOutTangent, i, count) +
             (3 * s2 - 2 * s) * key_number(track, span.to, Part::kInTangent, i, count);
  }
}

namespace {

struct LocalPose {
  double translation[3], rotation[4], scale[3];
};

LocalPose rest_pose(const Transform& t) {
  const glm::dvec3 move(t.translation), scale(t.scale);
  const glm::dquat q = glm::normalize(glm::dquat(t.rotation));
  return {{move.x, move.y, move.z}, {q.x, q.y, q.z, q.w}, {scale.x, scale.y, scale.z}};
}

glm::dmat4 local_matrix(const LocalPose& p) {
  return transform_matrix({p.translation[0], p.translation[1], p.translation[2]},
                          glm::dquat(p.rotation[3], p.rotation[0], p.rotation[1], p.rotation[2]),
                          {p.scale[0], p.scale[1], p.scale[2]});
}

void apply_track(const Track& track, double seconds, LocalPose& pose, std::vector<double>& weights) {
  switch (track.path) {
    case Track::Path::kTranslation:
      return sample_track(track, seconds, pose.translation);
    case Track::Path::kRotation:
      return sample_track(track, seconds, pose.rotation);
    case Track::Path::kScale:
      return sample_track(track, seconds, pose.scale);
    case Track::Path::kMorphWeights:
      return sample_track(track, seconds, weights);
  }
}

}  // namespace

glm::dmat4 transform_matrix(const glm::dvec3& translation, const glm::dquat& q, const glm::dvec3& scale) {
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  glm::dmat4 m(1);
  m[0] = glm::dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0) * scale.x;
  m[1] = glm::dvec4(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0) * scale.y;
  m[2] = glm::dvec4(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0) * scale.z;
  m[3] = glm::dvec4(translation, 1);
  return m;
}

double largest_entry(const glm::dmat4& m) {
  double largest = 0;
  for (int i = 0; i < 16; ++i) largest = std::max(largest, std::abs(m[i / 4][i % 4]));
  return largest;
}

NodePoses pose_nodes(const Scene& scene, double seconds) {
  NodePoses poses;
  std::vector<LocalPose> local;
  local.reserve(scene.nodes.size());
  for (const Node& node : scene.nodes) {
    local.push_back(rest_pose(node.rest));
    poses.morph_weights.emplace_back(node.morph_weights.begin(), node.morph_weights.end());
  }
  // In reverse order, so that the first of several tracks for a property of a node takes effect.
  for (auto track = scene.tracks.rbegin(); track != scene.tracks.rend(); ++track) {
    apply_track(*track, seconds, local[track->node], poses.morph_weights[track->node]);
  }
  poses.to_world.reserve(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    const glm::dmat4 in_parent = glm::dmat4(node.matrix) * local_matrix(local[i]);
    assert((node.parent == kNone || node.parent < i) && "a parent comes before its children");
    poses.to_world.push_back(node.parent == kNone ? in_parent : poses.to_world[node.parent] * in_parent);
    if (!(largest_entry(poses.to_world.back()) <= kFarthest)) {
      throw sim::InputError(fmt::format("{}: at {} s node '{}' is further than {} from the origin, or larger",
                                        scene.name, seconds, node.name, kFarthest));
    }
  }
  return poses;
}

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

glm::dmat4x3 blend_joints(std::span<const glm::dmat4x3> joints, const std::array<std::uint16_t, 4>& which,
                          const glm::vec4& weights) {
  glm::dmat4x3 sum(0);
  for (int i = 0; i < 4; ++i) {
    if (weights[i] != 0) sum += static_cast<double>(weights[i]) * joints[which[static_cast<std::size_t>(i)]];
  }
  return sum;
}

/// Returns the cofactor matrix, which transforms normals and exists for singular matrices, too.
glm::dmat3 cofactor_matrix(const glm::dmat4x3& m) {
  const glm::dmat3 c(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::dot(m[0], c[0]) < 0 ? -c : c;
}

glm::vec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? glm::vec3(v / length) : glm::vec3(0);
}

template <class T>
bool swap_if_different(std::vector<T>& old, std::vector<T>& by) {
  old.swap(by);
  return old != by;
}

}  // namespace

bool deform_mesh(Mesh& mesh, std::span<const glm::dmat4x3> joints, std::span<const double> morph_weights) {
  const Deformation& rest = *mesh.deformation;
  std::vector<glm::dvec3> positions(rest.positions.begin(), rest.positions.end());
  std::vector<glm::dvec3> normals(rest.normals.begin(), rest.normals.end());
  std::vector<glm::dvec3> tangents(rest.tangents.begin(), rest.tangents.end());
  add_targets(rest.target_positions, morph_weights, positions);
  add_targets(rest.target_normals, morph_weights, normals);
  if (!rest.joints.empty()) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const glm::dmat4x3 m = blend_joints(joints, rest.joints[i], rest.weights[i]);
      positions[i] = m * glm::dvec4(positions[i], 1);
      if (!normals.empty()) normals[i] = cofactor_matrix(m) * normals[i];
      if (!tangents.empty()) tangents[i] = glm::dmat3(m) * tangents[i];
    }
  }

  Mesh posed;
  posed.positions.assign(positions.begin(), positions.end());
  std::ranges::transform(normals, std::back_inserter(posed.normals), unit_or_zero);
  for (std::size_t i = 0; i < tangents.size(); ++i) {
    posed.tangents.emplace_back(unit_or_zero(tangents[i]), rest.tangents[i].w);
  }
  bool changed = swap_if_different(mesh.positions, posed.positions);
  if (normals.empty()) {
    posed.normals = triangle_normals(mesh);
  } else if (std::ranges::find(posed.normals, glm::vec3(0)) != posed.normals.end()) {
    mesh.normals.swap(posed.normals);
    repair_normals(mesh);
    mesh.normals.swap(posed.normals);
  }
  changed = swap_if_different(mesh.normals, posed.normals) || changed;
  return swap_if_different(mesh.tangents, posed.tangents) || changed;
}

}  // namespace traces
