#include "tools/studies/worth/worth.h"

#include <algorithm>
#include <cctype>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sim/config/config_tree.h"
#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_file.h"
#include "tools/host/process.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/optimise/search_run.h"
#include "tools/studies/report/report.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::worth {
namespace {

namespace fs = std::filesystem;
using optimise::band_at;
using optimise::Goal;
using optimise::SearchRun;
using optimise::Task;
using optimise::Trial;
using optimise::WorkloadRun;
using sim::Json;
using sweep::PointStatus;
using sweep::Store;

constexpr std::uint32_t kLargestBatch = 64;  ///< largest batch when all machines are simulated

ReportFile read_point_report(const Store& store, const std::string& id) {
  const std::optional<std::string> bytes = store.read_report(id);
  if (!bytes) throw sim::IoError(fmt::format("{}: the result is gone", store.folder_of(id).string()));
  ReportFile report = parse_report(*bytes, store.folder_of(id) / "report.json");
  rank_identical_pictures(report);
  return report;
}

/// Returns a report's metric under low, nominal and high tables; all equal for a metric without a band.
sim::Band band_of(const ReportFile& report, const std::string& path) {
  constexpr std::string_view kArea = "totals.area_mm2", kNominal = ".nominal";
  if (path == kArea) return band_at(report, "totals.area_band_mm2");
  if (path.ends_with(kNominal)) return band_at(report, path.substr(0, path.size() - kNominal.size()));
  const double value = report.number(path);
  return {value, value, value};
}

LimitRoom room_to(const Goal& goal, double value) {
  return {goal.text(), goal.distance_text(value), value, goal.distance_to_limit(value)};
}

double frame_count(const ReportFile& report) {
  const double represented = report.number("totals.representative.frames");
  return represented > 0 ? represented : static_cast<double>(report.json["frames"].size());
}

WorkloadResult workload_result(const std::vector<Goal>& goals, const WorkloadRun& run, const ReportFile& report) {
  WorkloadResult out;
  out.name = sim::printable(report.text("scene", "name"));
  out.resolution = fmt::format("{}x{}", report.number("resolution[0]"), report.number("resolution[1]"));
  out.id = run.point.id;
  out.command = sim::printable(command_text(run.point.run_options().argv), 4096);
  out.fps = report.number("totals.perf.fps");
  out.energy_mj = band_at(report, "totals.energy_mj") * (1 / frame_count(report));
  out.target_fps = report.number("totals.at_fps.fps");
  out.power_w = band_at(report, out.target_fps > 0 ? "totals.power_at_fps_w" : "totals.power_w");
  if (report.has("totals.psnr_db")) out.psnr_db = report.number("totals.psnr_db");
  for (std::size_t g = 0; g < goals.size(); ++g) {
    if (!goals[g].is_objective() && goals[g].fold == sweep::SetMetric::Kind::kEach)
      out.rooms.push_back(room_to(goals[g], run.seen.at(g).value));
  }
  return out;
}

/// Converts a search's trial to a machine of the result.
Machine machine_of(const SearchRun& search, const Trial& trial, const Store& store) {
  Machine machine;
  for (const auto& [name, value] : trial.axes) machine.axes.emplace_back(sim::printable(name), sim::printable(value));
  machine.objective = trial.value(0);
  machine.objective_band = {machine.objective, machine.objective, machine.objective};
  const std::vector<Goal>& goals = search.goals();
  const std::vector<WorkloadRun>& runs = trial.best_runs();
  for (std::size_t w = 0; w < runs.size(); ++w) {
    const ReportFile report = read_point_report(store, runs[w].point.id);
    machine.workloads.push_back(workload_result(goals, runs[w], report));
    if (runs.size() > 1) machine.workloads.back().name = sim::printable(search.workloads()[w]);
    const std::string& metric = goals.front().metric;
    if (w == 0 && (runs.size() == 1 || sweep::is_metric_of_machine(metric)))
      machine.objective_band = band_of(report, metric);
  }
  for (std::size_t g = 0; g < goals.size(); ++g) {
    if (!goals[g].is_objective() && goals[g].fold != sweep::SetMetric::Kind::kEach)
      machine.rooms.push_back(room_to(goals[g], trial.value(g)));
  }
  return machine;
}

/// Reads the result of a finished search into `side`.
void read_search(const SearchRun& search, const Store& store, SideAnswer& side) {
  side.machines = search.simulated_count();
  side.failed = static_cast<std::size_t>(std::ranges::count(search.trials(), PointStatus::kFailed, &Trial::status));
  const std::vector<const Trial*> front = search.pareto_front();
  if (!front.empty()) side.best = machine_of(search, *front.front(), store);
}

/// Returns the number of axis combinations of a search space, including excluded machines.
std::uint64_t size_of_space(const Task& task) {
  std::uint64_t machines = 1;
  for (const sweep::Axis& axis : task.machine_axes()) machines *= axis.values.size();
  return machines;
}

/// Simulates all machines of a search space.
void simulate_all(const SideSearch& search, const optimise::Options& options, SideAnswer& side) {
  Task task = search.task;
  task.batch = kLargestBatch;
  task.simulates_all = true;
  optimise::Options all = options;
  all.budget = std::max(size_of_space(task), optimise::kLeastBudget);
  optimise::run(all, task, search.text, [&](const SearchRun& done) {
    side.all.emplace();
    side.all->machines = done.simulated_count();
    const std::vector<const Trial*> front = done.pareto_front();
    if (!front.empty()) side.all->objective = front.front()->value(0);
  });
}

/// Throws InputError if the output folder has contents that are not of `raywatt worth`.
void check_folder(const fs::path& out) {
  std::error_code failed;
  if (!fs::exists(out, failed)) return;
  const std::string name = sim::printable(out.string());
  if (!fs::is_directory(out, failed)) throw sim::InputError(fmt::format("{}: is a file, not a folder", name));
  const bool is_former = fs::exists(out / "without", failed) || fs::exists(out / "with", failed);
  if (!is_former && !fs::is_empty(out, failed)) {
    throw sim::InputError(
        fmt::format("{}: holds other files; allowed: a new or empty folder, or that of a former raywatt worth", name));
  }
}

void check_size(const WorthFile& file) {
  for (const SideSearch& side : file.sides) {
    const std::uint64_t machines = size_of_space(side.task);
    if (machines <= optimise::kMostBudget) continue;
    throw sim::InputError(fmt::format("{}: --check simulates all {} machines of its space; allowed: at most {}",
                                      side.task.file, machines, optimise::kMostBudget));
  }
}

/// Writes an HTML page per workload that compares the best machines of both sides. Returns the paths of the pages. With
/// several workloads, the name of the workload is appended to the file name.
std::vector<fs::path> write_pages(const Answer& answer, const Store& store, const fs::path& page) {
  std::vector<fs::path> files;
  const std::optional<Machine>&with = answer[Side::kWith].best, &any = with ? with : answer[Side::kWithout].best;
  if (!any) print_message("warning: no machine meets the constraints; there is no page");
  for (std::size_t w = 0; any && w < any->workloads.size(); ++w) {
    pages::Options options;
    for (const Side side : kSides) {
      const std::optional<Machine>& best = answer[side].best;
      if (!best) continue;
      options.inputs.push_back(store.folder_of(best->workloads[w].id));
      options.names.emplace_back(names_of(side).at(static_cast<std::size_t>(side)));
    }
    std::string name = any->workloads[w].name;
    std::ranges::replace_if(
        name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '-');
    options.out = page;
    if (any->workloads.size() > 1)
      options.out.replace_filename(page.stem().string() + "-" + name + page.extension().string());
    pages::write_report_page(options);
    files.push_back(options.out);
  }
  return files;
}

}  // namespace

int run(const Options& options) {
  check_options(options.search);
  Answer answer{read_worth_file(options.search.file), {}};
  if (options.check) check_size(answer.file);
  const fs::path out = !options.search.out.empty()
                           ? options.search.out
                           : fs::path("raywatt-out") / fmt::format("worth-{}", options.search.file.stem().string());
  check_folder(out);
  for (const SideSearch& side : answer.file.sides) optimise::check_task(options.search, side.task);
  const fs::path store_root = !options.search.store.empty() ? options.search.store : Store::default_root();
  const HoldInterrupts hold;
  for (const Side side : kSides) {
    const auto i = static_cast<std::size_t>(side);
    const SideSearch& search = answer.file.sides.at(i);
    SideAnswer& found = answer.sides.at(i);
    optimise::Options one = options.search;
    one.out = out / names_of(side).at(i);
    one.prints_answer = false;
    found.folder = one.out;
    optimise::run(one, search.task, search.text,
                  [&](const SearchRun& done) { read_search(done, Store(store_root), found); });
    if (is_interrupted()) return kGood;  // the destructor of `hold` ends the process
    if (!options.check) continue;
    one.out = out / fmt::format("all-{}", names_of(side).at(i));
    simulate_all(search, one, found);
    if (is_interrupted()) return kGood;
  }
  const Json json = worth_json(answer);
  sim::write_file_atomically(out / "worth.json", sim::json_lines(json));
  std::vector<fs::path> page_files;
  if (!options.page.empty()) page_files = write_pages(answer, Store(store_root), options.page);
  if (options.json) {
    fmt::print("{}", sim::json_lines(json));
  } else if (!options.search.quiet) {
    fmt::print("{}\nresults: {}\n", to_terminal_encoding(worth_text(answer)), (out / "worth.json").string());
    for (const fs::path& page : page_files) fmt::print("page:    {}\n", page.string());
  }
  const bool found_any = std::ranges::any_of(answer.sides, [](const SideAnswer& s) { return s.best.has_value(); });
  const bool is_good = std::ranges::all_of(answer.sides, [](const SideAnswer& s) { return s.failed == 0; }) &&
                       std::ranges::all_of(answer.sides, is_confirmed);
  return found_any && is_good ? kGood : kCheckFailed;
}

namespace {

using sim::YamlNode;
using sweep::YamlValue;
using Kind = YamlNode::Kind;
using NodePointer = std::shared_ptr<const YamlNode>;

constexpr std::uint64_t kMostBytes = 1 << 20;
constexpr std::string_view kSchema = "raywatt-worth/1";
/// Keys of a search's file that `without` and `with` may change.
constexpr std::array<std::string_view, 8> kSideKeys = {"config",      "program", "reference", "sets",
                                                       "constraints", "axes",    "exclude",   "where"};

NodePointer scalar_of(std::string text) {
  const auto node = std::make_shared<YamlNode>();
  node->kind = Kind::kScalar;
  node->scalar = std::move(text);
  return node;
}

/// Returns the default objectives as YAML: [{min: area_mm2}].
NodePointer smallest_area() {
  const auto goal = std::make_shared<YamlNode>(), list = std::make_shared<YamlNode>();
  goal->kind = Kind::kMapping;
  goal->entries = {{"min", {}, {}, scalar_of("area_mm2")}};
  list->kind = Kind::kSequence;
  list->entries = {{"", {}, {}, goal}};
  return list;
}

void set_entry(std::vector<YamlNode::Entry>& entries, const YamlNode::Entry& entry) {
  const auto found = std::ranges::find(entries, entry.key, &YamlNode::Entry::key);
  if (found == entries.end()) {
    entries.push_back(entry);
  } else {
    *found = entry;
  }
}

/// Merges an entry of `without` or `with` into the search's entry: joins lists, replaces axes by name.
YamlNode::Entry merge_entries(const YamlNode::Entry& search, const YamlNode::Entry& side, const std::string& where) {
  const Kind kind = side.value->kind;
  if (kind != search.value->kind)
    sim::refuse(where, side.key, fmt::format("must have the form of the search's '{}'", side.key));
  if (kind != Kind::kSequence && kind != Kind::kMapping) return side;
  const auto merged = std::make_shared<YamlNode>(*search.value);
  for (const YamlNode::Entry& entry : side.value->entries) {
    if (kind == Kind::kSequence) {
      merged->entries.push_back(entry);
    } else {
      set_entry(merged->entries, entry);
    }
  }
  YamlNode::Entry entry = side;
  entry.value = merged;
  return entry;
}

/// Returns a YAML value as one line, in flow style.
std::string flow_text(const YamlNode& node) {
  const auto quoted = [](const std::string& text) { return sim::json_line(text); };
  if (node.kind == Kind::kEmpty) return "~";
  if (node.kind == Kind::kScalar) return quoted(node.scalar);
  const bool is_mapping = node.kind == Kind::kMapping;
  std::string text(1, is_mapping ? '{' : '[');
  for (const YamlNode::Entry& entry : node.entries) {
    if (text.size() > 1) text += ", ";
    if (is_mapping) text += quoted(entry.key) + ": ";
    text += flow_text(*entry.value);
  }
  return text + (is_mapping ? '}' : ']');
}

/// Returns the search of one side. `changes`: the value of the key `without` or `with`.
SideSearch side_search(const YamlNode& root, const YamlValue& changes, const YamlNode& changed,
                       const std::string& name) {
  YamlNode search;
  search.kind = Kind::kMapping;
  for (const YamlNode::Entry& entry : root.entries) {
    if (entry.key == "feature" || entry.key == "without" || entry.key == "with") continue;
    search.entries.push_back(entry);
    if (entry.key == "schema") search.entries.back().value = scalar_of(std::string(optimise::kSchema));
  }
  if (search.find("objectives") == nullptr) search.entries.push_back({"objectives", {}, {}, smallest_area()});
  const std::vector<YamlValue> values = changes.entries(kSideKeys);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const YamlNode::Entry& entry = changed.entries[i];
    const YamlNode::Entry* const former = search.find(entry.key);
    set_entry(search.entries, former == nullptr ? entry : merge_entries(*former, entry, values[i].where()));
  }
  SideSearch side{optimise::parse_task(search, name), {}};
  for (const YamlNode::Entry& entry : search.entries) {
    side.text += fmt::format("{}: {}\n", entry.key,
                             entry.key == "schema" ? std::string(optimise::kSchema) : flow_text(*entry.value));
  }
  return side;
}

}  // namespace

WorthFile read_worth_file(const std::filesystem::path& file) {
  const std::string name = sim::printable(file.string());
  const NodePointer tree = sim::parse_yaml_mapping(sim::read_file(file, kMostBytes), name);
  const YamlValue root(*tree, name);
  const YamlNode::Entry* const schema = tree->find("schema");
  if (schema == nullptr || schema->value->scalar != kSchema)
    root.refuse(fmt::format("the first line shall be 'schema: {}'", kSchema));
  WorthFile out;
  std::array<std::optional<YamlValue>, 2> changes;
  for (const YamlValue& entry : root.entries()) {
    if (entry.key() == "feature") out.feature = sim::printable(entry.text());
    for (const Side side : kSides) {
      const auto i = static_cast<std::size_t>(side);
      if (entry.key() == names_of(side).at(i)) changes.at(i).emplace(entry);
    }
  }
  if (out.feature.empty()) root.refuse("has no feature; allowed: e.g. feature: adaptive sampling");
  for (const Side side : kSides) {
    const auto i = static_cast<std::size_t>(side);
    const std::string key(names_of(side).at(i));
    if (!changes.at(i)) root.refuse(fmt::format("has no '{0}'; allowed: e.g. {0}: {{program: full:1}}", key));
    out.sides.at(i) = side_search(*tree, *changes.at(i), *tree->find(key)->value, name);
    const auto objectives = std::ranges::count_if(out.sides.at(i).task.goals,
                                                  [](const optimise::Goal& goal) { return goal.is_objective(); });
    if (objectives != 1) root.refuse("has two objectives; allowed: one");
  }
  out.question = out.sides.front().task.space.question;
  return out;
}

}  // namespace tools::worth
