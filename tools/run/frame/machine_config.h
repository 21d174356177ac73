#pragma once
#include <memory>

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

}  // namespace tools
