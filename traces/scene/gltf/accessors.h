#pragma once
#include <cstdint>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// The bytes of a buffer view. view_bytes() throws InputError if the view exceeds its buffer.
struct Bytes {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};
Bytes view_bytes(const Context& context, int buffer_view);

// These functions read accessors of any component type, with sparse elements filled in. Normalised integers become 0..1
// or -1..1. They throw InputError for a missing index, a wrong type, values outside the buffer view, and numbers that
// are not finite.
std::vector<float> read_floats(Context& context, int accessor, const char* what);
std::vector<glm::vec2> read_vec2(Context& context, int accessor, const char* what);
std::vector<glm::vec3> read_vec3(Context& context, int accessor, const char* what);
std::vector<glm::vec4> read_vec4(Context& context, int accessor, const char* what);
/// Reads an accessor of 4 x 4 matrices, which must have single precision.
std::vector<glm::mat4> read_mat4(Context& context, int accessor, const char* what);

/// Reads an accessor of unsigned integers of 8, 16 or 32 bits.
std::vector<std::uint32_t> read_indices(Context& context, int accessor);

}  // namespace traces::gltf
