#pragma once
#include <utility>
#include <vector>

#include "traces/scene/pose.h"
#include "traces/scene/scene.h"

namespace traces {

inline Track track_of(Track::Path path, std::vector<float> times, std::vector<float> values,
                      Track::Interpolation interpolation = Track::Interpolation::kLinear) {
  Track track;
  track.path = path;
  track.interpolation = interpolation;
  track.times = std::move(times);
  track.values = std::move(values);
  return track;
}

/// Returns a scene with a node at the origin that has a triangle, a camera and a light.
inline Scene one_node() {
  Scene scene;
  scene.name = "one node";
  scene.nodes.resize(1);
  scene.nodes[0].name = "it";
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({0, glm::mat4(1), 0, false});
  scene.cameras.emplace_back().node = 0;
  scene.lights.emplace_back().node = 0;
  scene.lights[0].direction = {0, 0, -1};
  return scene;
}

}  // namespace traces
