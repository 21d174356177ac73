#include "tools/studies/sweep/spec/plan.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/run/frame/load_config.h"
#include "tools/sampling/slices.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/studies/sweep/spec/subset.h"
#include "traces/scenes/library.h"

namespace tools::sweep {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = 100'000;  // bytes of a line of points.jsonl

/// A file is seen from the spec; a name is looked up later.
std::string from_folder(const std::string& text, const fs::path& folder) {
  const bool is_file = traces::is_scene_file(text) || text.ends_with(".yaml");
  return is_file && fs::path(text).is_relative() ? (fs::absolute(folder) / text).lexically_normal().string() : text;
}

/// A built-in name stays; a file is seen from the folder. InputError for names that points.jsonl cannot hold.
std::string scene_from(const std::string& value, const fs::path& folder) {
  std::string scene = from_folder(value, folder);
  if (sim::with_escaped_bytes(scene) == scene) return scene;
  throw sim::InputError(sim::printable(scene) +
                        ": the name is no UTF-8, which the files of a sweep are; allowed: another");
}

void set_work(Point& point, const std::string& key, const std::string& value, const fs::path& folder) {
  if (value.empty()) return;
  if (key == "scene") point.scene = scene_from(value, folder);
  if (key == "camera") point.camera = value;
  if (key == "frames") point.frames = value;
  if (key == "resolution") point.resolution = value;
  if (key == "program") point.program = value;
}

/// Throws the complaint of a run about "key=value" alone.
void check_setting(RunConfig base, const std::string& argument) {
  sim::ConfigNode tree = sim::config_tree(base);
  try {
    sim::ConfigLoader(tree).apply_set(argument);
  } catch (const sim::InputError& error) {
    std::string text = error.what();  // without "--set key=value: ", which nobody has typed
    const std::string origin = "--set " + sim::printable(argument);
    if (text.starts_with(origin)) text.erase(0, std::min(text.size(), origin.size() + 2));
    throw sim::InputError(text);
  }
}

/// Throws the complaint of a run about this value alone.
void check_value(const RunConfig& base, const std::string& key, const std::string& value) {
  if (key == "scene" && !value.empty() && !value.ends_with(".yaml")) check_scene(value);
  if (key == "program") kernels::parse_program(value);
  if (key == "resolution" && !value.empty()) parse_resolution(value);
  if (key == "frames" && !value.empty()) parse_frames(value);
  if (!is_work_key(key)) check_setting(base, fmt::format("{}={}", key, value));
}

/// Calls; what is refused then says where the file gives the key: in an axis, or by itself.
void at_key(const Spec& spec, const std::string& key, auto&& call) {
  try {
    call();
  } catch (const sim::InputError& error) {
    for (const Axis& axis : spec.axes) {
      if (std::ranges::find(axis.keys, key) != axis.keys.end()) {
        sim::refuse(axis.at, "axes." + sim::printable(axis.name), error.what());
      }
    }
    const auto position = spec.key_positions.find(key);
    if (position == spec.key_positions.end()) throw;
    sim::refuse(position->second, key, error.what());
  }
}

void check_values(const Spec& spec, const RunConfig& base) {
  at_key(spec, "sets", [&] {
    for (const std::string& set : spec.sets) check_setting(base, set);
  });
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

/// Refuses what does not go with slices.
void check_cut(const Spec& spec) {
  at_key(spec, "slices", [&] {
    const auto refuse = [](const char* key, const char* why) {
      throw sim::InputError(fmt::format("does not go with {}: {}", key, why));
    };
    if (!spec.tile_sampling.empty()) refuse("tile_sampling", "a sample of the tiles is not cut");
    if (!spec.reference.empty()) refuse("reference", "compare two points of equal slices");
    if (spec.replicates != 1) refuse("replicates", "they are played from one record of the whole frame");
    if (spec.image) refuse("image", "slices have parts of it, which nobody joins");
  });
  at_key(spec, "program", [&] {
    bool is_axis = false;
    for (const Axis& axis : spec.axes) {
      for (std::size_t k = 0; k < axis.keys.size(); ++k) {
        if (axis.keys[k] != "program") continue;
        is_axis = true;
        for (const Axis::Value& value : axis.values) check_slices(kernels::parse_program(value.settings[k]));
      }
    }
    if (!is_axis) check_slices(kernels::parse_program(spec.program));
  });
}

/// True if the point's line may be longer than allowed, at six bytes for an escaped one.
bool may_be_long(const Point& point) {
  std::size_t bytes = point.config.size() + point.scene.size() + point.camera.size() + point.error.size();
  for (const auto& [name, value] : point.axes) bytes += name.size() + value.size();
  for (const std::string& set : point.sets) bytes += set.size();
  constexpr std::size_t kOthers = 1000;  // ids, names of members, and what is short
  return 6 * bytes + 10 * (point.axes.size() + point.sets.size()) + kOthers > kLongestLine;
}

Point make_point(const Spec& spec, const fs::path& folder, const Choice& choice) {
  Point point;
  point.config = from_folder(spec.config, folder);
  point.reference = spec.reference;
  point.image = spec.image;
  point.replicates = spec.replicates;
  point.slices = spec.slices;
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

Planner::Planner(Spec spec, const fs::path& folder)
    : spec_(std::move(spec)), folder_(folder.empty() ? fs::path(".") : folder) {
  const std::string config = from_folder(spec_.config, folder_);
  at_key(spec_, "config", [&] { load_base_config(config, ""); });
  RunConfig base;
  at_key(spec_, "scene", [&] {
    const std::string scene = from_folder(spec_.scene, folder_);
    if (!scene.empty()) check_scene(scene);
    base = load_base_config(config, scene);
  });
  check_values(spec_, base);
  if (!spec_.tile_sampling.empty() && !spec_.reference.empty()) {
    throw sim::InputError("reference and tile_sampling do not go together: sweep over programs, with all tiles");
  }
  if (!spec_.tile_sampling.empty() && spec_.replicates != 1) {
    throw sim::InputError("replicates and tile_sampling do not go together: replicates play all tiles");
  }
  if (spec_.slices != 0) check_cut(spec_);
}

std::vector<std::uint32_t> Planner::sizes() const {
  std::vector<std::uint32_t> sizes;
  for (const Axis& axis : spec_.axes) sizes.push_back(static_cast<std::uint32_t>(axis.values.size()));
  return sizes;
}

bool Planner::is_wanted(const Choice& choice) const {
  const auto here = [&](const Condition& condition) { return holds(condition, choice); };
  return std::ranges::all_of(spec_.where, here) && !excluded_.holds(choice);
}

Point Planner::point(const Choice& choice) { return point(choice, spec_.tile_sampling); }

Point Planner::point(const Choice& choice, const std::string& tile_sampling) {
  Point point = make_point(spec_, folder_, choice);
  point.tile_sampling = tile_sampling;
  if (!tile_sampling.empty()) {  // replicates and slices play all tiles
    point.replicates = 1;
    point.slices = 0;
  }
  at_key(spec_, "scene", [&] { keys_.set_key(point); });
  if (may_be_long(point) && to_line(point).size() > kLongestLine) {
    throw sim::InputError(fmt::format("a point takes more than {} bytes to say", kLongestLine));
  }
  return point;
}

std::vector<Point> plan(const Spec& spec, const fs::path& folder, const Planned& planned) {
  Planner planner(spec, folder);
  std::vector<Point> points;
  const auto is_wanted = [&](const Choice& choice) { return planner.is_wanted(choice); };
  const std::vector<Choice> choices = choose(spec.subset, planner.sizes(), is_wanted);
  for (const Choice& choice : choices) {
    points.push_back(planner.point(choice));
    points.back().n = points.size() - 1;
    if (planned) planned(points.size(), choices.size());
  }
  if (points.empty()) {
    const std::string key = spec.where.empty() ? "exclude" : "where";
    at_key(spec, key, [] { throw sim::InputError("no points: the conditions leave none"); });
  }
  return points;
}

}  // namespace tools::sweep
