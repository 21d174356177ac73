#include "tools/studies/sweep/spec/spec.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/run/frame/job_options.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/studies/sweep/spec/axes.h"
#include "tools/studies/sweep/spec/conditions.h"
#include "tools/studies/sweep/spec/yaml_value.h"

namespace tools::sweep {
namespace {

constexpr std::uint64_t kMostSpecBytes = 1 << 20;
constexpr std::string_view kSpecSchema = "raywatt-sweep/1";
constexpr std::uint64_t kMostSlices = 10'000;
constexpr std::array<std::string_view, 21> kKeys = {
    "schema",     "question", "config",    "sets",      "scene",         "camera",     "frames",
    "resolution", "program",  "reference", "workloads", "programs",      "axes",       "exclude",
    "where",      "subset",   "image",     "slices",    "tile_sampling", "replicates", "slurm"};

Subset read_subset(const YamlValue& value) {
  constexpr std::array<std::string_view, 3> kKinds = {"random", "latin_hypercube", "sobol"};
  constexpr std::array<std::string_view, 4> kSubsetKeys = {"random", "latin_hypercube", "sobol", "seed"};
  constexpr std::uint64_t kMostPoints = 1'000'000;
  Subset subset;
  if (value.is_text()) {
    if (value.text() != "grid") value.refuse("allowed: grid, or {random: N}, {latin_hypercube: N}, {sobol: N}");
    return subset;
  }
  for (const YamlValue& entry : value.entries(kSubsetKeys)) {
    const auto kind = std::ranges::find(kKinds, entry.key());
    if (kind == kKinds.end()) {
      subset.seed = entry.whole_number(0, ~std::uint64_t{0});
    } else if (subset.kind != Subset::Kind::kGrid) {
      entry.refuse("allowed: one of random, latin_hypercube, sobol");
    } else {
      subset.kind = static_cast<Subset::Kind>(kind - kKinds.begin() + 1);
      subset.count = entry.whole_number(1, kMostPoints);
    }
  }
  if (subset.kind == Subset::Kind::kGrid)
    value.refuse("allowed: grid, or {random: N}, {latin_hypercube: N}, {sobol: N}");
  return subset;
}

/// A text that can be parsed.
std::string checked(const YamlValue& value, auto&& parse) {
  try {
    parse(value.text());
  } catch (const sim::InputError& error) {
    value.refuse(error.what());
  }
  return value.text();
}

void read_axes(const YamlValue& entry, std::vector<Axis>& axes) {
  for (const YamlValue& axis : entry.entries()) {
    axes.push_back(read_axis(axis));
    check_axes(axes);
  }
}

}  // namespace

bool is_work_key(const std::string& key) {
  constexpr std::array<std::string_view, 5> kWorkKeys = {"scene", "camera", "frames", "resolution", "program"};
  return std::ranges::find(kWorkKeys, key) != kWorkKeys.end();
}

bool moves_workload(const Axis& axis) {
  const auto is_of_workload = [](const std::string& key) {
    return (is_work_key(key) && key != "program") || key.starts_with("scene.") || key == "render.width" ||
           key == "render.height";
  };
  return std::ranges::any_of(axis.keys, is_of_workload);
}

Spec read_spec(const std::filesystem::path& file) {
  const std::string name = sim::printable(file.string());
  const auto tree = sim::parse_yaml_mapping(sim::read_file(file, kMostSpecBytes), name);
  return read_spec(YamlValue(*tree, name), kSpecSchema, {});
}

namespace {

/// A file of the other kind is told by its schema, before its keys are.
void check_schema(const YamlValue& root, std::string_view schema) {
  const auto entries = root.entries();
  const auto found = std::ranges::find(entries, "schema", &YamlValue::key);
  if (found == entries.end()) root.refuse(fmt::format("the first line shall be 'schema: {}'", schema));
  const std::string& given = found->text();
  if (given == schema) return;
  const bool is_sweep = given == kSpecSchema, is_search = given.starts_with("raywatt-optimise/");
  found->refuse(fmt::format("allowed: {}{}", schema,
                            is_sweep    ? "; a sweep is run by raywatt sweep run"
                            : is_search ? "; a search is run by raywatt optimise"
                                        : ""));
}

/// Refuses a random subset of a space that has workloads as an axis: each machine would run other workloads, so that
/// machines could not be compared.
void check_subset(const Spec& spec) {
  if (spec.subset.kind == Subset::Kind::kGrid) return;
  const Axis *workload = nullptr, *machine = nullptr;
  for (const Axis& axis : spec.axes) {
    if (axis.values.size() > 1) (moves_workload(axis) ? workload : machine) = &axis;
  }
  if (workload == nullptr || machine == nullptr) return;
  sim::refuse(spec.key_positions.at("subset"), "subset",
              fmt::format("draws '{}' and '{}' together, so machines would render different workloads; allowed: grid, "
                          "or one workload",
                          sim::printable(workload->name), sim::printable(machine->name)));
}

}  // namespace

Spec read_spec(const YamlValue& root, std::string_view schema, std::span<const std::string_view> others) {
  check_schema(root, schema);
  std::vector<std::string_view> keys(kKeys.begin(), kKeys.end());
  keys.insert(keys.end(), others.begin(), others.end());
  Spec spec;
  std::optional<Axis> workloads, programs;
  std::optional<YamlValue> exclude, where;
  for (const YamlValue& entry : root.entries(keys)) {
    const std::string& key = entry.key();
    if (std::ranges::find(others, key) != others.end()) continue;
    spec.key_positions[key] = entry.where();
    if (key == "schema") continue;
    if (key == "question") {
      spec.question = entry.text();
    } else if (key == "config") {
      spec.config = entry.text();
    } else if (key == "sets") {
      spec.sets = entry.texts();
    } else if (key == "scene") {
      spec.scene = entry.text();
    } else if (key == "camera") {
      spec.camera = entry.text();
    } else if (key == "frames") {
      spec.frames = checked(entry, parse_frames);
    } else if (key == "resolution") {
      spec.resolution = checked(entry, parse_resolution);
    } else if (key == "program") {
      spec.program = checked(entry, kernels::parse_program);
    } else if (key == "reference") {
      spec.reference = checked(entry, kernels::parse_program);
    } else if (key == "tile_sampling") {
      spec.tile_sampling = checked(entry, [](const std::string& text) { parse_tile_sampling(text, "full"); });
    } else if (key == "replicates") {
      spec.replicates = static_cast<std::uint32_t>(entry.whole_number(1, kMostReplicates));
    } else if (key == "slices") {
      spec.slices = static_cast<std::uint32_t>(entry.whole_number(2, kMostSlices));
    } else if (key == "image") {
      spec.image = entry.yes_or_no();
    } else if (key == "slurm") {
      spec.slurm = entry.texts();
    } else if (key == "subset") {
      spec.subset = read_subset(entry);
    } else if (key == "workloads") {
      workloads = read_workloads(entry);
    } else if (key == "programs") {
      programs = read_list("program", entry);
    } else if (key == "axes") {
      read_axes(entry, spec.axes);
    } else {
      (key == "where" ? where : exclude) = entry;
    }
  }
  if (programs) spec.axes.insert(spec.axes.begin(), *std::move(programs));
  if (workloads) spec.axes.insert(spec.axes.begin(), *std::move(workloads));
  check_axes(spec.axes);
  if (exclude) spec.exclude = read_conditions(*exclude, spec.axes);
  if (where) spec.where = read_conditions(*where, spec.axes);
  check_subset(spec);
  return spec;
}

}  // namespace tools::sweep
