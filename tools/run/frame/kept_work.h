#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shader_kernels/programs/wavefront/frame_program.h"
#include "traces/ray.h"
#include "traces/trace_file/tile_code.h"

namespace tools {

/// The recorded work of a frame in memory, encoded as in a trace file: some hundred bytes per sample.
class KeptWork {
 public:
  /// add() throws InputError above `most_bytes`; `kept_for`: the option or verb that the error names.
  KeptWork(traces::TileScope scope, std::uint64_t most_bytes, std::string kept_for)
      : scope_(std::move(scope)), most_bytes_(most_bytes), kept_for_(std::move(kept_for)) {}

  void add(const traces::TileWork& work);
  std::uint32_t tiles() const { return static_cast<std::uint32_t>(tiles_.size()); }
  /// Decodes a tile. Thread-safe with one decoder per thread.
  void read(std::uint32_t tile_index, traces::TileDecoder& decoder, traces::TileWork& out) const;

 private:
  const traces::TileScope scope_;
  const std::uint64_t most_bytes_;
  const std::string kept_for_;
  std::uint64_t bytes_ = 0;
  traces::TileEncoder encoder_;
  std::string encoded_;
  std::vector<std::string> tiles_;
};

/// Frame program that decodes tiles from memory instead of rendering them, for a front end without workers. Throws
/// Interrupted.
class KeptProgram final : public kernels::FrameProgram {
 public:
  /// `on_tile` is called after each tile.
  KeptProgram(const KeptWork& work, const kernels::FrameRequirements& requirements, std::function<void()> on_tile)
      : FrameProgram(0, 0), work_(work), requirements_(requirements), on_tile_(std::move(on_tile)) {}

  std::uint32_t tiles() const override { return work_.tiles(); }
  kernels::FrameRequirements requirements() const override { return requirements_; }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override;
  void commit_tile(const kernels::TileResult& /*tile*/) override {}

 private:
  const KeptWork& work_;
  const kernels::FrameRequirements requirements_;
  const std::function<void()> on_tile_;
  mutable traces::TileDecoder decoder_;
};

/// Tracer for work that is not rendered.
class NoTracer final : public traces::Tracer {
 public:
  void trace(std::span<const traces::Ray> /*rays*/, traces::RayKind /*kind*/, std::span<traces::Hit> /*hits*/,
             traces::WalkSink* /*walk*/) const override {}
};

}  // namespace tools
