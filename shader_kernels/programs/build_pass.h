#pragma once
#include <memory>
#include <optional>

#include "shader_kernels/programs/build_kernels.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "traces/accel/tree_builds.h"

namespace kernels {

/// Wraps a frame program of a machine that builds trees. If the scene has moved, build passes before the entries
/// (mostly tiles) of that program build and refit trees: an entry per tree for the tree builder, or the passes of
/// kernels.
///
///   build passes: trees --> nodes, leaves --> all later passes: the program's own
///
/// Entries of the build pass render no pixels. They are numbered as tiles after those of the program.
class BuildPass final : public FrameProgram {
 public:
  /// `image` and `builds` must outlive the program.
  BuildPass(std::unique_ptr<FrameProgram> program, const traces::MemoryImage& image, const traces::TreeBuilds& builds,
            std::uint32_t frame);

  std::uint32_t tiles() const override { return build_count() + program_->tiles(); }
  TileGridSize tile_grid_size() const override { return program_->tile_grid_size(); }
  std::uint32_t pass_end(std::uint32_t tile_index) const override;
  std::shared_ptr<const DenoiseHistory> make_history() const override { return program_->make_history(); }
  FrameRequirements requirements() const override;
  void begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

  const std::vector<float>& picture() const override { return program_->picture(); }
  std::vector<float> move_picture_out() override { return program_->move_picture_out(); }
  const Sampling& sampling() const override { return program_->sampling(); }
  void enable_marks() override { program_->enable_marks(); }
  const std::vector<SampleMark>& sample_marks() const override { return program_->sample_marks(); }

 private:
  std::uint32_t build_count() const {
    return kernels_ ? kernels_->entry_count() : static_cast<std::uint32_t>(builds_.trees.size());
  }

  const std::unique_ptr<FrameProgram> program_;
  const traces::TreeBuilds& builds_;
  std::optional<KernelBuild> kernels_;  ///< present if kernels build the frame's tree
  const std::uint32_t frame_;
};

}  // namespace kernels
