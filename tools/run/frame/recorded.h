#pragma once
#include <cstdint>
#include <string>

#include "tools/run/frame/run_job.h"
#include "traces/trace_file/format.h"

namespace tools {

// Header of a trace, beside the work itself (docs/trace-format.md).

/// The header of a trace of these inputs.
traces::Json trace_header(const Inputs& inputs, const JobOptions& options);
/// A part's result: what a frame program found out that is not in its work.
traces::Json recorded_result(const FrontEnd::Result& result);
/// A frame; `error` is the mean squared difference between its picture and the reference's.
traces::Json recorded_frame(std::uint32_t number, double error);

/// Reads a part's result back: sampling, and the rays that were continued.
FrontEnd::Result result_of(const traces::Json& json);

/// InputError, without the file's name, for a header that lacks a key, or has something else there. Those below are for
/// headers that have passed.
void check_header(const traces::Json& header);

/// The configuration for a replay: that of the trace, or if `options` name one that one, with what the trace's command
/// line said of the work; then --set and --ideal. InputError that names the field if it would change the recorded work.
RunConfig replay_config(const traces::Json& header, const std::string& file, const JobOptions& options);

/// InputError that names the first field of `config` that would change the recorded work.
void check_recorded(const traces::Json& header, const std::string& file, const RunConfig& config);

}  // namespace tools
