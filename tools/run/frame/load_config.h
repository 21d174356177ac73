#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shader_kernels/programs/programs.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "sim/config/config_tree.h"
#include "sim/config/field.h"
#include "sim/config/variant.h"
#include "sim/named.h"
#include "sim/report/energy.h"
#include "sim/report/thermal.h"
#include "sim/unit_report.h"
#include "tools/run/frame/job_options.h"
#include "traces/accel/build_config.h"
#include "traces/accel/bvh_config.h"
#include "traces/scenes/workload.h"

namespace hw {

struct GpuConfig;
}

namespace tools {

/// A machine's configuration on the heap, so that headers need only the declaration of hw::GpuConfig.
class MachineConfig {
 public:
  MachineConfig();
  MachineConfig(const MachineConfig& other);
  MachineConfig& operator=(const MachineConfig& other);
  ~MachineConfig();

  hw::GpuConfig& operator*() { return *config_; }
  const hw::GpuConfig& operator*() const { return *config_; }
  hw::GpuConfig* operator->() { return config_.get(); }
  const hw::GpuConfig* operator->() const { return config_.get(); }

 private:
  std::unique_ptr<hw::GpuConfig> config_;  ///< never null
};

/// State of the caches at the start of a frame.
enum class FrameStart : std::uint8_t {
  kCold,  ///< caches are empty
  kWarm,  ///< caches are as the previous frame left them
};
constexpr std::array<std::string_view, 2> names_of(FrameStart) { return {"cold", "warm"}; }

/// Settings of a frame as part of a sequence: start state of the caches, and target frame rate.
struct FrameConfig {
  FrameStart start = FrameStart::kCold;
  double fps = 0;

  static void describe(auto& c, auto&& field) {
    field(NAMED(c.start), "", "caches at the start of a frame: empty, or as the previous frame left them", sim::any(),
          sim::Affects::kTiming);
    field(NAMED(c.fps), "frames/s", "target frame rate: of power_at_fps_w, fps_margin and sustained runs; 0: none",
          sim::between(0, 100000), sim::Affects::kEnergy);
  }
};

struct RunConfig;

/// Table of the hit latency of caches as a function of their size: the contents of a file in configs/latency.
struct LatencyConfig {
  std::string process = "unnamed";
  std::map<std::string, sim::Band> arrays;
  std::uint32_t l1 = 1, l2 = 11;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.process), "", "technology of the table", sim::any(), Affects::kReport);
    field(NAMED(c.arrays), "ns", "time to read an array, as read@16KiB: points of a curve over its size",
          sim::at_least(0), Affects::kTiming);
    field(NAMED(c.l1), "cycles", "latency of a hit in a first-level cache of the T&I unit, in addition to its array",
          sim::between(0, 63), Affects::kTiming);
    field(NAMED(c.l2), "cycles", "latency of a hit in the L2 or system cache, in addition to its array",
          sim::between(0, 63), Affects::kTiming);
  }
};

/// Computes hit_cycles of caches that have `auto`, from the cache's size and clock. Throws InputError if the table has
/// no curve.
void set_automatic_cache_hit_cycles(RunConfig& config);

/// True if at least one cache has hit_cycles `auto`.
bool uses_latency_table(const RunConfig& config);

/// Returns a warning for each cache with hit_cycles `auto` and a size outside the range of the latency curve.
std::vector<std::string> latency_warnings(const RunConfig& config);

/// Everything that a run depends on, except the frame program: one YAML file. The machine's keys are at the top level.
struct RunConfig {
  std::string process;
  MachineConfig gpu;
  kernels::RenderConfig render;
  kernels::ProgramConfig programs;
  traces::BvhConfig bvh;
  traces::BuildConfig build;
  sim::EnergyConfig energy;
  sim::PowerConfig power;
  sim::AreaConfig area;
  LatencyConfig latency;
  sim::ThermalConfig thermal;
  FrameConfig frame;
  traces::WorkloadConfig scene;
  traces::SceneLimits limits;

  static void describe(auto& c, auto&& field);
  void check(auto&& complain) const;

 private:
  void check_sorted_records(auto&& complain) const;
};

/// Loads the configuration of a run: the file, the workload if --scene names one, then --set, --scene, --camera,
/// --frames and --resolution. Throws InputError.
RunConfig load_run_config(const JobOptions& options);

/// Returns a warning for each setting of the command line that has no effect.
std::vector<std::string> ineffective_setting_warnings(const JobOptions& options, const RunConfig& config);
/// Returns a warning if the machine is charged for a tree that its engine cannot build.
std::vector<std::string> tree_builder_warnings(const RunConfig& config);

/// Throws InputError if the name is not a scene, a workload or a file.
void check_scene(const std::string& name);

/// Loads a configuration file, then the workload file if `scene` is the name of a workload. A setting of the key
/// `process` in `sets` replaces the process that the files choose; other settings are ignored. Does not check the
/// configuration. This function is the first step of load_run_config(); ConfigVariants performs the remaining steps.
RunConfig load_base_config(const std::string& config, const std::string& scene,
                           const std::vector<std::string>& sets = {});

// The functions below are the last steps of load_run_config(), for configurations from other sources.
void apply_ideal(RunConfig& config, const std::vector<std::string>& resources);
/// Checks the limits of all keys, the rules between keys, and that there are energy values. `origin`: name of the
/// configuration in errors.
void check_run_config(RunConfig& config, const std::string& origin);

/// Applies options to a base configuration repeatedly. The cost of a call is proportional to the number of changes.
class ConfigVariants {
 public:
  /// `origin`: name of the base configuration in errors.
  ConfigVariants(RunConfig base, std::string origin);
  ConfigVariants(const ConfigVariants&) = delete;
  ConfigVariants& operator=(const ConfigVariants&) = delete;

  /// Returns the base configuration with the options applied and checked; the result is valid until the next call.
  /// Throws InputError.
  const RunConfig& apply(const JobOptions& options);
  /// Returns the configuration made by the last call of apply().
  const RunConfig& config() const { return config_; }
  /// Returns sim::config_hash() of the configuration made by the last call of apply().
  std::string hash(std::optional<sim::Affects> only) const { return variant_.hash(only); }

 private:
  RunConfig base_, config_;
  std::string origin_;
  sim::ConfigNode base_tree_, tree_;
  sim::ConfigVariant variant_;
};

/// Throws InputError unless every entry of the tables of energy and area matches a counter or hardware of the machine,
/// and every counter has an entry.
void check_table_names(std::span<const sim::UnitReport> units, const RunConfig& config);

/// Returns a warning for each size, clock and voltage outside the ranges of the energy, area and latency tables, and
/// one if tables are for different processes.
std::vector<std::string> technology_table_warnings(const RunConfig& config, std::span<const sim::UnitReport> units);

/// Returns the warnings of technology_table_warnings() for all units of the configured machine, without a run.
std::vector<std::string> technology_table_warnings(const RunConfig& config);

/// Returns a warning if the tables of energy, area, voltage and latency that `config` uses are for different processes.
std::vector<std::string> process_warnings(const RunConfig& config);

/// Appends those lines of `more` that `lines` does not contain.
void add_warnings(std::vector<std::string>& lines, const std::vector<std::string>& more);

}  // namespace tools

/// Instantiated only in load_config.cc, because compilation is slow: the machine has many keys.
extern template sim::ConfigNode sim::config_tree(tools::RunConfig& config);
