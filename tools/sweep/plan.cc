#include "tools/sweep/plan.h"

#include <algorithm>

#include <fmt/format.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/load_config.h"
#include "tools/sweep/conditions.h"
#include "tools/sweep/subset.h"
#include "tools/tile_sampling.h"
#include "traces/scene/library.h"

namespace tools::sweep {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = 100'000;  // of points.jsonl

/// A file is seen from the spec; a name is looked up later.
std::string from_folder(const std::string& text, const fs::path& folder) {
  const bool is_file = traces::is_scene_file(text) || text.ends_with(".yaml");
  return is_file && fs::path(text).is_relative() ? (fs::absolute(folder) / text).lexically_normal().string() : text;
}

void set_work(Point& point, const std::string& key, const std::string& value, const fs::path& folder) {
  if (value.empty()) return;
  if (key == "scene") point.scene = from_folder(value, folder);
  if (key == "camera") point.camera = value;
  if (key == "frames") point.frames = value;
  if (key == "resolution") point.resolution = value;
  if (key == "program") point.program = value;
}

/// What a run would say of this value alone.
void check_value(RunConfig base, const std::string& key, const std::string& value) {
  if (key == "program") kernels::parse_program(value);
  if (key == "resolution" && !value.empty()) parse_resolution(value);
  if (key == "frames" && !value.empty()) parse_frames(value);
  if (is_work_key(key)) return;
  sim::ConfigNode tree = sim::config_tree(base);
  const std::string argument = fmt::format("{}={}", key, value);
  try {
    sim::ConfigLoader(tree).apply_set(argument);
  } catch (const sim::InputError& error) {
    std::string text = error.what();  // without "--set key=value: ", which nobody has typed
    const std::string origin = "--set " + sim::printable(argument);
    if (text.starts_with(origin)) text.erase(0, std::min(text.size(), origin.size() + 2));
    throw sim::InputError(text);
  }
}

void check_values(const Spec& spec, const RunConfig& base) {
  for (const Axis& axis : spec.axes) {
    for (const Axis::Value& value : axis.values) {
      for (std::size_t k = 0; k < axis.keys.size(); ++k) {
        try {
          check_value(base, axis.keys[k], value.settings[k]);
        } catch (const sim::InputError& error) {
          sim::refuse(axis.at, "axes." + sim::printable(axis.name), error.what());
        }
      }
    }
  }
}

Point make_point(const Spec& spec, const fs::path& folder, const Choice& choice) {
  Point point;
  point.config = from_folder(spec.config, folder);
  point.reference = spec.reference;
  point.tile_sampling = spec.tile_sampling;
  point.image = spec.image;
  point.sets = spec.sets;
  for (const auto& [key, value] : {std::pair{"scene", &spec.scene},
                                   {"camera", &spec.camera},
                                   {"frames", &spec.frames},
                                   {"resolution", &spec.resolution},
                                   {"program", &spec.program}}) {
    set_work(point, key, *value, folder);
  }
  for (std::size_t a = 0; a < spec.axes.size(); ++a) {
    const Axis& axis = spec.axes[a];
    const Axis::Value& value = axis.values[choice[a]];
    point.axes.emplace_back(axis.name, value.label);
    for (std::size_t k = 0; k < axis.keys.size(); ++k) {
      if (is_work_key(axis.keys[k])) {
        set_work(point, axis.keys[k], value.settings[k], folder);
      } else {
        point.sets.push_back(axis.keys[k] + "=" + value.settings[k]);
      }
    }
  }
  return point;
}

}  // namespace

std::vector<Point> plan(const Spec& spec, const fs::path& folder) {
  const fs::path beside = folder.empty() ? fs::path(".") : folder;
  check_values(spec, load_base_config(from_folder(spec.config, beside), from_folder(spec.scene, beside)));
  if (!spec.tile_sampling.empty()) parse_tile_sampling(spec.tile_sampling, "full");
  if (!spec.tile_sampling.empty() && !spec.reference.empty()) {
    throw sim::InputError("reference and tile_sampling do not go together: sweep over programs, with all tiles");
  }
  std::vector<std::uint32_t> sizes;
  for (const Axis& axis : spec.axes) sizes.push_back(static_cast<std::uint32_t>(axis.values.size()));
  const auto is_wanted = [&](const Choice& choice) {
    const auto here = [&](const Condition& condition) { return holds(condition, spec.axes, choice); };
    return std::ranges::all_of(spec.where, here) && std::ranges::none_of(spec.exclude, here);
  };
  std::vector<Point> points;
  PointKeys keys;
  for (const Choice& choice : choose(spec.subset, sizes, is_wanted)) {
    Point point = make_point(spec, beside, choice);
    point.n = points.size();
    keys.set_key(point);
    if (to_line(point).size() > kLongestLine) {
      throw sim::InputError(fmt::format("point {} takes more than {} bytes to say", point.n, kLongestLine));
    }
    points.push_back(std::move(point));
  }
  if (points.empty()) throw sim::InputError("no points: the conditions leave none");
  return points;
}

}  // namespace tools::sweep
