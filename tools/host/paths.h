#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tools {

/// Returns the folders in which names are looked up: $RAYWATT_PATH (separated by colons), the share folder next to the
/// program, and the source folder for a program in its build folder.
std::vector<std::filesystem::path> search_folders();

/// Returns the folders in which configurations are looked up: each search folder, followed by its subfolder `configs`.
std::vector<std::filesystem::path> config_folders();

/// Returns the path of a configuration file: `argument` if it contains '/' or ends in .yaml, else NAME.yaml in
/// config_folders(). If there is none, InputError suggests the nearest name, or --scene for the name of a scene.
std::filesystem::path find_config(const std::string& argument);

/// Returns the workload file for --scene: `argument` if it ends in .yaml, else NAME.yaml in traces/workloads or
/// workloads of search_folders(); nullopt for a scene.
std::optional<std::filesystem::path> find_workload(const std::string& argument);

/// Returns the names of all workloads, sorted.
std::vector<std::string> workload_names();

/// Returns the file of a sweep or search: `argument` itself if it contains '/', ends in .yaml or exists, else
/// `folder`/NAME.yaml in config_folders(). Throws InputError with the nearest name if there is none.
std::filesystem::path find_experiment(const std::filesystem::path& argument, const std::string& folder = "experiments");

/// Returns the names `folder`/NAME of the files NAME.yaml in a subfolder of config_folders(), sorted. `folder`: e.g.
/// "dram", "worth" or "experiments".
std::vector<std::string> config_names_in(const std::string& folder);

/// Returns the file of a configuration whose name config_names() or config_names_in() returned.
std::filesystem::path find_config_file(const std::string& name);

/// Returns the names of all configurations, sorted.
std::vector<std::string> config_names();

}  // namespace tools
