#pragma once
#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace traces {

// Trigonometric functions. Angles are in turns (1 = 360 degrees). Polynomials with errors below 1e-7 give the same bits
// with every compiler and library.

float sin_turns(double turns);
float cos_turns(double turns);
/// Returns the point (cos, sin) of an angle.
glm::vec2 circle_point(double turns);

/// Returns a rotation about an axis (a unit vector), counter-clockwise as seen from the tip of the axis.
glm::quat axis_rotation(const glm::vec3& axis, double turns);

}  // namespace traces
