#pragma once
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "shader_kernels/programs/wavefront/frame_program.h"
#include "traces/trace_file/trace_reader.h"

namespace tools {

/// Frame program that reads tiles from a trace file instead of rendering them, so there is no picture.
class ReplayProgram final : public kernels::FrameProgram {
 public:
  /// `kernels`: kernels of this build by their number in the trace. All arguments must outlive the object.
  ReplayProgram(const traces::TraceReader& trace, const traces::TraceReader::Part& part, const traces::TileScope& scope,
                std::span<const traces::KernelId> kernels);

  std::uint32_t tiles() const override { return part_.tiles; }
  kernels::FrameRequirements requirements() const override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override;
  void commit_tile(const kernels::TileResult& tile) override;
  const traces::TileScope& scope() const { return scope_; }

 private:
  using Cursor = traces::TraceReader::Cursor;
  std::unique_ptr<Cursor> take_cursor() const;

  const traces::TraceReader& trace_;
  const traces::TraceReader::Part& part_;
  const traces::TileScope& scope_;
  const std::span<const traces::KernelId> kernels_;
  const std::vector<traces::TraceReader::FileRange> tiles_;
  std::uint64_t continued_ = 0;
  kernels::Sampling sampling_;
  std::uint32_t kept_ = 0;
  std::uint64_t rays_ = 0;
  std::vector<bool> seen_;  ///< by tile number
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Cursor>> cursors_;  ///< free cursors
};

/// Bounds of what the work of a trace may refer to; null for other programs.
const traces::TileScope* scope_of(const kernels::FrameProgram& program);

}  // namespace tools
