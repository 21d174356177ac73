#include "tests/fuzz/trace_reading.h"

#include <vector>

#include "tests/fuzz/common.h"
#include "tools/analysis/info.h"
#include "tools/run/frame/replay_program.h"
#include "tools/run/frame/trace_header.h"

namespace fuzz {
namespace {

class NoTracer final : public traces::Tracer {
 public:
  void trace(std::span<const traces::Ray>, traces::RayKind, std::span<traces::Hit>, traces::WalkSink*) const override {}
};

void check_config(const traces::TraceReader& trace) {
  trace.add_file_name_to_errors([&] {
    tools::check_header(trace.header());
    tools::replay_config(trace.header(), "trace", {});
  });
}

void read_tiles(const traces::TraceReader& trace) {
  trace.add_file_name_to_errors([&] { tools::check_header(trace.header()); });
  const std::vector<traces::KernelId> kernels(trace.header().at("kernels").size());
  for (const traces::TraceReader::Part& part : trace.parts()) {
    const traces::TileScope scope = trace.tile_scope(part, static_cast<std::uint32_t>(kernels.size()));
    tools::ReplayProgram program(trace, part, scope, kernels);
    kernels::TileResult tile;
    for (std::uint32_t i = 0; i < part.tiles; ++i) {
      program.run_tile(i, NoTracer(), false, tile);
      program.commit_tile(tile);
    }
  }
}

}  // namespace

void read_trace(const std::filesystem::path& file) {
  ignore_input_errors([&] {
    const traces::TraceReader trace(file);
    ignore_input_errors([&] { tools::trace_info_text(tools::trace_info(trace)); });
    ignore_input_errors([&] { check_config(trace); });
    read_tiles(trace);
  });
}

}  // namespace fuzz
