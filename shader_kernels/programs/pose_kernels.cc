#include "shader_kernels/programs/pose_kernels.h"

#include "shader_kernels/catalogue.h"
#include "shader_kernels/kernels/pose.h"

namespace kernels {

void add_pose_passes(const traces::PoseWork& work, KernelPasses& passes) {
  const auto read = [&](std::uint64_t bytes) { return read_stream(passes.reserve(bytes), bytes); };
  const auto write = [&](std::uint64_t bytes) { return write_stream(passes.reserve(bytes), bytes); };
  constexpr std::uint64_t kPoint = sizeof(PointRecord<float>), kSkin = sizeof(SkinRecord<float>);
  constexpr std::uint64_t kMatrix = sizeof(MatrixRecord<float>);
  if (const std::uint64_t n = work.skinned_vertices; n > 0) {
    // A batch reads the matrices of the joints of its share of the vertices.
    passes.add(kPoseStage, "skin", {{kKernelId<SkinVertex>, n}}, n,
               {read(n * kPoint), read(n * kSkin), read(work.joints * kMatrix), write(n * kPoint)});
  }
  if (const std::uint64_t n = work.rigid_vertices; n > 0) {
    passes.add(kPoseStage, "pose", {{kKernelId<PoseVertex>, n}}, n,
               {read(n * kPoint), read(work.rigid_instances * kMatrix), write(n * kPoint)});
  }
}

}  // namespace kernels
