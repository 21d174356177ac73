#pragma once
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "traces/trace_file/trace_reader.h"

namespace tools {

/// Contents of a trace, schema raywatt-trace-info/1. InputError for one that is damaged.
nlohmann::ordered_json trace_info(const traces::TraceReader& trace);
/// The same for a terminal, without the keys.
std::string trace_info_text(const nlohmann::ordered_json& info);

}  // namespace tools
