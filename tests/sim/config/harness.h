#pragma once
#include <string>
#include <vector>

#include "../folder.h"
#include "machine.h"
#include "sim/error.h"

namespace sim::test {

/// A temporary folder of configuration files, with functions to load MachineConfig from them.
class ConfigHarness {
 public:
  ~ConfigHarness() { set_config_search_path({}); }
  ConfigHarness() = default;
  ConfigHarness(const ConfigHarness&) = delete;
  ConfigHarness& operator=(const ConfigHarness&) = delete;

  ConfigHarness& file(const std::string& name, const std::string& text) {
    folder_.write(name, text);
    return *this;
  }
  MachineConfig load(const std::string& text, const std::vector<std::string>& sets = {}) {
    return load_config<MachineConfig>(folder_.write("a.yaml", text), sets);
  }
  std::string error(const std::string& text, const std::vector<std::string>& sets = {}) {
    return complaint<InputError>(folder_, [&] { load(text, sets); });
  }
  const Folder& folder() const { return folder_; }

 private:
  Folder folder_;
};

}  // namespace sim::test
