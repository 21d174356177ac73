#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "traces/scene/gltf_export/nodes.h"

namespace traces::gltf_export {
namespace {

const char* name_of(Track::Path path) {
  switch (path) {
    case Track::Path::kTranslation:
      return "translation";
    case Track::Path::kRotation:
      return "rotation";
    case Track::Path::kScale:
      return "scale";
    case Track::Path::kMorphWeights:
      break;
  }
  return "weights";
}

const char* name_of(Track::Interpolation interpolation) {
  switch (interpolation) {
    case Track::Interpolation::kStep:
      return "STEP";
    case Track::Interpolation::kCubicSpline:
      return "CUBICSPLINE";
    case Track::Interpolation::kLinear:
      break;
  }
  return "LINEAR";
}

int add_values(const Track& track, Document& out) {
  const std::span<const float> values(track.values);
  if (track.path == Track::Path::kRotation) {
    const std::span<const glm::vec4> list(reinterpret_cast<const glm::vec4*>(values.data()), values.size() / 4);
    return out.add(list, Document::Use::kOther);
  }
  if (track.path == Track::Path::kMorphWeights) return out.add(values, false);
  const std::span<const glm::vec3> list(reinterpret_cast<const glm::vec3*>(values.data()), values.size() / 3);
  return out.add(list, false, Document::Use::kOther);
}

}  // namespace

void write_animation(const Scene& scene, const NodeMap& map, Document& out) {
  tinygltf::Animation animation;
  std::set<std::pair<std::uint32_t, Track::Path>> moved;
  std::map<std::vector<float>, int> inputs;
  for (const Track& track : scene.tracks) {
    const bool morphs = track.path == Track::Path::kMorphWeights;
    const std::vector<int> targets = morphs ? map.morphing[track.node] : std::vector<int>{map.gltf_nodes[track.node]};
    if (track.times.empty() || targets.empty() || !moved.emplace(track.node, track.path).second) continue;
    const auto [input, is_new] = inputs.try_emplace(track.times, 0);
    if (is_new) input->second = out.add(track.times, true);
    tinygltf::AnimationSampler sampler;
    sampler.input = input->second;
    sampler.output = add_values(track, out);
    sampler.interpolation = name_of(track.interpolation);
    for (const int target : targets) {
      tinygltf::AnimationChannel channel;
      channel.sampler = static_cast<int>(animation.samplers.size());
      channel.target_node = target;
      channel.target_path = name_of(track.path);
      animation.channels.push_back(channel);
    }
    animation.samplers.push_back(sampler);
  }
  if (!animation.channels.empty()) out.model.animations.push_back(animation);
}

}  // namespace traces::gltf_export
