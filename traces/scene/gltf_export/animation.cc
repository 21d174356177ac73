#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "traces/scene/gltf_export/nodes.h"
#include "traces/scene/pose.h"

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

void normalise_rotation(std::span<float, 4> q) {
  const glm::dvec4 wide(q[0], q[1], q[2], q[3]);
  const double length = glm::length(wide);
  const glm::dvec4 unit = length > 0 ? wide / length : glm::dvec4(0, 0, 0, 1);
  for (int i = 0; i < 4; ++i) q[static_cast<std::size_t>(i)] = static_cast<float>(unit[i]);
}

/// Replaces keys before time 0, which glTF does not allow, by one key at 0.
void move_first_key_to_zero(Track& track) {
  const auto first = std::ranges::lower_bound(track.times, 0.0F);
  const auto earlier = first - track.times.begin();
  if (earlier == 0) return;
  const bool has_key_at_zero = first != track.times.end() && *first == 0;
  const bool spline = track.interpolation == Track::Interpolation::kCubicSpline;
  const std::size_t row = track.values.size() / track.times.size(), count = spline ? row / 3 : row;
  std::vector<double> value(count), slope(spline ? count : 0);
  sample_track(track, 0, value);
  if (spline) sample_track_slope(track, 0, slope);
  std::vector<float> key;
  for (const std::vector<double>& part : {slope, value, slope}) key.insert(key.end(), part.begin(), part.end());
  track.times.erase(track.times.begin(), first);
  track.values.erase(track.values.begin(), track.values.begin() + earlier * static_cast<std::ptrdiff_t>(row));
  if (has_key_at_zero) return;
  track.times.insert(track.times.begin(), 0.0F);
  track.values.insert(track.values.begin(), key.begin(), key.end());
}

/// Makes the key times of an animation track distinct. Of keys at the same time, the first moves to just before that
/// time, the last stays, and all between are removed.
void make_key_times_distinct(Track& track) {
  const std::size_t row = track.values.size() / track.times.size();
  std::vector<float> times, values;
  for (std::size_t i = 0; i < track.times.size(); ++i) {
    float time = track.times[i];
    if (i + 1 < track.times.size() && track.times[i + 1] == time) {
      time = std::nextafter(time, -1.0F);
      const bool is_middle = i > 0 && track.times[i - 1] == track.times[i];
      if (is_middle || time < 0 || (!times.empty() && times.back() >= time)) continue;
    }
    times.push_back(time);
    const float* first = &track.values[i * row];
    values.insert(values.end(), first, first + row);
  }
  track.times = std::move(times);
  track.values = std::move(values);
}

/// Returns the track changed to what glTF allows: key times ascend from 0, rotations have unit length, and a cubic
/// spline has two keys or more.
Track make_track_valid(Track track) {
  move_first_key_to_zero(track);
  make_key_times_distinct(track);
  if (track.interpolation == Track::Interpolation::kCubicSpline && track.times.size() == 1) {
    const auto part = static_cast<std::ptrdiff_t>(track.values.size() / 3);
    track.values = {track.values.begin() + part, track.values.begin() + 2 * part};
    track.interpolation = Track::Interpolation::kStep;
  }
  const bool spline = track.interpolation == Track::Interpolation::kCubicSpline;
  for (std::size_t i = spline ? 4 : 0; track.path == Track::Path::kRotation && i < track.values.size();
       i += spline ? 12 : 4) {
    normalise_rotation(std::span<float, 4>(&track.values[i], 4));
  }
  return track;
}

int add_values(const Track& track, Document& out) {
  const std::span<const float> values(track.values);
  if (track.path == Track::Path::kRotation) {
    const std::span<const glm::vec4> list(reinterpret_cast<const glm::vec4*>(values.data()), values.size() / 4);
    return out.add_array(list, Document::Use::kOther);
  }
  if (track.path == Track::Path::kMorphWeights) return out.add_array(values, false);
  const std::span<const glm::vec3> list(reinterpret_cast<const glm::vec3*>(values.data()), values.size() / 3);
  return out.add_array(list, false, Document::Use::kOther);
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
    const Track written = make_track_valid(track);
    const auto [input, is_new] = inputs.try_emplace(written.times, 0);
    if (is_new) input->second = out.add_array(written.times, true);
    tinygltf::AnimationSampler sampler;
    sampler.input = input->second;
    sampler.output = add_values(written, out);
    sampler.interpolation = name_of(written.interpolation);
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
