#pragma once
#include <memory>
#include <vector>

#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/tile_graph.h"

namespace kernels {

/// Base of programs that wrap another program and run passes of their own before it. An entry is a unit of work that
/// the machine launches, mostly a tile.
///
///   leading entries --> the wrapped program's passes
///
/// Leading entries render no pixels. They run first, but have the tile numbers after those of the wrapped program.
/// Picture, samples and history are those of the wrapped program.
class LeadingPass : public FrameProgram {
 public:
  LeadingPass(std::unique_ptr<FrameProgram> program, std::uint32_t frame)
      : FrameProgram(0, 0), program_(std::move(program)), frame_(frame) {}

  std::uint32_t tiles() const override { return leading_entries() + program_->tiles(); }
  TileGridSize tile_grid_size() const override { return program_->tile_grid_size(); }
  std::uint32_t pass_end(std::uint32_t tile_index) const override;
  std::shared_ptr<const DenoiseHistory> make_history() const override { return program_->make_history(); }
  FrameRequirements requirements() const override { return program_->requirements(); }
  void begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

  const std::vector<float>& picture() const override { return program_->picture(); }
  std::vector<float> move_picture_out() override { return program_->move_picture_out(); }
  const Sampling& sampling() const override { return program_->sampling(); }
  void enable_marks() override { program_->enable_marks(); }
  const std::vector<SampleMark>& sample_marks() const override { return program_->sample_marks(); }

 protected:
  virtual std::uint32_t leading_entries() const = 0;
  /// Records the work of a leading entry.
  virtual void record_entry(std::uint32_t entry, StreamBuilder& stream, TileResult& out) const = 0;
  /// True if the wrapped program waits until all leading entries have finished.
  virtual bool is_awaited() const { return true; }

 private:
  const std::unique_ptr<FrameProgram> program_;
  const std::uint32_t frame_;
};

}  // namespace kernels
