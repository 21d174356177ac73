#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// The outline that a turner's tool follows, (radius, height) from point to point; for make_lathe and make_turned.
class Outline {
 public:
  explicit Outline(const glm::vec2& start) : points_{start} {}
  Outline& line(float radius, float height);
  /// A curve to that point whose middle lies `bulge` outside the straight line (inside, if negative).
  Outline& arc(float radius, float height, float bulge);
  /// Part of a circle about (radius, height); from and to in turns, 0 outwards, 0.25 up.
  Outline& round(const glm::vec2& centre, float radius, double from, double to);
  const std::vector<glm::vec2>& points() const { return points_; }

 private:
  std::vector<glm::vec2> points_;
};

/// The `count` points that keep the shape of the line best; its ends stay.
std::vector<glm::vec2> simplified(std::vector<glm::vec2> points, std::size_t count);

/// A lathe whose points `shape(around, k, point)` may carry elsewhere: `around` in turns, `k` the index in the profile.
/// Smooth, but for points that stand twice in the profile, which make an edge.
Mesh make_turned(std::string name, const std::vector<glm::vec2>& profile, std::uint32_t segments,
                 const std::function<glm::vec3(float around, std::size_t k, const glm::vec3& point)>& shape);

}  // namespace traces
