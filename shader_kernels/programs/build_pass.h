#pragma once
#include <memory>

#include "shader_kernels/programs/kernel_passes.h"
#include "shader_kernels/programs/leading_pass.h"
#include "traces/accel/tree_builds.h"

namespace kernels {

/// Wraps a frame program of a machine that builds trees. If the scene has moved, passes before the entries of that
/// program pose its geometry by kernels, then build and refit trees: by kernels, or an entry per tree for the tree
/// builder.
///
/// Each arrow is a group of passes, which reads what is on its left and writes what is on its right:
///
///   vertices --> posed vertices --> nodes and leaves --> picture (the wrapped program's passes)
class BuildPass final : public LeadingPass {
 public:
  /// `image` and `builds` must outlive the program.
  BuildPass(std::unique_ptr<FrameProgram> program, const traces::MemoryImage& image, const traces::TreeBuilds& builds,
            std::uint32_t frame);

  FrameRequirements requirements() const override;

 private:
  bool has_unit() const { return builds_.engine == traces::BuildEngine::kUnit; }
  std::uint32_t leading_entries() const override {
    return passes_.entry_count() + (has_unit() ? static_cast<std::uint32_t>(builds_.trees.size()) : 0);
  }
  void record_entry(std::uint32_t entry, StreamBuilder& stream, TileResult& out) const override;
  /// Rays read trees only when they are complete, unless trees are written to other copies.
  bool is_awaited() const override { return builds_.sizes.shadow_bytes == 0; }

  const traces::TreeBuilds& builds_;
  KernelPasses passes_;
};

}  // namespace kernels
