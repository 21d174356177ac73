#pragma once

#include "sim/config/config_tree.h"
#include "sim/config/describe.h"
#include "sim/io/json.h"

namespace sim {

/// Returns a JSON Schema (draft 2020-12) of the configuration files of this type.
template <class Config>
Json config_schema() {
  Config defaults;
  return schema_of(config_tree(defaults));
}

/// Returns the configuration as nested objects: numbers as numbers, quantities as their text in a file ("500 MHz").
template <class Config>
Json config_json(const Config& config) {
  Config copy = config;
  return json_of(config_tree(copy));
}

}  // namespace sim
