#pragma once
#include <optional>
#include <string>

#include "sim/config/config_tree.h"
#include "sim/config/variant.h"
#include "tools/run/frame/job_options.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Applies options to a base configuration repeatedly; the cost is proportional to the changes.
class ConfigVariants {
 public:
  /// `origin`: name of the base in errors.
  ConfigVariants(RunConfig base, std::string origin);
  ConfigVariants(const ConfigVariants&) = delete;
  ConfigVariants& operator=(const ConfigVariants&) = delete;

  /// Returns the base with the options applied and checked; valid until the next call. InputError.
  const RunConfig& apply(const JobOptions& options);
  /// The configuration of the last call.
  const RunConfig& config() const { return config_; }
  /// Returns sim::config_hash() of that configuration.
  std::string hash(std::optional<sim::Affects> only) const { return variant_.hash(only); }

 private:
  RunConfig base_, config_;
  std::string origin_;
  sim::ConfigNode base_tree_, tree_;
  sim::ConfigVariant variant_;
};

}  // namespace tools
