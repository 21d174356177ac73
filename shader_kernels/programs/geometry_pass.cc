#include "shader_kernels/programs/geometry_pass.h"

#include <utility>

#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/tile_graph.h"

namespace kernels {

GeometryPass::GeometryPass(std::unique_ptr<FrameProgram> program, std::unique_ptr<traces::Rasteriser> rasteriser,
                           std::uint32_t frame)
    : FrameProgram(0, 0), program_(std::move(program)), rasteriser_(std::move(rasteriser)), frame_(frame) {}

std::uint32_t GeometryPass::pass_end(std::uint32_t tile_index) const {
  return tile_index < batch_count() ? batch_count() : batch_count() + program_->pass_end(tile_index - batch_count());
}

FrameRequirements GeometryPass::requirements() const {
  FrameRequirements needs = program_->requirements();
  needs.raster = rasteriser_->raster_array_sizes();
  return needs;
}

void GeometryPass::begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) {
  if (tile_index >= batch_count()) program_->begin_pass(tile_index - batch_count(), tracer);
}

void GeometryPass::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                            TileResult& out) const {
  if (tile_index < batch_count()) return run_batch(tile_index, record, out);
  out.rasteriser = rasteriser_.get();
  program_->run_tile(tile_index - batch_count(), tracer, record, out);
  // The lists of triangles must be complete before a tile reads them.
  if (tile_index == batch_count() && batch_count() > 0) out.work.after_all = true;
}

void GeometryPass::run_batch(std::uint32_t batch, bool record, TileResult& out) const {
  out.clear_for_pass_entry(frame_, program_->tiles() + batch);
  StreamBuilder stream(out.work, out.buffer.scratch.spare_nodes, record);
  if (record) stream.add_binning(rasteriser_->bin_triangles(batch, out.buffer.scratch.coverage, out.work));
  stream.finish();
}

void GeometryPass::commit_tile(const TileResult& tile) {
  if (tile.tile < program_->tiles()) program_->commit_tile(tile);
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
