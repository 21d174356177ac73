#pragma once
#include <string>

#include "sim/io/json.h"
#include "traces/trace_file/trace_reader.h"

namespace tools {

/// Returns the contents of a trace, schema raywatt-trace-info/1. InputError if the trace is damaged.
sim::Json trace_info(const traces::TraceReader& trace);
/// Formats the contents for a terminal, without the keys.
std::string trace_info_text(const sim::Json& info);

}  // namespace tools
