#include "tools/studies/reproduce/reproduce.h"

#include <algorithm>
#include <exception>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/file.h"
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
  for (const Paper& paper : papers()) {
    if (paper.name == name) return paper;
    known.emplace_back(paper.name);
  }
  throw sim::InputError(fmt::format("no paper is called '{}'{}; there are: {}", sim::printable(name),
                                    traces::did_you_mean(name, known), fmt::join(known, ", ")));
}

nlohmann::ordered_json provenance(const Options& options, const RunConfig& config) {
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
    provenance_ = provenance(options, config);
  }

  void run(const std::vector<Case>& cases, const RunFolder::Open& open) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const Case& c = cases[i];
      const std::string label = fmt::format("{} of {}: {}, {}", i + 1, cases.size(), c.view.scene, c.setting);
      if (options_.progress == "auto") progress_.say(label);
      progress_.expect(1, label);
      measure(c, open);
      write(open());
    }
    progress_.end("done");
  }

  void end_early(const fs::path& folder) {
    progress_.end(interrupted() ? "interrupted" : "failed");
    results_.partial = true;
    write(folder);
  }
  const Results& results() const { return results_; }

 private:
  void measure(const Case& c, const RunFolder::Open& open) {
    std::vector<Measured> figures;
    std::string stand_in;
    try {
      stand_in = runner_.stand_in(c.view);
      figures = runner_.measure(c);
      runner_.write_pictures(c, open());
    } catch (const sim::InputError& error) {
      figures.assign(c.figures.size(), {{}, std::string("skipped: ") + error.what()});
    }
    for (std::size_t i = 0; i < figures.size(); ++i) {
      Row row{.figure = {c.figures[i].experiment, c.view.scene, c.setting, c.figures[i].metric},
              .stand_in = stand_in,
              .width = c.width,
              .height = c.height,
              .program = c.run.text(),
              .reference = c.truth && c.figures[i].metric == "psnr_db" ? "256 samples" : c.reference.text(),
              .measured = figures[i].value,
              .why_not = figures[i].why_not,
              .published = {}};
      const auto found = published_.find(row.figure);
      if (found != published_.end()) row.published = found->second;
      results_.rows.push_back(std::move(row));
    }
  }

  void write(const fs::path& folder) const {
    nlohmann::ordered_json json = {{"schema", "raywatt-reproduce/1"}, {"paper", results_.paper},
                                   {"quick", results_.quick},         {"partial", results_.partial},
                                   {"rows", rows_json(results_)},     {"provenance", provenance_}};
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
  Results results_;
  nlohmann::ordered_json provenance_;
};

}  // namespace

void reproduce(const Options& options) {
  const Paper& paper = find_paper(options.paper);
  if (!options.scenes.empty() && !fs::is_directory(options.scenes)) {
    throw sim::InputError(fmt::format("--scenes {}: is no folder", sim::printable(options.scenes.string())));
  }
  RunFolder folder(options.out, options.force, {.mark = "reproduce.json"});
  JobOptions plain;
  plain.config = options.config;
  Job job(options, paper, load_run_config(plain));
  std::exception_ptr failure;
  folder.fill([&](const RunFolder::Open& open) {
    try {
      job.run(paper.cases(options.quick), open);
    } catch (...) {
      if (job.results().rows.empty()) throw;
      failure = std::current_exception();
      job.end_early(open());
    }
    return fmt::format("{} rows", job.results().rows.size());
  });
  fmt::print("{}\nresults: {}\n", results_text(job.results()), (folder.target() / "reproduce.md").string());
  if (failure) std::rethrow_exception(failure);
}

}  // namespace tools::reproduce
