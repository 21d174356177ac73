#include "tools/studies/sweep/spec/plan.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include <boost/random/sobol.hpp>
#include <fmt/format.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config.h"
#include "sim/config/config_tree.h"
#include "sim/error.h"
#include "sim/hash.h"
#include "sim/io/printable.h"
#include "tools/run/frame/load_config.h"
#include "tools/sampling/slices.h"
#include "tools/sampling/tile_sampling.h"
#include "traces/scenes/library.h"

namespace tools::sweep {

namespace fs = std::filesystem;

using Term = AxisCondition::Term;

std::optional<bool> outcome_of(const Term& term, const Operand& left, std::span<const Operand> rights) {
  for (const Operand& right : rights) {
    const std::optional<bool> outcome = compare(left, term.comparison, right);
    if (!outcome && needs_order(term.comparison)) return std::nullopt;
    if (outcome.value_or(term.comparison == Comparison::kUnequal)) return true;  // units of two kinds are unequal
  }
  return false;
}

bool meets_condition(const AxisCondition& condition, std::span<const std::uint32_t> choice) {
  return std::ranges::all_of(condition.terms, [&](const Term& term) {
    const std::uint32_t value = choice[term.left.axis];
    if (!term.right && term.outcomes[value]) return *term.outcomes[value];
    const Operand& left = (*term.lefts)[value];
    const auto rights =
        term.right ? std::span(*term.rights).subspan(choice[term.right->axis], 1) : std::span(term.values);
    if (const std::optional<bool> outcome = outcome_of(term, left, rights)) return *outcome;
    const auto has_no_order = [&](const Operand& right) { return !compare(left, term.comparison, right); };
    sim::refuse(
        term.at, {},
        fmt::format("'{}' and '{}' cannot be put in order; allowed: numbers, of one unit if they have units",
                    sim::printable(left.text), sim::printable(std::ranges::find_if(rights, has_no_order)->text)));
  });
}

namespace {

/// True if the outcome of a term of a condition is known in advance for every value of the axis on its left.
bool is_known(const Term& term) {
  return !term.right && std::ranges::all_of(term.outcomes, [](const auto& outcome) { return outcome.has_value(); });
}

/// True if the term can be evaluated for every combination of axis values without an error.
bool can_always_compare(const Term& term) {
  if (!term.right) return is_known(term);
  if (!needs_order(term.comparison)) return true;
  const std::optional<Magnitude>& first = term.lefts->front().magnitude;
  const auto is_alike = [&](const Operand& value) { return value.magnitude && value.magnitude->kind == first->kind; };
  return first && std::ranges::all_of(*term.lefts, is_alike) && std::ranges::all_of(*term.rights, is_alike);
}

/// Returns the term of a condition that holds for the fewest axis values. Considers only terms whose outcome is known
/// for every value of the axis. Returns null if there is none, or if an earlier term may throw an InputError.
const Term* find_rarest_term(const AxisCondition& condition) {
  const Term* best = nullptr;
  std::ptrdiff_t least = 0;
  for (const Term& term : condition.terms) {
    if (is_known(term)) {
      const std::ptrdiff_t values = std::ranges::count(term.outcomes, std::optional(true));
      if (best == nullptr || values < least) best = &term, least = values;
    }
    if (!can_always_compare(term)) break;
  }
  return best;
}

}  // namespace

AnyCondition::AnyCondition(std::span<const AxisCondition> conditions, std::span<const Axis> axes) {
  for (const Axis& axis : axes) by_value_.emplace_back(axis.values.size());
  for (const AxisCondition& condition : conditions) {
    const Term* term = find_rarest_term(condition);
    if (term == nullptr) {
      others_.push_back(&condition);
      continue;
    }
    for (std::size_t value = 0; value < term->outcomes.size(); ++value) {
      if (*term->outcomes[value]) by_value_[term->left.axis][value].push_back(&condition);
    }
  }
}

bool AnyCondition::meets_any(std::span<const std::uint32_t> choice) const {
  const auto is_met = [&](const AxisCondition* condition) { return meets_condition(*condition, choice); };
  for (std::size_t axis = 0; axis < by_value_.size(); ++axis) {
    if (std::ranges::any_of(by_value_[axis][choice[axis]], is_met)) return true;
  }
  return std::ranges::any_of(others_, is_met);
}

namespace {

constexpr std::uint64_t kMostDraws = 1U << 20;  // draws before giving up; they take about a second

/// Maps a random 32-bit number to an index below `values`; all indices are equally likely.
std::uint32_t scale_to_index(std::uint32_t number, std::uint32_t values) {
  return static_cast<std::uint32_t>((std::uint64_t{number} * values) >> 32);
}

std::uint64_t grid_size(std::span<const std::uint32_t> sizes) {
  std::uint64_t size = 1;
  for (const std::uint32_t values : sizes) size = std::min<std::uint64_t>(size * values, std::uint64_t{1} << 40);
  return size;
}

std::vector<Choice> list_grid(std::span<const std::uint32_t> sizes,
                              const std::function<bool(const Choice&)>& is_wanted) {
  if (grid_size(sizes) > kMostPoints) {
    throw sim::InputError(fmt::format(
        "the grid has more than {} points; allowed: a subset, e.g. 'subset: {{sobol: 1000}}'", kMostPoints));
  }
  std::vector<Choice> all;
  Choice choice(sizes.size(), 0);
  for (;;) {
    if (is_wanted(choice)) all.push_back(choice);
    std::size_t axis = sizes.size();
    while (axis != 0 && ++choice[axis - 1] == sizes[axis - 1]) choice[--axis] = 0;
    if (axis == 0) return all;
  }
}

/// Draws random combinations of axis values until `count` different ones pass the filter `is_wanted`.
template <class Draw>
std::vector<Choice> draw_until(std::uint64_t count, const std::function<bool(const Choice&)>& is_wanted, Draw&& draw) {
  std::vector<Choice> all;
  std::set<Choice> drawn;
  for (std::uint64_t i = 0; i < kMostDraws && all.size() < count; ++i) {
    Choice choice = draw(i);
    if (is_wanted(choice) && drawn.insert(choice).second) all.push_back(std::move(choice));
  }
  return all;
}

std::vector<Choice> draw_latin_hypercube(const Subset& subset, std::span<const std::uint32_t> sizes,
                                         const std::function<bool(const Choice&)>& is_wanted) {
  std::vector<Choice> all(subset.count, Choice(sizes.size()));
  std::vector<std::uint32_t> order(subset.count);
  for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(sim::hash(subset.seed, axis, i), i); });
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i][axis] = static_cast<std::uint32_t>(std::uint64_t{order[i]} * sizes[axis] / subset.count);
    }
  }
  std::set<Choice> seen;
  std::erase_if(all, [&](const Choice& choice) { return !seen.insert(choice).second || !is_wanted(choice); });
  return all;
}

}  // namespace

std::vector<Choice> choose_combinations(const Subset& subset, std::span<const std::uint32_t> sizes,
                                        const std::function<bool(const Choice&)>& is_wanted) {
  if (subset.kind == Subset::Kind::kGrid || sizes.empty()) return list_grid(sizes, is_wanted);
  if (subset.kind == Subset::Kind::kLatinHypercube) return draw_latin_hypercube(subset, sizes, is_wanted);
  const bool takes_all = grid_size(sizes) <= subset.count;  // random draws would take long to find the last ones
  if (takes_all) return list_grid(sizes, is_wanted);
  Choice choice(sizes.size());
  if (subset.kind == Subset::Kind::kRandom) {
    return draw_until(subset.count, is_wanted, [&](std::uint64_t i) {
      for (std::size_t a = 0; a < sizes.size(); ++a) {
        choice[a] = scale_to_index(static_cast<std::uint32_t>(sim::hash(subset.seed, i, a) >> 32), sizes[a]);
      }
      return choice;
    });
  }
  boost::random::sobol sequence(sizes.size());  // 64 bits a number, axis by axis
  return draw_until(subset.count, is_wanted, [&](std::uint64_t) {
    for (std::size_t a = 0; a < sizes.size(); ++a) {
      const std::uint64_t shift = sim::hash(subset.seed, a);  // XOR with random bits keeps the sequence evenly spread
      choice[a] = scale_to_index(static_cast<std::uint32_t>((sequence() ^ shift) >> 32), sizes[a]);
    }
    return choice;
  });
}

namespace {

constexpr std::size_t kLongestLine = 100'000;  // bytes of a line of points.jsonl

/// Makes a file name relative to `folder` absolute; returns a text that is no file name unchanged.
std::string resolve_file_name(const std::string& text, const fs::path& folder) {
  const bool is_file = traces::is_scene_file(text) || text.ends_with(".yaml");
  return is_file && fs::path(text).is_relative() ? (fs::absolute(folder) / text).lexically_normal().string() : text;
}

/// Returns the absolute path of a scene file whose name is relative to `folder`. Throws InputError for names that
/// points.jsonl cannot hold.
std::string resolve_scene_name(const std::string& value, const fs::path& folder) {
  std::string scene = resolve_file_name(value, folder);
  if (sim::with_escaped_bytes(scene) == scene) return scene;
  throw sim::InputError(sim::printable(scene) +
                        ": the name is no UTF-8, which the files of a sweep are; allowed: another");
}

void set_work(Point& point, const std::string& key, const std::string& value, const fs::path& folder) {
  if (value.empty()) return;
  const auto* const text =
      std::ranges::find(kPointTexts, key, [](const PointText& t) { return std::string_view(t.name); });
  point.*text->member = key == "scene" ? resolve_scene_name(value, folder) : value;
}

/// Checks one setting "key=value" on the base configuration; throws the InputError that a run would report.
void check_setting(RunConfig base, const std::string& argument) {
  sim::ConfigNode tree = sim::config_tree(base);
  try {
    sim::ConfigLoader(tree).apply_set(argument);
  } catch (const sim::InputError& error) {
    std::string text = error.what();  // without its prefix "--set key=value: "
    const std::string origin = "--set " + sim::printable(argument);
    if (text.starts_with(origin)) text.erase(0, std::min(text.size(), origin.size() + 2));
    throw sim::InputError(text);
  }
}

/// Checks an axis value: throws the InputError of a run with only this change to the base configuration.
void check_value(const RunConfig& base, const std::string& key, const std::string& value) {
  if (key == "scene" && !value.empty() && !value.ends_with(".yaml")) check_scene(value);
  if (key == "program") kernels::parse_program(value);
  if (key == "resolution" && !value.empty()) parse_resolution(value);
  if (key == "frames" && !value.empty()) parse_frames(value);
  if (!is_work_key(key)) check_setting(base, fmt::format("{}={}", key, value));
}

/// Calls `call`. Adds the position of `key` in the sweep's file to an InputError that `call` throws.
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

/// Throws InputError for options of a sweep that cannot be combined with slices.
void check_slicing(const Spec& spec) {
  at_key(spec, "slices", [&] {
    const auto refuse = [](const char* key, const char* why) {
      throw sim::InputError(fmt::format("does not go with {}: {}", key, why));
    };
    if (!spec.tile_sampling.empty()) refuse("tile_sampling", "a sample of the tiles is not cut");
    if (!spec.representative.empty()) refuse("representative", "representative frames are not cut");
    if (!spec.reference.empty()) refuse("reference", "compare two points of equal slices");
    if (spec.replicates != 1) refuse("replicates", "they are played from one record of the whole frame");
    if (spec.image) refuse("image", "slices have parts of it, which are not joined");
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

/// True if the point's line in points.jsonl would be too long if each byte were escaped, which takes six bytes.
bool may_be_long(const Point& point) {
  std::size_t bytes = point.config.size() + point.scene.size() + point.camera.size() + point.error.size();
  for (const auto& [name, value] : point.axes) bytes += name.size() + value.size();
  for (const std::string& set : point.sets) bytes += set.size();
  constexpr std::size_t kOthers = 1000;  // bytes for ids, member names and short members
  return 6 * bytes + 10 * (point.axes.size() + point.sets.size()) + kOthers > kLongestLine;
}

/// Makes the point of a combination of axis values. Its members `id` and `stream` stay empty.
Point unkeyed_point(const Spec& spec, const fs::path& folder, const Choice& choice) {
  Point point;
  point.config = resolve_file_name(spec.config, folder);
  point.reference = spec.reference;
  point.representative = spec.representative;
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
  const std::string config = resolve_file_name(spec_.config, folder_);
  at_key(spec_, "config", [&] { load_base_config(config, ""); });
  RunConfig base;
  at_key(spec_, "scene", [&] {
    const std::string scene = resolve_file_name(spec_.scene, folder_);
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
  if (!spec_.representative.empty()) {
    at_key(spec_, "representative", [&] {
      if (!spec_.reference.empty()) throw sim::InputError("does not go with reference; allowed: one of the two");
      if (spec_.replicates != 1) throw sim::InputError("does not go with replicates; allowed: one of the two");
    });
  }
  if (spec_.slices != 0) check_slicing(spec_);
}

std::vector<std::uint32_t> Planner::axis_sizes() const {
  std::vector<std::uint32_t> sizes;
  for (const Axis& axis : spec_.axes) sizes.push_back(static_cast<std::uint32_t>(axis.values.size()));
  return sizes;
}

bool Planner::is_wanted(const Choice& choice) const {
  const auto is_met = [&](const AxisCondition& condition) { return meets_condition(condition, choice); };
  return std::ranges::all_of(spec_.where, is_met) && !excluded_.meets_any(choice);
}

Point Planner::make_point(const Choice& choice) { return make_point(choice, spec_.tile_sampling); }

Point Planner::make_point(const Choice& choice, const std::string& tile_sampling) {
  Point point = unkeyed_point(spec_, folder_, choice);
  point.tile_sampling = tile_sampling;
  if (!tile_sampling.empty()) {  // replicates and slices are not possible with tile sampling
    point.replicates = 1;
    point.slices = 0;
  }
  at_key(spec_, "scene", [&] { keys_.set_key(point); });
  if (may_be_long(point) && format_point_line(point).size() > kLongestLine) {
    throw sim::InputError(fmt::format("the description of a point has more than {} bytes", kLongestLine));
  }
  return point;
}

std::vector<Point> plan_points(const Spec& spec, const fs::path& folder, const PlanProgress& progress) {
  Planner planner(spec, folder);
  std::vector<Point> points;
  const auto is_wanted = [&](const Choice& choice) { return planner.is_wanted(choice); };
  const std::vector<Choice> choices = choose_combinations(spec.subset, planner.axis_sizes(), is_wanted);
  for (const Choice& choice : choices) {
    points.push_back(planner.make_point(choice));
    points.back().n = points.size() - 1;
    if (progress) progress(points.size(), choices.size());
  }
  if (points.empty()) {
    const std::string key = spec.where.empty() ? "exclude" : "where";
    at_key(spec, key, [] { throw sim::InputError("no points: the conditions leave none"); });
  }
  return points;
}

}  // namespace tools::sweep
