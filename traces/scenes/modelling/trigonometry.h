#pragma once
#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace traces {

// Angles in turns (1 = 360 degrees), by polynomials within 1e-7: every compiler and library gives the same bits.

float sin_turns(double turns);
float cos_turns(double turns);
/// (cos, sin)
glm::vec2 on_circle(double turns);

/// A rotation about an axis of unit length, counter-clockwise when looked at against it.
glm::quat rotation(const glm::vec3& axis, double turns);

}  // namespace traces
