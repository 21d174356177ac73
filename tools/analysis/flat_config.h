#pragma once
#include <map>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace tools {

/// A configuration, as report.json has it, key by key: "tni.trv.l1.size" -> "16 KiB".
using FlatConfig = std::map<std::string, std::string>;
FlatConfig flat_config(const nlohmann::ordered_json& config);

}  // namespace tools
