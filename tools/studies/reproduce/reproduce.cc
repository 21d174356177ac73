#include "tools/studies/reproduce/reproduce.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/config.h"
#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "sim/sha256.h"
#include "tools/host/build_info.h"
#include "tools/host/paths.h"
#include "tools/host/process.h"
#include "tools/host/run_folder.h"
#include "traces/accel/embree_tracer.h"
#include "traces/scene/did_you_mean.h"

namespace tools::reproduce {
namespace {

/// Results of an earlier run in the output folder.
struct EarlierResults {
  std::size_t rows = 0;       ///< number of rows; new results replace them only with more rows, or when complete
  std::vector<Row> finished;  ///< reusable rows, if it was an interrupted run of the same experiments
};

}  // namespace

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMostPublishedBytes = 1 << 20;

using Entry = sim::YamlNode::Entry;
using Kind = sim::YamlNode::Kind;

/// Parser of a YAML file of published values.
class PublishedReader {
 public:
  explicit PublishedReader(const std::string& name) : name_(name) {}

  PublishedValues read(const sim::YamlNode& root) {
    for (const Entry& experiment : root.entries) {
      for (const Entry& scene : entries_of(experiment, "scenes")) {
        for (const Entry& setting : entries_of(scene, "settings")) {
          for (const Entry& metric : entries_of(setting, "figures")) {
            out_.emplace(MetricKey{experiment.key, scene.key, setting.key, metric.key}, read_range(metric));
          }
        }
      }
    }
    return std::move(out_);
  }

 private:
  [[noreturn]] void refuse(const Entry& at, std::string_view what) const {
    throw sim::InputError(
        fmt::format("{}:{}:{}: '{}' {}", name_, at.key_at.line, at.key_at.column, sim::printable(at.key), what));
  }

  const std::vector<Entry>& entries_of(const Entry& entry, std::string_view of) const {
    if (entry.value->kind != Kind::kMapping) refuse(entry, fmt::format("must be a mapping of {}", of));
    return entry.value->entries;
  }

  double read_number(const Entry& entry) const {
    const std::string& text = entry.value->scalar;
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (entry.value->kind != Kind::kScalar || error != std::errc{} || end != text.data() + text.size() ||
        !std::isfinite(value)) {
      refuse(entry, "must be a number");
    }
    return value;
  }

  Range read_range(const Entry& entry) const {
    if (entry.value->kind == Kind::kScalar) return {read_number(entry), read_number(entry)};
    const std::vector<Entry>& ends = entries_of(entry, "low and high, or a number");
    const Entry* low = entry.value->find("low");
    const Entry* high = entry.value->find("high");
    if (low == nullptr || high == nullptr || ends.size() != 2 || read_number(*low) > read_number(*high)) {
      refuse(entry, "must be a number, or {low: number, high: a greater number}");
    }
    return {read_number(*low), read_number(*high)};
  }

  const std::string& name_;
  PublishedValues out_;
};

}  // namespace

PublishedValues parse_published_values(const std::string& text, const std::string& name) {
  return PublishedReader(name).read(*sim::parse_yaml_mapping(text, name));
}

PublishedValues load_published_values(const std::string& paper) {
  const std::string name = paper + ".yaml";
  for (const std::filesystem::path& folder : search_folders()) {
    for (const std::filesystem::path& file :
         {folder / "tests" / "validation" / "published" / name, folder / "published" / name}) {
      std::error_code missing;
      if (std::filesystem::exists(file, missing))
        return parse_published_values(sim::read_file(file, kMostPublishedBytes), file);
    }
  }
  throw sim::InputError(
      fmt::format("the published figures of {} are neither in the source tree nor installed; "
                  "$RAYWATT_PATH may name a folder that has published/{}",
                  paper, name));
}

namespace {

std::string measured_text(const Row& row) {
  if (!row.measured) return row.why_not;
  return metric_text(find_metric(row.key.metric), *row.measured);
}

std::string published_text(const Row& row) {
  if (!row.published) return "";
  const Metric& metric = find_metric(row.key.metric);
  const std::string low = metric_text(metric, row.published->low);
  return row.published->low == row.published->high ? low : low + " to " + metric_text(metric, row.published->high);
}

/// Returns the difference between the measured and the published value, in dB or percent.
std::string difference_text(const Row& row) {
  if (!row.measured || !row.published) return "";
  const double value = *row.measured;
  const double nearest = std::clamp(value, row.published->low, row.published->high);
  if (row.published->low != row.published->high && value == nearest) return "within";
  if (find_metric(row.key.metric).shown == Metric::Shown::kDecibel) return fmt::format("{:+.1f} dB", value - nearest);
  return fmt::format("{:+.0f} %", 100 * (value / nearest - 1));
}

std::string size_text(const Row& row) { return fmt::format("{}x{}", row.width, row.height); }

std::string heading_text(const Results& results) {
  std::string out = results.title;
  if (results.quick) out += ", quick: few pixels, so the values only show that it runs";
  if (results.shrink > 1) out += fmt::format(", sides of pictures divided by {}", results.shrink);
  if (results.partial) out += "; PARTIAL: some settings have not run";
  return out;
}

/// Groups result rows by experiment, in the order in which experiments first occur.
std::vector<Row> group_rows_by_experiment(std::vector<Row> rows) {
  std::vector<std::string> order;
  for (const Row& row : rows) {
    if (std::ranges::find(order, row.key.experiment) == order.end()) order.push_back(row.key.experiment);
  }
  std::ranges::stable_sort(rows, {}, [&](const Row& r) { return std::ranges::find(order, r.key.experiment); });
  return rows;
}

sim::Json rows_json(const Results& results) {
  sim::Json out = sim::Json::array();
  for (const Row& row : results.rows) {
    sim::Json entry = {{"experiment", row.key.experiment},
                       {"scene", row.key.scene},
                       {"stand_in", sim::printable(row.stand_in, 4096)},
                       {"resolution", {row.width, row.height}},
                       {"setting", row.key.setting},
                       {"program", row.program},
                       {"reference", row.reference},
                       {"figure", row.key.metric}};
    entry["measured"] = row.measured ? sim::Json(*row.measured) : sim::Json(nullptr);
    if (!row.measured) entry["why_not"] = sim::printable(row.why_not, 4096);
    if (row.published && row.published->low == row.published->high) {
      entry["published"] = row.published->low;
    } else if (row.published) {
      entry["published"] = {row.published->low, row.published->high};
    } else {
      entry["published"] = nullptr;
    }
    out.push_back(std::move(entry));
  }
  return out;
}

}  // namespace

std::string results_text(const Results& results) {
  sim::Table table({"experiment", "scene", "setting", "figure", "measured", "published", "difference"});
  for (const Row& row : group_rows_by_experiment(results.rows)) {
    table.add_row({row.key.experiment, row.key.scene, row.key.setting, row.key.metric,
                   row.measured ? measured_text(row) : "-", published_text(row), difference_text(row)});
  }
  std::string out = heading_text(results) + "\n\n" + table.text();
  std::string before;
  for (const Row& row : results.rows) {
    const std::string line = fmt::format("{}, {}: {}\n", row.key.scene, row.key.setting, row.why_not);
    if (row.measured || line == before) continue;
    out += (before.empty() ? "\nnot measured\n" : "") + line;
    before = line;
  }
  if (!results.note.empty()) out += fmt::format("\n{}\n", results.note);
  return out;
}

namespace {

/// Returns a Markdown table with the frame program and the reference program of each setting of `rows`.
std::string programs_markdown(std::span<const Row> rows) {
  std::string out = "\n| setting | run | compared with |\n|---|---|---|\n";
  std::vector<std::string> listed;
  for (const Row& row : rows) {
    std::string line = fmt::format("| {} | `{}` | `{}` |\n", row.key.setting, row.program, row.reference);
    if (std::ranges::find(listed, line) != listed.end()) continue;
    out += line;
    listed.push_back(std::move(line));
  }
  return out;
}

/// Returns a Markdown table with the median and the range of each metric over the scenes.
std::string scenes_markdown(std::span<const Row> rows) {
  std::string out;
  std::vector<std::pair<std::string, std::string>> listed;
  for (const Row& row : rows) {
    const std::pair metric{row.key.setting, row.key.metric};
    if (std::ranges::find(listed, metric) != listed.end()) continue;
    listed.push_back(metric);
    std::vector<double> values;
    for (const Row& other : rows) {
      const bool same = other.key.setting == metric.first && other.key.metric == metric.second;
      if (same && other.measured) values.push_back(*other.measured);
    }
    if (values.size() < 2) continue;
    std::ranges::sort(values);
    const double median = (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
    const auto text = [&](double value) { return metric_text(find_metric(metric.second), value); };
    out += fmt::format("| {} | {} | {} | {} | {} to {} | {} |\n", metric.first, metric.second, values.size(),
                       text(median), text(values.front()), text(values.back()), published_text(row));
  }
  if (out.empty()) return out;
  return "\n| setting | figure | scenes | median | range | published |\n|---|---|---|---|---|---|\n" + out;
}

std::string experiment_markdown(std::span<const Row> rows) {
  std::string out = fmt::format("\n## {}\n", rows.front().key.experiment);
  out += programs_markdown(rows) + scenes_markdown(rows);
  out +=
      "\n| scene | stand-in | pixels | setting | figure | measured | published | difference |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    const std::string stand_in = std::filesystem::path(row.stand_in).filename().string();
    out += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.key.scene, stand_in, size_text(row),
                       row.key.setting, row.key.metric, measured_text(row), published_text(row), difference_text(row));
  }
  return out;
}

}  // namespace

std::string results_markdown(const Results& results, const std::vector<std::string>& pictures) {
  std::string out = fmt::format("# {}\n", heading_text(results));
  if (!results.note.empty()) out += fmt::format("\n{}\n", results.note);
  const std::vector<Row> rows = group_rows_by_experiment(results.rows);
  for (auto first = rows.begin(); first != rows.end();) {
    const auto last =
        std::find_if(first, rows.end(), [&](const Row& row) { return row.key.experiment != first->key.experiment; });
    out += experiment_markdown({first, last});
    first = last;
  }
  if (!pictures.empty()) out += "\n## Pictures\n";
  for (const std::string& picture : pictures) out += fmt::format("\n{}\n\n![{}]({})\n", picture, picture, picture);
  return out;
}

namespace {

using sim::Json;

constexpr std::uint64_t kMostResultBytes = 64 << 20;  ///< typical: 200 KB
constexpr std::uint64_t kMostOfScene = 8ULL << 30;

/// True if a partial earlier run has the same inputs as this run, with the header `head`, so that its rows are valid.
bool is_same_run(const Json& former, const Json& head) {
  for (const auto& [key, value] : head.items()) {
    if (key == "partial" || key == "provenance") continue;
    if (!former.contains(key) || former[key] != value) return false;
  }
  for (const auto& [key, value] : head.at("provenance").items()) {
    if (key != "argv" && former.at("provenance").at(key) != value) return false;
  }
  return former.at("partial").get<bool>();
}

Row row_of(const Json& entry) {
  const auto text = [&](const char* key) { return entry.at(key).get<std::string>(); };
  Row row{.key = {text("experiment"), text("scene"), text("setting"), text("figure")},
          .stand_in = text("stand_in"),
          .width = entry.at("resolution").at(0).get<std::uint32_t>(),
          .height = entry.at("resolution").at(1).get<std::uint32_t>(),
          .program = text("program"),
          .reference = text("reference"),
          .measured = {},
          .why_not = entry.value("why_not", ""),
          .published = {}};
  if (entry.at("measured").is_number()) row.measured = entry.at("measured").get<double>();
  return row;
}

/// Returns the SHA-256 of a scene file; empty for a built-in scene.
std::string digest_of_file(const fs::path& scene) {
  std::error_code unreadable;
  if (!fs::is_regular_file(scene, unreadable)) return {};
  return sim::sha256_hex(sim::read_file(scene, kMostOfScene));
}

EarlierResults parse_earlier_results(const Json& former, const Json& head) {
  EarlierResults out{.rows = former.at("rows").size(), .finished = {}};
  if (!is_same_run(former, head)) return out;
  const Json& digests = former.at("scenes");
  std::map<std::string, bool> unchanged;
  for (const Json& entry : former.at("rows")) {
    Row row = row_of(entry);
    const auto [at, is_new] = unchanged.try_emplace(row.stand_in, false);
    if (is_new) at->second = digests.value(row.stand_in, "") == digest_of_file(row.stand_in);
    if (at->second) out.finished.push_back(std::move(row));
  }
  return out;
}

/// Reads reproduce.json of an earlier run in the folder, if it exists. Its rows are reused if paper, sizes, program and
/// configuration equal those of `head`, the header of this run, and the scene file has not changed.
EarlierResults load_earlier_results(const fs::path& folder, const Json& head) {
  try {
    return parse_earlier_results(sim::parse_json(sim::read_file(folder / "reproduce.json", kMostResultBytes)), head);
  } catch (const sim::InputError&) {
  } catch (const sim::JsonError&) {
  }
  return {};
}

const Paper& find_paper(const std::string& name) {
  std::vector<std::string> known;
  for (const Paper& paper : all_papers()) {
    if (paper.name == name) return paper;
    known.emplace_back(paper.name);
  }
  throw sim::InputError(fmt::format("there is no paper '{}'{}; allowed: {}", sim::printable(name),
                                    traces::did_you_mean(name, known), fmt::join(known, ", ")));
}

sim::Json provenance_json(const Options& options, const RunConfig& config) {
  const BuildInfo build = build_info();
  return {{"version", build.version},   {"git", build.git},
          {"dirty", build.dirty},       {"compiler", build.compiler},
          {"flags", build.flags},       {"embree", traces::embree_version()},
          {"model_id", build.model_id}, {"config_hash", sim::config_hash(config)},
          {"argv", options.argv}};
}

/// Runs the experiments of a paper, collects result rows and writes the output files.
class Job {
 public:
  Job(const Options& options, const Paper& paper, const RunConfig& config)
      : options_(options),
        progress_(options.progress, false),
        runner_(options, &progress_),
        published_(load_published_values(options.paper)) {
    results_.paper = paper.name;
    results_.title = paper.title;
    results_.note = paper.note;
    results_.quick = options.quick;
    results_.shrink = options.shrink;
    provenance_ = provenance_json(options, config);
  }

  /// Sets the experiments to run. Loads rows of an interrupted run in `folder` for reuse.
  void begin_cases(std::vector<Case> cases, const fs::path& folder) {
    cases_ = std::move(cases);
    former_ = load_earlier_results(folder, header_json());
    if (former_.finished.empty()) return;
    progress_.print_line(fmt::format("raywatt: continues after {} finished rows", former_.finished.size()));
  }

  bool is_done() const { return next_ == cases_.size(); }

  /// Runs at least one experiment, and more until there are more result rows than in `folder`. Then replaces the
  /// results in `folder`, so that no earlier row is lost.
  void continue_cases(const fs::path& folder, const RunFolder::Open& open) {
    const bool some_are_kept = next_ != 0 || !former_.finished.empty();
    do {
      finish_next_case(open);
    } while (!is_done() && results_.rows.size() <= former_.rows);
    results_.partial = !is_done();
    if (some_are_kept) copy_pictures(folder, open());
    write_files(open());
  }

  void end_progress(bool has_failed) {
    progress_.finish(!has_failed ? "done" : is_interrupted() ? "interrupted" : "failed");
  }
  const Results& current_results() const { return results_; }

 private:
  void finish_next_case(const RunFolder::Open& open) {
    const Case& c = cases_[next_];
    const std::string label = fmt::format("{} of {}: {}, {}", next_ + 1, cases_.size(), c.view.scene, c.setting);
    if (!reuse_rows(c)) {
      if (options_.progress == "auto") progress_.print_line(label);
      progress_.expect_parts(1, label);
      measure_case(c, open);
    }
    next_ += 1;
  }

  /// Copies the rows of an experiment from an earlier run. Returns false if that run has not finished the experiment.
  bool reuse_rows(const Case& c) {
    std::vector<Row> rows;
    const std::string stand_in = stand_in_or_none(c.view);
    for (const PaperMetric& metric : c.metrics) {
      Row row = empty_row(c, metric, stand_in);
      const auto found = std::ranges::find_if(former_.finished, [&](const Row& other) {
        return other.key == row.key && other.stand_in == row.stand_in && other.width == row.width &&
               other.height == row.height && other.program == row.program && other.reference == row.reference;
      });
      if (found == former_.finished.end()) return false;
      row.measured = found->measured;
      row.why_not = found->why_not;
      rows.push_back(std::move(row));
    }
    record_scene_digest(stand_in);
    results_.rows.insert(results_.rows.end(), rows.begin(), rows.end());
    return true;
  }

  std::string stand_in_or_none(const View& view) const {
    try {
      return runner_.find_stand_in_scene(view);
    } catch (const sim::InputError&) {
      return {};
    }
  }

  void record_scene_digest(const std::string& stand_in) {
    if (!scenes_.contains(stand_in)) scenes_[stand_in] = digest_of_file(stand_in);
  }

  Row empty_row(const Case& c, const PaperMetric& metric, const std::string& stand_in) const {
    Row row{.key = {metric.experiment, c.view.scene, c.setting, metric.metric},
            .stand_in = stand_in,
            .width = c.width,
            .height = c.height,
            .program = c.run.program_text(),
            .reference = c.truth && metric.metric == "psnr_db" ? "256 samples" : c.reference.program_text(),
            .measured = {},
            .why_not = {},
            .published = {}};
    const auto found = published_.find(row.key);
    if (found != published_.end()) row.published = found->second;
    return row;
  }

  void measure_case(const Case& c, const RunFolder::Open& open) {
    std::vector<Measured> measured;
    const std::string stand_in = stand_in_or_none(c.view);
    try {
      record_scene_digest(stand_in);
      measured = runner_.measure_case(c);
      runner_.write_pictures(c, open());
    } catch (const sim::InputError& error) {
      measured.assign(c.metrics.size(), {{}, std::string("skipped: ") + error.what()});
    }
    for (std::size_t i = 0; i < measured.size(); ++i) {
      Row row = empty_row(c, c.metrics[i], stand_in);
      row.measured = measured[i].value;
      row.why_not = measured[i].why_not;
      results_.rows.push_back(std::move(row));
    }
  }

  /// Copies the pictures of reused experiments to the folder of the new results.
  static void copy_pictures(const fs::path& from, const fs::path& to) {
    for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
      const fs::path name = entry.path().filename();
      if (name.extension() != ".png" || !is_result_name(name.string())) continue;
      std::error_code failed;
      fs::copy_file(entry.path(), to / name, fs::copy_options::skip_existing, failed);
      if (failed) throw sim::IoError(fmt::format("{}: cannot be copied ({})", entry.path().string(), failed.message()));
    }
  }

  /// Returns the header of reproduce.json: all inputs that the result rows have in common.
  sim::Json header_json() const {
    return {{"schema", "raywatt-reproduce/1"}, {"paper", results_.paper},     {"quick", results_.quick},
            {"shrink", results_.shrink},       {"partial", results_.partial}, {"provenance", provenance_}};
  }

  void write_files(const fs::path& folder) const {
    sim::Json json = header_json();
    json.erase("provenance");
    json["rows"] = rows_json(results_);
    json["scenes"] = scenes_;
    json["provenance"] = provenance_;
    std::vector<std::string> pictures;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".png") pictures.push_back(entry.path().filename());
    }
    std::ranges::sort(pictures);
    sim::write_file_atomically(folder / "reproduce.json", sim::json_lines(json));
    sim::write_file_atomically(folder / "reproduce.md", results_markdown(results_, pictures));
  }

  const Options& options_;
  Progress progress_;
  Runner runner_;
  const PublishedValues published_;
  std::vector<Case> cases_;
  std::size_t next_ = 0;
  EarlierResults former_;
  Results results_;
  sim::Json scenes_ = sim::Json::object();  ///< SHA-256 of each scene file
  sim::Json provenance_;
};

/// Returns the experiments of a paper at the resolution that `options` requests.
std::vector<Case> cases_of(const Paper& paper, const Options& options) {
  std::vector<Case> cases = paper.cases(options.quick);
  for (Case& c : cases) {
    c.width = std::max(1U, c.width / options.shrink);
    c.height = std::max(1U, c.height / options.shrink);
  }
  return cases;
}

}  // namespace

void reproduce(const Options& options) {
  const Paper& paper = find_paper(options.paper);
  std::error_code ignored;
  if (!options.scenes.empty() && !fs::is_directory(options.scenes, ignored)) {
    throw sim::InputError(fmt::format("--scenes {}: is not a folder", sim::printable(options.scenes.string())));
  }
  RunFolder folder(options.out, options.force, {.mark = "reproduce.json"});
  JobOptions plain;
  plain.config = options.config;
  Job job(options, paper, load_run_config(plain));
  std::optional<HoldInterrupts> hold;  // set once results are written, so that an interrupt does not lose them
  std::exception_ptr failure;
  try {
    for (job.begin_cases(cases_of(paper, options), folder.target()); !job.is_done();) {
      folder.fill([&](const RunFolder::Open& open) {
        job.continue_cases(folder.target(), open);
        return fmt::format("{} rows", job.current_results().rows.size());
      });
      if (!hold) hold.emplace();
    }
  } catch (...) {
    failure = std::current_exception();
  }
  job.end_progress(failure != nullptr);
  const bool some_are_kept = hold.has_value();
  hold.reset();  // a pending interrupt ends the process here
  if (some_are_kept) {
    fmt::print("{}\nresults: {}\n", results_text(job.current_results()), (folder.target() / "reproduce.md").string());
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace tools::reproduce
