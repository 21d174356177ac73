#pragma once
#include "shader_kernels/programs/kernel_passes.h"
#include "traces/accel/pose_work.h"

namespace kernels {

/// Adds the passes that move a frame's geometry to its pose: skinned vertices, vertices of rigid meshes, and instances.
/// Vertices are read in their rest pose.
void add_pose_passes(const traces::PoseWork& work, KernelPasses& passes);

}  // namespace kernels
