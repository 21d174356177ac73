#pragma once
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "tests/traces/scene/feature_scene.h"
#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/export.h"

namespace test {

// Helpers to read scenes that export_glb() wrote.

inline nlohmann::json document_of(const std::string& glb) {
  std::uint32_t size = 0;
  std::memcpy(&size, glb.data() + 12, sizeof size);
  return nlohmann::json::parse(glb.substr(20, size));
}

inline nlohmann::json exported(const traces::Scene& scene) { return document_of(traces::export_glb(scene)); }

inline traces::Scene round_trip_text(const traces::Scene& scene) {
  const TempFolder folder;
  return traces::load_gltf(folder.write("scene.glb", traces::export_glb(scene)));
}

/// Returns the node called `name` in a glTF document.
inline nlohmann::json node_of(const nlohmann::json& document, const std::string& name) {
  for (const nlohmann::json& node : document["nodes"]) {
    if (node.value("name", "") == name) return node;
  }
  ADD_FAILURE() << "no node is called " << name;
  return {};
}

inline void expect_near(const glm::vec3& a, const glm::vec3& b, float most) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], most);
}

}  // namespace test
