#include "tools/studies/sweep/spec/point_keys.h"

#include <utility>
#include <vector>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"
#include "tools/host/build_info.h"
#include "tools/run/frame/load_config.h"
#include "tools/sampling/slices.h"
#include "traces/scene/gltf/budget.h"
#include "traces/scene/gltf/source.h"
#include "traces/scenes/library.h"

namespace tools::sweep {
namespace {

using sim::Json;

/// Pictures and estimates are no streams.
bool can_share(const Point& point) { return point.tile_sampling.empty() && !point.image && point.slices == 0; }

}  // namespace

const ConfigVariants& PointKeys::apply(const Point& point) {
  const std::pair key(point.config, point.scene);
  auto base = bases_.find(key);
  if (base == bases_.end()) {
    RunConfig config = load_base_config(point.config, point.scene);
    base = bases_.try_emplace(key, std::move(config), sim::find_config(point.config).string()).first;
  }
  base->second.apply(point.options());
  return base->second;
}

const RunConfig& PointKeys::config_of(const Point& point) { return apply(point).config(); }

PointKeys::Key PointKeys::key_of(const Point& point) { return make_key(point, apply(point)); }

std::string PointKeys::scene_digest(const RunConfig& config) {
  const std::filesystem::path file = traces::scene_file(config.scene.name);
  if (file.empty()) {
    traces::check_builtin_name(config.scene.name);
    return std::string(kBuiltIn);  // made of the model's sources and of keys
  }
  auto digest = digests_.find(file.string());
  if (digest == digests_.end()) {
    traces::gltf::Budget budget(sim::printable(file.string()), config.limits.memory.bytes);
    digest = digests_.emplace(file.string(), traces::gltf::read_source(file, config.limits, budget).sha256).first;
  }
  return digest->second;
}

PointKeys::Key PointKeys::make_key(const Point& point, const ConfigVariants& applied) {
  const BuildInfo build = build_info();
  const std::string program = kernels::parse_program(point.program).name();
  const std::string reference = point.reference.empty() ? "" : kernels::parse_program(point.reference).name();
  Json work = {{"model_id", build.model_id},
               {"scene_sha256", scene_digest(applied.config())},
               {"program", program},
               {"reference", reference}};
  Key key;
  key.made_of = {{"schema", "raywatt-point/1"},
                 {"report_id", build.report_id},
                 {"config_hash", applied.hash({})},
                 {"tile_sampling", point.tile_sampling},
                 {"image", point.image},
                 {"replicates", point.replicates},
                 {"slices", point.slices}};
  key.made_of.update(work);
  key.id = sim::sha256_hex(sim::json_line(key.made_of));
  if (can_share(point)) {
    work["function_hash"] = applied.hash(sim::Affects::kFunction);
    key.stream = sim::sha256_hex(sim::json_line(work));
  }
  return key;
}

void PointKeys::set_key(Point& point) {
  point.stream.clear();
  point.error.clear();
  const ConfigVariants* applied = nullptr;
  try {
    applied = &apply(point);
    if (point.slices != 0) tools::slice_count(applied->config(), kernels::parse_program(point.program), point.slices);
  } catch (const sim::InputError& error) {
    point.error = error.what();
    point.id.clear();
    const std::uint64_t n = std::exchange(point.n, 0);
    point.id = sim::sha256_hex(to_line(point) + std::string(build_info().model_id));
    point.n = n;
    return;
  }
  Key key = make_key(point, *applied);
  point.id = std::move(key.id);
  point.stream = std::move(key.stream);
}

}  // namespace tools::sweep
