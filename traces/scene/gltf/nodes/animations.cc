#include "traces/scene/gltf/nodes/animations.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "traces/scene/gltf/accessors.h"

namespace traces::gltf {
namespace {

using Path = Track::Path;
using Interpolation = Track::Interpolation;

/// Returns the property that a channel moves; none, with a warning, if it is not one of glTF's own.
std::optional<Path> read_path(Context& context, const std::string& name, const std::string& what) {
  if (name == "translation") return Path::kTranslation;
  if (name == "rotation") return Path::kRotation;
  if (name == "scale") return Path::kScale;
  if (name == "weights") return Path::kMorphWeights;
  context.warn(name == "pointer" ? what + ": KHR_animation_pointer is not supported, its channels stand still"
                                 : fmt::format("{}: the path '{}' is not known", what, sim::printable(name)));
  return std::nullopt;
}

Interpolation read_interpolation(const Context& context, const std::string& name, const std::string& what) {
  if (name.empty() || name == "LINEAR") return Interpolation::kLinear;
  if (name == "STEP") return Interpolation::kStep;
  if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
  context.refuse(
      fmt::format("{}: interpolation '{}'; allowed are LINEAR, STEP, CUBICSPLINE", what, sim::printable(name)));
}

template <class Vector>
std::vector<float> numbers_of(const std::vector<Vector>& vectors) {
  std::vector<float> numbers;
  numbers.reserve(vectors.size() * static_cast<std::size_t>(Vector::length()));
  for (const Vector& v : vectors) {
    for (int i = 0; i < Vector::length(); ++i) numbers.push_back(v[i]);
  }
  return numbers;
}

std::vector<float> read_values(Context& context, Path path, int accessor) {
  if (path == Path::kRotation) return numbers_of(read_vec4(context, accessor, "rotation keys"));
  if (path == Path::kMorphWeights) return read_floats(context, accessor, "weight keys");
  return numbers_of(read_vec3(context, accessor, "keys"));
}

std::size_t numbers_per_key(const Context& context, const Track& track) {
  const std::size_t parts = track.interpolation == Interpolation::kCubicSpline ? 3 : 1;
  if (track.path == Path::kRotation) return parts * 4;
  if (track.path == Path::kMorphWeights) return parts * context.scene.nodes[track.node].morph_weights.size();
  return parts * 3;
}

void read_keys(Context& context, const tinygltf::AnimationSampler& sampler, const std::string& what, Track& track) {
  track.interpolation = read_interpolation(context, sampler.interpolation, what);
  track.times = read_floats(context, sampler.input, "key times");
  if (!std::ranges::is_sorted(track.times)) context.refuse(what + ": the key times must grow");
  track.values = read_values(context, track.path, sampler.output);
  const std::size_t expected = numbers_per_key(context, track);
  if (track.values.size() != track.times.size() * expected) {
    context.refuse(
        fmt::format("{}: {} numbers for {} keys of {}", what, track.values.size(), track.times.size(), expected));
  }
}

}  // namespace

void read_animations(Context& context) {
  std::set<std::pair<std::uint32_t, Path>> taken;
  for (std::size_t a = 0; a < context.model.animations.size(); ++a) {
    const tinygltf::Animation& animation = context.model.animations[a];
    const std::string name =
        fmt::format("animations[{}]{}{}", a, animation.name.empty() ? "" : " ", sim::printable(animation.name));
    for (std::size_t c = 0; c < animation.channels.size(); ++c) {
      const tinygltf::AnimationChannel& channel = animation.channels[c];
      const std::optional<Path> path = read_path(context, channel.target_path, name);
      if (!path || channel.target_node < 0) continue;
      Track track;
      track.path = *path;
      track.node = context.at(context.scene_nodes, channel.target_node, "nodes");
      if (track.node == kNone) continue;
      const std::vector<float>& weights = context.scene.nodes[track.node].morph_weights;
      if (track.path == Path::kMorphWeights && weights.empty()) continue;
      if (!taken.emplace(track.node, track.path).second) {
        context.warn(name + " moves what is moved already: only the first counts");
        continue;
      }
      const auto& sampler = context.at(animation.samplers, channel.sampler, (name + ".samplers").c_str());
      read_keys(context, sampler, fmt::format("{}.channels[{}]", name, c), track);
      context.scene.tracks.push_back(std::move(track));
    }
  }
}

}  // namespace traces::gltf
