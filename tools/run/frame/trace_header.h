#pragma once
#include <cstdint>
#include <string>

#include "tools/run/frame/run_job.h"
#include "traces/trace_file/format.h"

namespace tools {

// The JSON of a trace file; the work itself is in traces/trace_file (docs/trace-format.md).

/// Returns the header of a trace of these inputs.
traces::Json trace_header(const Inputs& inputs, const JobOptions& options);
/// Returns the result of a part: outputs of the frame program that are not in its work.
traces::Json recorded_result(const RenderResult& result);
/// Returns the entry of a frame. `error`: mean squared difference from the reference's picture.
traces::Json recorded_frame(std::uint32_t number, double error);

/// Parses the result of a part: sampling and continued rays.
RenderResult parse_recorded_result(const traces::Json& json);

/// Throws InputError, without the file's name, if a key is missing or has the wrong type. The functions below need a
/// checked header.
void check_header(const traces::Json& header);

/// Returns the configuration of a replay: that of the trace, or the one that `options` name with the trace's own
/// settings of the work; then --set and --ideal. InputError for a field that would change the recorded work.
RunConfig replay_config(const traces::Json& header, const std::string& file, const JobOptions& options);

/// Throws InputError with the first field of `config` that would change the recorded work.
void check_recorded(const traces::Json& header, const std::string& file, const RunConfig& config);

}  // namespace tools
