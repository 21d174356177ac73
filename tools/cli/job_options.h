#pragma once
#include <string>
#include <vector>

#include "tools/run/frame/job_options.h"
#include "tools/studies/sweep/launch/launcher.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tools {

/// Adds the options shared by all verbs that render. `positional`: the configuration is a positional argument.
void add_work_options(CLI::App& verb, JobOptions& options, bool positional = true);
/// Adds the option --rays. It excludes the options of a rendered run, so call this function after these options have
/// been added.
void add_rays_option(CLI::App& verb, JobOptions& options);
void add_timeline_option(CLI::App& verb, JobOptions& options);
void add_reference_option(CLI::App& verb, JobOptions& options);
/// Adds --fps, which sets the configuration key frame.fps.
void add_fps_option(CLI::App& verb, std::vector<std::string>& sets);
void add_ideal_option(CLI::App& verb, JobOptions& options);
/// Adds the options that control the output folder, messages and the progress display.
void add_output_options(CLI::App& verb, JobOptions& options);
void add_intervals_option(CLI::App& verb, JobOptions& options);
void add_frames_option(CLI::App& verb, JobOptions& options);
void add_config_options(CLI::App& verb, std::string& config, std::vector<std::string>& sets);
void add_set_option(CLI::App& verb, std::vector<std::string>& sets);

/// Prints a warning to stderr for each size, clock or voltage of a configuration that is outside the ranges of its
/// energy, area and latency tables.
void print_technology_table_warnings(const JobOptions& options);

/// Adds the options that choose how the points of a sweep or a search are launched.
void add_launcher_options(CLI::App& verb, LauncherOptions& options);

void add_progress_option(CLI::App& verb, std::string& progress);

/// Makes all options of all existing verbs reject empty values, which usually come from unset variables. --set has a
/// check of its own.
void refuse_empty_values(CLI::App& app);
/// Makes an option reject negative numbers. CLI11 would read them as large unsigned numbers.
void refuse_negative(CLI::Option& option);
/// Makes an option reject values that are not finite numbers above 0.
void require_positive(CLI::Option& option);

}  // namespace tools
