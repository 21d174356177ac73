#pragma once
#include <memory>
#include <optional>

#include "shader_kernels/programs/build_kernels.h"
#include "shader_kernels/programs/leading_pass.h"
#include "traces/accel/tree_builds.h"

namespace kernels {

/// Wraps a frame program of a machine that builds trees. If the scene has moved, build passes before the entries of
/// that program build and refit trees: an entry per tree for the tree builder, or the passes of kernels.
///
///   build passes: trees --> nodes, leaves --> all later passes: the program's own
class BuildPass final : public LeadingPass {
 public:
  /// `image` and `builds` must outlive the program.
  BuildPass(std::unique_ptr<FrameProgram> program, const traces::MemoryImage& image, const traces::TreeBuilds& builds,
            std::uint32_t frame);

  FrameRequirements requirements() const override;

 private:
  std::uint32_t leading_entries() const override {
    return kernels_ ? kernels_->entry_count() : static_cast<std::uint32_t>(builds_.trees.size());
  }
  void record_entry(std::uint32_t entry, StreamBuilder& stream, TileResult& out) const override;
  /// Rays read trees only when they are complete, unless trees are written to other copies.
  bool is_awaited() const override { return builds_.sizes.shadow_bytes == 0; }

  const traces::TreeBuilds& builds_;
  std::optional<KernelBuild> kernels_;  ///< present if kernels build the frame's tree
};

}  // namespace kernels
