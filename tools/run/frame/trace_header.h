#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "tools/run/frame/run_job.h"
#include "traces/trace_file/format.h"

namespace tools {

// Writing and reading of the JSON in a trace file. The recorded work itself is in traces/trace_file
// (docs/trace-format.md).

/// Returns the JSON header of a trace that is recorded from these inputs.
traces::Json trace_header(const Inputs& inputs, const JobOptions& options);
/// Returns, as JSON, counts of the frame program for a part of a trace (one frame, or its reference), such as samples
/// traced. The recorded work lacks these counts.
traces::Json recorded_result(const RenderResult& result);
/// Errors of a frame's picture against its reference that a trace contains (tools::PictureError).
struct RecordedError {
  double squared = 0;
  std::optional<double> change = {}, flip = {}, flicker = {};
};
/// Returns a frame's JSON entry in a trace.
traces::Json recorded_frame(std::uint32_t number, const RecordedError& error);

/// Parses the counts of samples and of continued rays that recorded_result() wrote for a part of a trace.
RenderResult parse_recorded_result(const traces::Json& json);

/// Checks the header of a trace. Throws InputError, without the file's name, if a key is missing or has the wrong type.
/// The functions below require a header that has passed this check.
void check_header(const traces::Json& header);

/// Returns the configuration of a replay: the trace's own, or the one named in `options` with the trace's settings of
/// the work. Then --set and --ideal are applied. Throws InputError for a field that would change the recorded work.
RunConfig replay_config(const traces::Json& header, const std::string& file, const JobOptions& options);

/// Throws InputError if the dispatcher sorts rays, because recorded work has no keys. `where`: what records or reads
/// it.
void refuse_sorting(const RunConfig& config, std::string_view where);

/// Throws InputError with the name of the first field of `config` that would change the recorded work, if there is one,
/// or if the machine cannot play recorded work.
void check_recorded(const traces::Json& header, const std::string& file, const RunConfig& config);

}  // namespace tools
