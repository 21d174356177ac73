#include "tools/studies/reproduce/reproduce.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "tools/host/build_info.h"
#include "tools/host/interrupt.h"
#include "tools/host/run_folder.h"
#include "tools/studies/reproduce/results.h"
#include "traces/accel/embree_tracer.h"
#include "traces/scene/did_you_mean.h"

namespace tools::reproduce {

namespace fs = std::filesystem;

namespace {

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

/// Runs the cases of a paper and writes rows and files.
class Job {
 public:
  Job(const Options& options, const Paper& paper, const RunConfig& config)
      : options_(options),
        progress_(options.progress, false),
        runner_(options, &progress_),
        published_(load_published(options.paper)) {
    results_.paper = paper.name;
    results_.title = paper.title;
    results_.note = paper.note;
    results_.quick = options.quick;
    results_.shrink = options.shrink;
    provenance_ = provenance_json(options, config);
  }

  /// Sets the cases to measure. Rows of a stopped run in `folder` are reused.
  void begin_cases(std::vector<Case> cases, const fs::path& folder) {
    cases_ = std::move(cases);
    former_ = load_former(folder, header_json());
    if (former_.finished.empty()) return;
    progress_.print_line(fmt::format("raywatt: continues after {} finished rows", former_.finished.size()));
  }

  bool is_done() const { return next_ == cases_.size(); }

  /// Measures cases until there are more rows than in `folder`, then writes all files.
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

  /// Reuses the rows of a case that an earlier run has finished. Returns false if there are none.
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
      return runner_.stand_in(view);
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

  /// Copies the pictures of reused cases.
  static void copy_pictures(const fs::path& from, const fs::path& to) {
    for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
      const fs::path name = entry.path().filename();
      if (name.extension() != ".png" || !is_result_name(name.string())) continue;
      std::error_code failed;
      fs::copy_file(entry.path(), to / name, fs::copy_options::skip_existing, failed);
      if (failed) throw sim::IoError(fmt::format("{}: cannot be copied ({})", entry.path().string(), failed.message()));
    }
  }

  /// Returns the members before the rows: everything that rows depend on, except their cases.
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
    sim::write_file_atomically(folder / "reproduce.json", sim::json_text(json));
    sim::write_file_atomically(folder / "reproduce.md", results_markdown(results_, pictures));
  }

  const Options& options_;
  Progress progress_;
  Runner runner_;
  const Published published_;
  std::vector<Case> cases_;
  std::size_t next_ = 0;
  Former former_;
  Results results_;
  sim::Json scenes_ = sim::Json::object();  ///< SHA-256 by scene
  sim::Json provenance_;
};

/// Returns the cases of a paper at the requested size.
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
  std::optional<HoldInterrupts> hold;  // set after the first results are written
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
  hold.reset();  // an interrupt ends the process here
  if (some_are_kept) {
    fmt::print("{}\nresults: {}\n", results_text(job.current_results()), (folder.target() / "reproduce.md").string());
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace tools::reproduce
