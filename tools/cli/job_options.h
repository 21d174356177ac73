#pragma once
#include <string>
#include <vector>

#include "tools/run/frame/job_options.h"
#include "tools/studies/sweep/launch/launcher_options.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tools {

/// Adds to a verb of the command line what says what is rendered, and on what.
/// `positional`: the configuration is an argument of its own.
void add_work_options(CLI::App& verb, JobOptions& options, bool positional = true);
/// Adds a list of rays, which takes the place of what says what is rendered; call it last.
void add_rays_option(CLI::App& verb, JobOptions& options);
/// Adds the program that others are compared with.
/// --timeline
void add_timeline_option(CLI::App& verb, JobOptions& options);
void add_reference_option(CLI::App& verb, JobOptions& options);
/// Adds ideal resources.
void add_ideal_option(CLI::App& verb, JobOptions& options);
/// Adds what becomes of the results.
void add_output_options(CLI::App& verb, JobOptions& options);
/// Adds whether intervals are kept.
void add_intervals_option(CLI::App& verb, JobOptions& options);
/// Adds frames of an animation.
void add_frames_option(CLI::App& verb, JobOptions& options);
/// These, frames, and what becomes of the results.
void add_job_options(CLI::App& verb, JobOptions& options);
void add_config_options(CLI::App& verb, std::string& config, std::vector<std::string>& sets);
void add_set_option(CLI::App& verb, std::vector<std::string>& sets);

/// Adds who computes points, and how many at a time.
void add_launcher_options(CLI::App& verb, LauncherOptions& options);

/// Adds the form of the progress that goes to standard error.
void add_progress_option(CLI::App& verb, std::string& progress);

/// Has the options of all verbs that are there refuse an empty value: as a rule, that of a variable that is not set.
/// --set says itself what it takes.
void refuse_empty_values(CLI::App& app);
/// Refuses a negative number, which CLI11 takes for a huge one.
void refuse_negative(CLI::Option& option);
/// Refuses values that are no finite number above 0.
void require_positive(CLI::Option& option);

}  // namespace tools
