#pragma once
#include <string>

#include "sim/io/json.h"
#include "traces/trace_file/trace_reader.h"

namespace tools {

/// Contents of a trace, schema raywatt-trace-info/1. InputError for one that is damaged.
sim::Json trace_info(const traces::TraceReader& trace);
/// The same for a terminal, without the keys.
std::string trace_info_text(const sim::Json& info);

}  // namespace tools
