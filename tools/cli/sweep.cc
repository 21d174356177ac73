#include "tools/studies/sweep/sweep.h"

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "sim/error.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/paths.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/results/best.h"
#include "tools/studies/sweep/results/collect.h"
#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/results/sensitivity.h"
#include "tools/studies/sweep/store/store.h"

namespace tools {
namespace {

namespace fs = std::filesystem;

void add_sweep_run(CLI::App& group, int& exit) {
  CLI::App* verb = group.add_subcommand("run", "Compute all points of a sweep that are not stored yet");
  const auto options = std::make_shared<SweepOptions>();
  verb->add_option("file", options->file,
                   "the sweep: an experiment's name such as trv-cores, or a .yaml file (docs/sweeps.md)");
  verb->add_option("-o,--output", options->out, "folder of the sweep (default: raywatt-out/sweep-NAME)");
  verb->add_option("--store", options->store,
                   "folder of results, shared by all sweeps (default: $RAYWATT_STORE, else raywatt-out/store)");
  add_launcher_options(*verb, *options);
  verb->add_flag("--wait", options->wait, "slurm: wait until all points have ended");
  CLI::Option* const resume =
      verb->add_flag("--resume", options->resume, "continue the sweep in the folder; FILE is optional then");
  add_fps_option(*verb, options->sets);
  resume->excludes(verb->get_option("--fps"));
  verb->add_flag("--dry-run", options->dry_run, "list the points; compute nothing, write nothing");
  verb->add_flag("--quiet", options->quiet, "print no summary and no progress bar");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "The same command continues an interrupted sweep. Exit code 1, and a list, if points failed.\n\n"
      "Example: raywatt sweep run trv-cores -o out/trv-cores -j 4");
  verb->callback([options, &exit] {
    if (!options->file.empty()) options->file = find_experiment(options->file);
    exit = run_sweep(*options);
  });
}

void add_sweep_point(CLI::App& group, int& exit) {
  CLI::App* verb = group.add_subcommand("point", "Compute some points of a sweep; launchers run it on cluster nodes");
  const auto options = std::make_shared<PointOptions>();
  verb->add_option("folder", options->folder, "the sweep's folder")->required();
  verb->add_option("--list", options->list,
                   "a file of point ids, one or more per line (default: all points of the sweep)");
  refuse_negative(*verb->add_option("--index", options->index, "index of a chunk of its lines, from 0")->required());
  verb->add_option("-j,--jobs", options->jobs, "points computed concurrently")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  verb->add_option("--chunk", options->chunk, "lines per chunk")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  verb->add_flag("--retry-failed", options->retry_failed, "compute failed points again");
  verb->footer(
      "Exit code 0 if the results are stored already, 1 if a point fails.\n\n"
      "Example: raywatt sweep point out/l1 --list out/l1/submit-1.txt --index 7 --chunk 4");
  verb->callback([options, &exit] { exit = compute_points(*options); });
}

void add_sweep_status(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("status", "Print the progress of a sweep");
  const auto path = std::make_shared<fs::path>();
  const auto json = std::make_shared<bool>(false);
  verb->add_option("folder", *path, "the sweep's folder")->required();
  verb->add_flag("--json", *json, "print JSON");
  verb->footer("Example: raywatt sweep status out/l1");
  verb->callback([=] { print_sweep_status(*path, *json); });
}

void add_sweep_watch(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("watch", "Show the progress of a sweep until its points have ended");
  const auto path = std::make_shared<fs::path>();
  verb->add_option("folder", *path, "the sweep's folder")->required();
  verb->footer(
      "Reads only the folder and its store, once per second. Prints a line every two seconds if standard output is\n"
      "not a terminal.\n\nExample: raywatt sweep watch out/l1");
  verb->callback([=] { watch_sweep(*path); });
}

void add_sweep_cancel(CLI::App& group) {
  CLI::App* verb =
      group.add_subcommand("cancel", "Stop the process that runs a sweep, and its jobs; finished points are kept");
  const auto path = std::make_shared<fs::path>();
  verb->add_option("folder", *path, "the sweep's folder")->required();
  verb->footer("Example: raywatt sweep cancel out/l1");
  verb->callback([=] { cancel_sweep(*path); });
}

/// Returns the width of the terminal in columns; 80 if it is unknown.
std::size_t terminal_width() {
  winsize size{};
  return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col != 0 ? size.ws_col : 80;
}

/// Collects the results of a sweep and prints the text that `write` returns for them.
template <class Write>
void print_results(const fs::path& sweep, Write&& write, bool csv = false) {
  results::collect_if_writable(sweep, "the results below are those last collected");
  const results::Results read(sweep);
  fmt::print("{}", csv ? write(read) : to_terminal_encoding(write(read)));
}

/// Adds a verb that reads the results of the sweep in `folder`.
CLI::App* add_query(CLI::App& group, const char* name, const char* description, fs::path& folder) {
  CLI::App* verb = group.add_subcommand(name, description);
  verb->add_option("sweep", folder, "folder of the sweep")->required()->type_name("DIR");
  return verb;
}

void add_where_option(CLI::App& verb, std::vector<std::string>& where) {
  verb.add_option("--where", where,
                  "only points that meet this condition, e.g. 'power_w.nominal<1 and cores>=2' (repeatable); over "
                  "several workloads a machine must meet it on each")
      ->allow_extra_args(false)
      ->type_name("EXPR");
}

/// Adds the option --energy. Its value "band" sets `band`: the verb also evaluates random draws of the energy tables.
void add_energy_option(CLI::App& verb, bool& band) {
  verb.add_option_function<std::string>(
          "--energy", [&band](const std::string& word) { band = word == "band"; },
          "nominal: use nominal energies; band: also evaluate 2000 random energy tables (docs/energy.md)")
      ->check(CLI::IsMember({"nominal", "band"}))
      ->default_str("nominal");
}

void add_collect(CLI::App& group) {
  const auto folder = std::make_shared<fs::path>();
  CLI::App* verb =
      add_query(group, "collect", "Collect results into index.sqlite, results.csv and machines.csv", *folder);
  verb->footer("Example: raywatt sweep collect out/l1");
  verb->callback([folder] {
    const sweep::SweepFolder opened = sweep::SweepFolder::open(*folder);
    join_sweep(opened);
    const results::Collected collected = results::collect_results(opened);
    const fs::path machines = *folder / "machines.csv";
    fmt::print("{}{}\ntable: {}\n{}index: {}\n", summary_text(collected), collected.unchanged ? ", as before" : "",
               (*folder / "results.csv").string(),
               fs::exists(machines) ? fmt::format("machines: {}\n", machines.string()) : "",
               (*folder / "index.sqlite").string());
  });
}

/// Joins the parts of column names that were split at a comma inside brackets, as in on(chess, fps).
std::vector<std::string> join_calls(const std::vector<std::string>& parts) {
  std::vector<std::string> joined;
  bool is_open = false;
  for (const std::string& part : parts) {
    if (is_open) {
      joined.back() += "," + part;
    } else {
      joined.push_back(part);
    }
    is_open = joined.back().find('(') != std::string::npos && joined.back().find(')') == std::string::npos;
  }
  return joined;
}

void add_table(CLI::App& group) {
  struct Options : results::TableOptions {
    fs::path folder;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* verb = add_query(group, "table", "Print the points with their axes and metrics", o->folder);
  verb->add_option("--columns", o->columns,
                   "columns to print: n, id, status, error, axes, report paths or unique ends of paths, worst(PATH),\n"
                   "mean(PATH), geomean(PATH), on(WORKLOAD, PATH)")
      ->delimiter(',')
      ->type_name("A,B,...");
  verb->add_flag("--machines", o->machines, "one row per machine: its metrics over the list of workloads");
  verb->add_option("--sort", o->sort, "column to sort by; largest first with :desc")->type_name("COLUMN[:desc]");
  add_where_option(*verb, o->where);
  refuse_negative(*verb->add_option("--limit", o->limit, "maximum number of rows")->type_name("N"));
  verb->add_flag("--csv", o->csv, "print CSV, with all digits");
  verb->footer("Example: raywatt sweep table out/l1 --columns n,tni.trv.l1.size,cycles,power_w.nominal --sort cycles");
  verb->callback([o] {
    o->columns = join_calls(o->columns);
    print_results(
        o->folder, [&](const auto& r) { return results_table(r, *o); }, o->csv);
  });
}

void add_pareto(CLI::App& group) {
  struct Options : results::ParetoOptions {
    fs::path folder;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* verb = add_query(group, "pareto", "Print the Pareto front of two metrics", o->folder);
  verb->add_option("--x", o->x,
                   "a metric, or a function over workloads as of best; the prefix max: or min: gives its direction")
      ->required()
      ->type_name("[max:|min:]PATH");
  verb->add_option("--y", o->y, "the other metric")->required()->type_name("[max:|min:]PATH");
  add_where_option(*verb, o->where);
  verb->add_flag("--csv", o->csv, "print the front as CSV");
  add_energy_option(*verb, o->band);
  verb->footer(
      "Without a prefix, performance, utilisation and PSNR are maximised and all other metrics minimised.\n\n"
      "Example: raywatt sweep pareto out/l1 --x power_w.nominal --y fps");
  verb->callback([o] {
    print_results(
        o->folder, [&](const auto& r) { return pareto_text(r, *o, terminal_width()); }, o->csv);
  });
}

void add_sensitivity(CLI::App& group) {
  struct Options {
    fs::path folder;
    std::vector<std::string> metrics, where;
    bool band = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* verb = add_query(group, "sensitivity", "Print the effect of each axis on each metric", o->folder);
  verb->add_option(
          "--metric", o->metrics,
          "metric: a report path, a unique end of one, or a function over workloads such as worst(fps) (repeatable)")
      ->allow_extra_args(false)
      ->type_name("PATH");
  add_where_option(*verb, o->where);
  add_energy_option(*verb, o->band);
  verb->footer("Example: raywatt sweep sensitivity out/l1 --metric cycles --metric dram_bytes");
  verb->callback([o] {
    print_results(o->folder, [&](const auto& r) { return sensitivity_text(r, o->metrics, o->where, o->band); });
  });
}

void add_best(CLI::App& group) {
  struct Options {
    fs::path folder;
    std::string most, least;
    std::vector<std::string> where;
    bool band = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* verb = add_query(group, "best", "Print the best point or machine by one metric", o->folder);
  CLI::Option* most =
      verb->add_option(
              "--max", o->most,
              "metric to maximise; over several workloads worst(PATH), mean(PATH), geomean(PATH) or on(NAME, PATH)")
          ->type_name("PATH");
  verb->add_option("--min", o->least, "metric to minimise")->type_name("PATH")->excludes(most);
  add_where_option(*verb, o->where);
  add_energy_option(*verb, o->band);
  verb->footer("Example: raywatt sweep best out/l1 --max frames_per_joule_gpu --where 'power_w.nominal<1'");
  verb->callback([o] {
    if (o->most.empty() == o->least.empty()) throw sim::InputError("sweep best needs --max PATH or --min PATH");
    print_results(o->folder, [&](const auto& r) {
      const std::vector<sweep::Point> points = sweep::SweepFolder::open(o->folder).read_points();
      return best_text(r, points, {o->most.empty() ? o->least : o->most, !o->most.empty(), o->where, o->band});
    });
  });
}

}  // namespace

void add_sweep_command(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand(
      "sweep", "Simulate the points of a design space and evaluate the results; stored results are reused");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt sweep run trv-cores -o out/trv-cores");
  add_sweep_run(*verb, exit);
  add_sweep_point(*verb, exit);
  add_sweep_status(*verb);
  add_sweep_watch(*verb);
  add_sweep_cancel(*verb);
  add_collect(*verb);
  add_table(*verb);
  add_pareto(*verb);
  add_sensitivity(*verb);
  add_best(*verb);
}

}  // namespace tools
