#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shader_kernels/programs/wavefront/frame_program.h"
#include "traces/ray.h"
#include "traces/trace_file/tile_code.h"
#include "traces/trace_file/trace_reader.h"

namespace tools {

/// Frame program that reads tiles from a trace file instead of rendering them, so there is no picture.
class ReplayProgram final : public kernels::FrameProgram {
 public:
  /// `kernels`: kernels of this build, indexed by their number in the trace. All arguments must outlive the object.
  ReplayProgram(const traces::TraceReader& trace, const traces::TraceReader::Part& part, const traces::TileScope& scope,
                std::span<const traces::KernelId> kernels);

  std::uint32_t tiles() const override { return part_.tiles; }
  kernels::FrameRequirements requirements() const override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override;
  void commit_tile(const kernels::TileResult& tile) override;
  const traces::TileScope& tile_scope() const { return scope_; }

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
  std::vector<bool> seen_;  ///< tile numbers seen so far
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Cursor>> cursors_;  ///< cursors that no thread uses
};

/// Returns the bounds of nodes, triangles and addresses in a replayed trace; null if the program is not a replay.
const traces::TileScope* scope_of(const kernels::FrameProgram& program);

/// The recorded work of a frame in memory, encoded as in a trace file: some hundred bytes per sample.
class InMemoryTrace {
 public:
  /// `most_bytes`: size of the trace above which add() throws InputError. `requested_by`: option or verb that the error
  /// names.
  InMemoryTrace(traces::TileScope scope, std::uint64_t most_bytes, std::string requested_by)
      : scope_(std::move(scope)), most_bytes_(most_bytes), requested_by_(std::move(requested_by)) {}

  void add(const traces::TileWork& work);
  std::uint32_t tiles() const { return static_cast<std::uint32_t>(tiles_.size()); }
  /// Decodes a tile. Thread-safe with one decoder per thread.
  void decode_tile(std::uint32_t tile_index, traces::TileDecoder& decoder, traces::TileWork& out) const;

 private:
  const traces::TileScope scope_;
  const std::uint64_t most_bytes_;
  const std::string requested_by_;
  std::uint64_t bytes_ = 0;
  traces::TileEncoder encoder_;
  std::string encoded_;
  std::vector<std::string> tiles_;
};

/// Frame program that decodes tiles from memory instead of rendering them. The front end must have no worker threads,
/// because all tiles share one decoder. Throws Interrupted.
class InMemoryTraceProgram final : public kernels::FrameProgram {
 public:
  /// `on_tile` is called after each decoded tile.
  InMemoryTraceProgram(const InMemoryTrace& work, const kernels::FrameRequirements& requirements,
                       std::function<void()> on_tile)
      : FrameProgram(0, 0), work_(work), requirements_(requirements), on_tile_(std::move(on_tile)) {}

  std::uint32_t tiles() const override { return work_.tiles(); }
  kernels::FrameRequirements requirements() const override { return requirements_; }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override;
  void commit_tile(const kernels::TileResult& /*tile*/) override {}

 private:
  const InMemoryTrace& work_;
  const kernels::FrameRequirements requirements_;
  const std::function<void()> on_tile_;
  mutable traces::TileDecoder decoder_;
};

/// Tracer that does nothing, for frame programs that do not render.
class NoTracer final : public traces::Tracer {
 public:
  void trace(std::span<const traces::Ray> /*rays*/, traces::RayKind /*kind*/, std::span<traces::Hit> /*hits*/,
             traces::WalkSink* /*walk*/) const override {}
};

}  // namespace tools
