#include "shader_kernels/programs/adaptive/supersample.h"

#include <algorithm>

#include "shader_kernels/kernels/pack_subpixels.h"

namespace kernels {
SupersampleProgram::SupersampleProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                       const RenderConfig& config, const SupersampleConfig& supersample,
                                       std::uint32_t frame)
    : FrameProgram(config.width, config.height),
      config_(config),
      supersample_(supersample),
      scene_(image, config),
      camera_(camera_uniforms(camera, config.width, config.height)),
      tiles_(config.width, config.height, config.tile / 2, 1),  // sub-pixels, two along a pixel
      order_(tiles_.tiles().order(supersample.halo)),
      frame_(frame),
      shown_(supersample.propagate == 0 ? 0 : config.width, supersample.propagate == 0 ? 0 : config.height,
             tiles_.count()) {}

FrameRequirements SupersampleProgram::requirements() const {
  const std::uint32_t samples = tiles_.side() * tiles_.side();
  FrameRequirements needs;
  needs.tile_samples = std::max(samples, kChunk * kExtra);
  needs.attribute_bytes = supersample_.attributes == AttributeStorage::kTile ? samples * kAttributeBytes : 0;
  if (supersample_.propagate != 0) needs.attribute_bytes += waiting_bytes();
  needs.region_bytes = {std::uint64_t{tiles_.count()} * tile_pixels() * kPixelBytes,
                        supersample_.propagate == 0 ? tiles_.count() * store_bytes() : fresh_store(tiles_.count(), 1),
                        0};
  return needs;
}

void SupersampleProgram::begin_tile(const SampleTile& at, TileResult& out) const {
  tiles_.place(at, out);
  out.sampling = {};
  out.marks.clear();
  out.subpixels.clear();
  out.corrected.clear();
  out.buffer.hold_samples(centres() + std::size_t{kWhole} * tile_pixels());
  // Blocks that stand out look at verdicts behind the last.
  out.buffer.hold_subpixels(centres(), tile_pixels() + kBlockHeight * tiles_.pitch() + kBlockWidth);
  out.work.frame = frame_;
  out.work.tile = at.index;
  out.work.samples = at.width * at.height;
}

SupersampleProgram::Tile SupersampleProgram::tile_of(const SampleTile& at, Wavefront& wave, TileResult& out) const {
  return {at, tiles_.finished(at, out), out.width * out.height, wave, out, out.buffer};
}

void SupersampleProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                  TileResult& out) const {
  if (tile_index >= tiles_.count()) return run_round(tile_index, tracer, record, out);
  const SampleTile at = tiles_.tiles().tile(order_[tile_index]);
  begin_tile(at, out);
  Wavefront wave(scene_, tracer, record, cone_uniforms(camera_, 1), out);
  Tile tile = tile_of(at, wave, out);
  out.linear.resize(tile.pixels);
  out.packed.resize(tile.pixels);
  out.marks.assign(tile.pixels, 0);

  trace_centres(tile, tiles_.halo(), tiles_.halo(), at.width, at.height, true);
  export_borders(tile);  // needs nothing of the halo, so no tile waits for a row of others
  make_halo(tile);
  park_attributes(tile);
  const Node tested = test(tile);
  const Node weighed = weigh(tile, tested);
  if (supersample_.propagate != 0) show(tile);
  const Node averaged = sample_active(tile, tested, weighed);
  wave.put_out(averaged, std::uint64_t{at.index} * tile_pixels() * kPixelBytes);
  if (supersample_.propagate != 0) put_shown(tile);
  wave.finish();
  count(tile);
}

}  // namespace kernels
