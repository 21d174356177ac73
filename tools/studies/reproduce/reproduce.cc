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
#include "tools/studies/reproduce/former.h"
#include "tools/studies/reproduce/results.h"
#include "traces/accel/embree_tracer.h"
#include "traces/scene/did_you_mean.h"

namespace tools::reproduce {

namespace fs = std::filesystem;

namespace {

const Paper& find_paper(const std::string& name) {
  std::vector<std::string> known;
  for (const Paper& paper : papers()) {
    if (paper.name == name) return paper;
    known.emplace_back(paper.name);
  }
  throw sim::InputError(fmt::format("no paper is called '{}'{}; there are: {}", sim::printable(name),
                                    traces::did_you_mean(name, known), fmt::join(known, ", ")));
}

sim::Json provenance(const Options& options, const RunConfig& config) {
  const BuildInfo build = build_info();
  return {{"version", build.version},   {"git", build.git},
          {"dirty", build.dirty},       {"compiler", build.compiler},
          {"flags", build.flags},       {"embree", traces::embree_version()},
          {"model_id", build.model_id}, {"config_hash", sim::config_hash(config)},
          {"argv", options.argv}};
}

/// A job under way: its rows so far, and the files that show them.
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
    provenance_ = provenance(options, config);
  }

  /// Sets out to measure the cases, but those that a stopped run has left in `folder`.
  void begin(std::vector<Case> cases, const fs::path& folder) {
    cases_ = std::move(cases);
    former_ = load_former(folder, head());
    if (former_.finished.empty()) return;
    progress_.print_line(fmt::format("raywatt: goes on behind {} rows that are finished", former_.finished.size()));
  }

  bool is_done() const { return next_ == cases_.size(); }

  /// Measures cases until there are more rows than in `folder`, where less never replaces more; then writes all.
  void go_on(const fs::path& folder, const RunFolder::Open& open) {
    const bool some_are_kept = next_ != 0 || !former_.finished.empty();
    do {
      take_next(open);
    } while (!is_done() && results_.rows.size() <= former_.rows);
    results_.partial = !is_done();
    if (some_are_kept) keep_pictures(folder, open());
    write(open());
  }

  void end(bool has_failed) { progress_.finish(!has_failed ? "done" : is_interrupted() ? "interrupted" : "failed"); }
  const Results& results() const { return results_; }

 private:
  void take_next(const RunFolder::Open& open) {
    const Case& c = cases_[next_];
    const std::string label = fmt::format("{} of {}: {}, {}", next_ + 1, cases_.size(), c.view.scene, c.setting);
    if (!take_over(c)) {
      if (options_.progress == "auto") progress_.print_line(label);
      progress_.expect_parts(1, label);
      measure(c, open);
    }
    next_ += 1;
  }

  /// Takes the rows of a case that a former run has finished.
  bool take_over(const Case& c) {
    std::vector<Row> rows;
    const std::string stand_in = stand_in_or_none(c.view);
    for (const Figure& figure : c.figures) {
      Row row = empty_row(c, figure, stand_in);
      const auto found = std::ranges::find_if(former_.finished, [&](const Row& other) {
        return other.figure == row.figure && other.stand_in == row.stand_in && other.width == row.width &&
               other.height == row.height && other.program == row.program && other.reference == row.reference;
      });
      if (found == former_.finished.end()) return false;
      row.measured = found->measured;
      row.why_not = found->why_not;
      rows.push_back(std::move(row));
    }
    note_scene(stand_in);
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

  void note_scene(const std::string& stand_in) {
    if (!scenes_.contains(stand_in)) scenes_[stand_in] = digest_of_file(stand_in);
  }

  Row empty_row(const Case& c, const Figure& figure, const std::string& stand_in) const {
    Row row{.figure = {figure.experiment, c.view.scene, c.setting, figure.metric},
            .stand_in = stand_in,
            .width = c.width,
            .height = c.height,
            .program = c.run.text(),
            .reference = c.truth && figure.metric == "psnr_db" ? "256 samples" : c.reference.text(),
            .measured = {},
            .why_not = {},
            .published = {}};
    const auto found = published_.find(row.figure);
    if (found != published_.end()) row.published = found->second;
    return row;
  }

  void measure(const Case& c, const RunFolder::Open& open) {
    std::vector<Measured> figures;
    const std::string stand_in = stand_in_or_none(c.view);
    try {
      note_scene(stand_in);
      figures = runner_.measure(c);
      runner_.write_pictures(c, open());
    } catch (const sim::InputError& error) {
      figures.assign(c.figures.size(), {{}, std::string("skipped: ") + error.what()});
    }
    for (std::size_t i = 0; i < figures.size(); ++i) {
      Row row = empty_row(c, c.figures[i], stand_in);
      row.measured = figures[i].value;
      row.why_not = figures[i].why_not;
      results_.rows.push_back(std::move(row));
    }
  }

  /// Brings the pictures of cases that were finished before.
  static void keep_pictures(const fs::path& from, const fs::path& to) {
    for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
      const fs::path name = entry.path().filename();
      if (name.extension() != ".png" || !is_result_name(name.string())) continue;
      std::error_code failed;
      fs::copy_file(entry.path(), to / name, fs::copy_options::skip_existing, failed);
      if (failed) throw sim::IoError(fmt::format("{}: cannot be copied ({})", entry.path().string(), failed.message()));
    }
  }

  /// Members before the rows: all that these depend on beside their cases.
  sim::Json head() const {
    return {{"schema", "raywatt-reproduce/1"}, {"paper", results_.paper},     {"quick", results_.quick},
            {"shrink", results_.shrink},       {"partial", results_.partial}, {"provenance", provenance_}};
  }

  void write(const fs::path& folder) const {
    sim::Json json = head();
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
  sim::Json scenes_ = sim::Json::object();  ///< digests of the files that stand in
  sim::Json provenance_;
};

/// The paper's experiments at the size that is asked for.
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
    throw sim::InputError(fmt::format("--scenes {}: is no folder", sim::printable(options.scenes.string())));
  }
  RunFolder folder(options.out, options.force, {.mark = "reproduce.json"});
  JobOptions plain;
  plain.config = options.config;
  Job job(options, paper, load_run_config(plain));
  std::optional<HoldInterrupts> hold;  // once something is kept that an interrupt can tell of
  std::exception_ptr failure;
  try {
    for (job.begin(cases_of(paper, options), folder.target()); !job.is_done();) {
      folder.fill([&](const RunFolder::Open& open) {
        job.go_on(folder.target(), open);
        return fmt::format("{} rows", job.results().rows.size());
      });
      if (!hold) hold.emplace();
    }
  } catch (...) {
    failure = std::current_exception();
  }
  job.end(failure != nullptr);
  const bool some_are_kept = hold.has_value();
  hold.reset();  // an interrupt ends here
  if (some_are_kept) {
    fmt::print("{}\nresults: {}\n", results_text(job.results()), (folder.target() / "reproduce.md").string());
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace tools::reproduce
