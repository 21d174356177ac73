#include "tools/studies/energy/energy.h"

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/io/json.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/progress.h"
#include "tools/studies/dvfs/dvfs.h"
#include "tools/studies/sustain/sustain.h"

namespace tools {
namespace {

void add_price(CLI::App& group) {
  struct PriceOptions {
    std::vector<std::filesystem::path> paths;
    PriceTable table;
    bool csv = false, json = false;
  };
  const auto o = std::make_shared<PriceOptions>();
  CLI::App* verb = group.add_subcommand(
      "price", "Recalculate the energy of finished runs and sweeps with another table, without simulation");
  verb->add_option("runs", o->paths, "folders of runs or of sweeps, or report.json files")->required();
  verb->add_option("--energy", o->table.energy, "energy table, e.g. energy/14nm or a file")->type_name("FILE");
  verb->add_option("--set", o->table.sets,
                   "set a key that only affects energy; a single number sets low, nominal and high (repeatable)")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  CLI::Option* csv = verb->add_flag("--csv", o->csv, "print CSV, one line per run, with all digits");
  verb->add_flag("--json", o->json, "print JSON, with all results that depend on energy")->excludes(csv);
  verb->footer(
      "Example: raywatt energy price raywatt-out/base out/l1 --set energy.events.tni.box_test=48\n"
      "Exit code 0, or 2 if a run cannot be priced.");
  verb->callback([o] {
    const PriceFormat format = o->csv ? PriceFormat::kCsv : o->json ? PriceFormat::kJson : PriceFormat::kText;
    fmt::print("{}", price_text(o->paths, o->table, format));
  });
}

void add_show(CLI::App& group) {
  struct ShowOptions {
    JobOptions job;
    std::string name;
  };
  const auto o = std::make_shared<ShowOptions>();
  CLI::App* verb = group.add_subcommand(
      "show", "Show energy tables: bands, curves over size, sources, and the counters that use each entry");
  verb->add_option(
      "event", o->name,
      "an entry, a unique end of its name, or a group, e.g. tni.box_test, cache, clock_share; default: all");
  verb->add_option("--config", o->job.config, "configuration: file or name")->type_name("CONFIG");
  add_set_option(*verb, o->job.sets);
  verb->footer("Example: raywatt energy show cache.l1_read\nExit code 0, or 2 if there is no such entry.");
  verb->callback([o] {
    fmt::print("{}", describe_energy_entries(o->job, o->name));
    print_technology_table_warnings(o->job);
  });
}

}  // namespace

void add_energy_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("energy", "Show energy tables, and recalculate the energy of finished runs");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt energy show tni.box_test");
  add_price(*verb);
  add_show(*verb);
}

void add_dvfs_command(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("dvfs", "Simulate frame rate and power at several clocks, each at the voltage that it needs");
  const auto options = std::make_shared<DvfsOptions>();
  const auto json = std::make_shared<bool>(false);
  add_work_options(*verb, options->job);
  verb->add_option("--factors", options->factors, "clock frequencies relative to the configured ones")
      ->delimiter(',')
      ->check(CLI::Range(0.01, 20.0))
      ->capture_default_str()
      ->type_name("LIST");
  verb->add_option("--clocks", options->domains, "clock domains to scale; the others stay as configured")
      ->delimiter(',')
      ->capture_default_str()
      ->type_name("LIST");
  require_positive(*verb->add_option("--fps", options->fps, "target frame rate (default: that of the slowest point)")
                        ->type_name("NUMBER"));
  verb->add_flag("--json", *json, "print JSON");
  add_progress_option(*verb, options->job.progress);
  verb->footer("Example: raywatt dvfs sgrt-balanced --scene chess --resolution 512x256 --fps 60");
  verb->callback([=] {
    Progress progress(options->job.progress, options->job.quiet);
    const DvfsCurve curve = dvfs_curve(*options, &progress);
    progress.finish("done");
    fmt::print("{}", *json ? sim::json_lines(dvfs_json(curve)) : dvfs_text(curve));
  });
}

void add_sustain_command(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("sustain", "Calculate frame rate and temperature over minutes with a thermal governor");
  const auto options = std::make_shared<SustainOptions>();
  const auto json = std::make_shared<bool>(false);
  add_work_options(*verb, options->job);
  add_frames_option(*verb, options->job);
  require_positive(
      *verb->add_option("--minutes", options->minutes, "simulated time (default: thermal.minutes, or 10 if that is 0)")
           ->type_name("NUMBER"));
  require_positive(*verb->add_option("--loop", options->loop, "seconds over which frame rates are averaged")
                        ->capture_default_str()
                        ->type_name("NUMBER"));
  require_positive(*verb->add_option("--fps", options->fps,
                                     "highest frame rate (default: each frame begins when the previous one ends)")
                        ->type_name("NUMBER"));
  verb->add_flag("--json", *json, "print JSON");
  add_progress_option(*verb, options->job.progress);
  verb->footer("Example: raywatt sustain sgrt-2016 --scene chess --resolution 512x256 --set thermal.body_limit=40");
  verb->callback([=] {
    Progress progress(options->job.progress, options->job.quiet);
    const SustainStudy study = sustain_study(*options, &progress);
    progress.finish("done");
    fmt::print("{}", *json ? sim::json_lines(sustain_json(study)) : sustain_text(study));
  });
}

}  // namespace tools
