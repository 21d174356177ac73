#include "traces/scene/gltf/context.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "sim/error.h"

namespace traces::gltf {

void Context::refuse(const std::string& reason) const { throw sim::InputError(file + ": " + reason); }

void Context::add_warning(const std::string& what) {
  constexpr std::size_t kMost = 50;
  if (scene.warnings.size() >= kMost || std::ranges::find(scene.warnings, what) != scene.warnings.end()) return;
  scene.warnings.push_back(scene.warnings.size() + 1 < kMost ? what : "further warnings are left out");
}

void Context::refuse_index(const char* what, long long index, std::size_t size) const {
  if (size == 0) refuse(fmt::format("{}[{}] is referred to, but the file has none", what, index));
  refuse(fmt::format("{}[{}] is referred to; allowed are 0 to {}", what, index, size - 1));
}

namespace {

template <class Vector>
Vector to_vector(const Context& context, const std::vector<double>& list, const Vector& absent,
                 const std::string& what) {
  constexpr auto kSize = static_cast<std::size_t>(Vector::length());
  if (list.empty()) return absent;
  if (list.size() != kSize) context.refuse(fmt::format("{} has {} numbers, needed are {}", what, list.size(), kSize));
  Vector out;
  for (std::size_t i = 0; i < kSize; ++i) out[static_cast<int>(i)] = to_float(context, list[i], what);
  return out;
}

}  // namespace

float to_float(const Context& context, double value, const std::string& what) {
  if (!(std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()))) {
    context.refuse(fmt::format("{} is {}, which is not a finite number of single precision", what, value));
  }
  return static_cast<float>(value);
}

glm::vec3 to_vec3(const Context& context, const std::vector<double>& list, const glm::vec3& absent,
                  const std::string& what) {
  return to_vector(context, list, absent, what);
}

glm::vec4 to_vec4(const Context& context, const std::vector<double>& list, const glm::vec4& absent,
                  const std::string& what) {
  return to_vector(context, list, absent, what);
}

glm::quat to_rotation(const Context& context, const std::vector<double>& list, const std::string& what) {
  const glm::dvec4 q(to_vec4(context, list, glm::vec4(0, 0, 0, 1), what));
  const double length = glm::length(q);
  if (!(length > 0)) context.refuse(what + " is null");
  const glm::vec4 unit(q / length);
  return {unit.w, unit.x, unit.y, unit.z};
}

glm::mat4 to_affine(glm::mat4 matrix) {
  for (int i = 0; i < 4; ++i) matrix[i].w = i < 3 ? 0.0F : 1.0F;
  return matrix;
}

const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

float number_or(const Context& context, const tinygltf::Value& object, const char* key, float absent) {
  if (!object.Has(key) || !object.Get(key).IsNumber()) return absent;
  return to_float(context, object.Get(key).GetNumberAsDouble(), key);
}

glm::vec3 vec3_or(const Context& context, const tinygltf::Value& object, const char* key, const glm::vec3& absent) {
  if (!object.Has(key) || !object.Get(key).IsArray()) return absent;
  const tinygltf::Value& list = object.Get(key);
  std::vector<double> numbers;
  for (int i = 0; i < static_cast<int>(list.ArrayLen()); ++i) numbers.push_back(list.Get(i).GetNumberAsDouble());
  return to_vec3(context, numbers, absent, key);
}

std::uint64_t count_or(const Context& context, const tinygltf::Value& object, const char* key, std::uint64_t absent) {
  constexpr double kMost = 9007199254740992;  // 2^53: a double represents every integer up to it
  if (!object.Has(key)) return absent;
  const double value = object.Get(key).IsNumber() ? object.Get(key).GetNumberAsDouble() : -1;
  if (!(value >= 0 && value <= kMost)) context.refuse(fmt::format("{} is not a number of 0 or more", key));
  return static_cast<std::uint64_t>(value);
}

int index_or_none(const tinygltf::Value& object, const char* key) {
  if (!object.Has(key) || !object.Get(key).IsInt()) return -1;
  return object.Get(key).GetNumberAsInt();
}

}  // namespace traces::gltf
