#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tools {

/// Folders in which a bare name is looked up: those of $RAYWATT_PATH (separated by colons), the share folder beside the
/// program, and for a program in its build folder the sources that it was built from.
std::vector<std::filesystem::path> search_folders();

/// The same folders, each followed by its `configs`: where configurations are.
std::vector<std::filesystem::path> config_folders();

/// The configuration file called `argument`: a path if it holds a '/' or ends in .yaml, else NAME.yaml in one of
/// config_folders(). InputError with the nearest name if there is none, or with --scene if a scene is called so.
std::filesystem::path find_config(const std::string& argument);

/// The workload file that --scene means: `argument` itself if it ends in .yaml, else NAME.yaml in the folder
/// traces/workloads or workloads below one of search_folders(); nothing if it is a scene.
std::optional<std::filesystem::path> find_workload(const std::string& argument);

/// Names of the workloads that find_workload() knows, sorted.
std::vector<std::string> workload_names();

/// The sweep or search that `argument` names: a path if it holds a '/', ends in .yaml or is there, else
/// experiments/NAME.yaml in one of config_folders(). InputError with the nearest name if there is none.
std::filesystem::path find_experiment(const std::filesystem::path& argument);

/// Files NAME.yaml below one of config_folders(), as `folder`/NAME, sorted: those of "dram", "energy", "experiments".
std::vector<std::string> config_names_in(const std::string& folder);

/// The file of a name of config_names() or config_names_in(), which must be one.
std::filesystem::path find_config_file(const std::string& name);

/// Names of the configurations that find_config() knows, sorted.
std::vector<std::string> config_names();

}  // namespace tools
