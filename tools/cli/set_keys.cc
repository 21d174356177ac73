#include "tools/cli/set_keys.h"

#include "sim/config/config.h"
#include "tools/host/paths.h"
#include "tools/run/frame/load_config.h"

namespace tools {

SetKeys set_keys() {
  SetKeys keys;
  for (sim::FieldInfo& field : sim::list_fields(load_run_config(JobOptions()))) {
    keys.every.push_back(field.path);
    if (field.affects == sim::Affects::kEnergy) keys.of_energy.push_back(field.path);
    if (field.kind == sim::FieldKind::kBool) field.choices = {"true", "false"};
    if (!field.choices.empty()) keys.values.emplace_back(field.path, std::move(field.choices));
  }
  for (const std::string group : {"dram", "energy", "power", "latency", "area"}) {
    const std::string key = group + ".extends";
    keys.every.push_back(key);
    if (group == "energy" || group == "power") keys.of_energy.push_back(key);
    keys.values.emplace_back(key, config_names_in(group));
  }
  return keys;
}

}  // namespace tools
