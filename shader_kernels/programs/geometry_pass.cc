#include "shader_kernels/programs/geometry_pass.h"

#include <utility>

#include "shader_kernels/programs/wavefront/scene_tables.h"

namespace kernels {

GeometryPass::GeometryPass(std::unique_ptr<FrameProgram> program, std::unique_ptr<traces::Rasteriser> rasteriser,
                           std::uint32_t frame)
    : LeadingPass(std::move(program), frame), rasteriser_(std::move(rasteriser)) {}

FrameRequirements GeometryPass::requirements() const {
  FrameRequirements needs = LeadingPass::requirements();
  needs.raster = rasteriser_->raster_array_sizes();
  return needs;
}

void GeometryPass::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                            TileResult& out) const {
  if (tile_index >= leading_entries()) out.rasteriser = rasteriser_.get();
  LeadingPass::run_tile(tile_index, tracer, record, out);
}

void GeometryPass::record_entry(std::uint32_t entry, StreamBuilder& stream, TileResult& out) const {
  stream.add_binning(rasteriser_->bin_triangles(entry, out.buffer.scratch.coverage, out.work));
}

std::unique_ptr<traces::Rasteriser> make_rasteriser(const traces::MemoryImage& image, const traces::Camera& camera,
                                                    std::uint32_t width, std::uint32_t height,
                                                    const traces::RasterConfig& config, std::uint32_t side) {
  const CameraUniforms<float> at = camera_uniforms(camera, width, height);
  const auto vector = [](const Vec3<float>& v) { return glm::vec3(v.x, v.y, v.z); };
  const traces::PictureCamera picture{
      vector(at.origin), vector(at.corner), vector(at.right), vector(at.down), width, height};
  return std::make_unique<traces::Rasteriser>(image, picture, config, side);
}

}  // namespace kernels
