#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// Profile of a turned object, (radius, height) from point to point; for make_lathe and make_turned.
class Outline {
 public:
  explicit Outline(const glm::vec2& start) : points_{start} {}
  Outline& line(float radius, float height);
  /// Adds a curve to that point whose middle is `bulge` outside the straight line (negative: inside).
  Outline& arc(float radius, float height, float bulge);
  /// Adds an arc about `centre`; from and to in turns, 0 outwards, 0.25 up.
  Outline& round(const glm::vec2& centre, float radius, double from, double to);
  const std::vector<glm::vec2>& points() const { return points_; }

 private:
  std::vector<glm::vec2> points_;
};

/// Returns the `count` points that best keep the line's shape, ends included.
std::vector<glm::vec2> simplified(std::vector<glm::vec2> points, std::size_t count);

/// Makes a lathe whose points `shape(around, k, point)` may move: `around` in turns, `k` the index in the profile.
/// Smooth, except that a repeated profile point makes an edge.
Mesh make_turned(std::string name, const std::vector<glm::vec2>& profile, std::uint32_t segments,
                 const std::function<glm::vec3(float around, std::size_t k, const glm::vec3& point)>& shape);

}  // namespace traces
