#include "shader_kernels/programs/reconstruct/reconstruct.h"

#include <algorithm>
#include <array>

namespace kernels {
namespace {

/// Flags of all materials of a scene.
std::uint32_t flags_of(const traces::MemoryImage& image) {
  std::uint32_t flags = 0;
  for (const traces::MaterialRecord& material : image.materials) flags |= material.flags;
  return flags;
}

}  // namespace

ReconstructProgram::ReconstructProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                       const RenderConfig& config, const ReconstructConfig& reconstruct,
                                       Filters filters, float scene_size, std::uint32_t frame)
    : FrameProgram(config.width, config.height),
      config_(config),
      reconstruct_(reconstruct),
      filters_(filters),
      scene_(image, config),
      camera_(camera_uniforms(camera, config.width, config.height)),
      tiles_(config.width, config.height, config.tile / 2,
             reconstruct.radius),  // pixels have four samples, two along a side
      order_(tiles_.tiles().order(reconstruct.halo)),
      frame_(frame),
      depth_scale_(reconstruct.depth_scale(scene_size)),
      bend_(reconstruct.bend()) {
  if (!filters_apart() || !has_geometry() || config.depth == 1) return;
  const std::uint32_t flags = flags_of(image);
  // Glass mirrors, too.
  const bool reflects = scene_.effects.has(Effect::kReflections), refracts = scene_.effects.has(Effect::kRefractions);
  if (reflects && (flags & (traces::kMirror | traces::kGlass | traces::kPhysical)) != 0) mirrors_ = layers_++;
  if ((flags & traces::kBlended) != 0 || (refracts && (flags & traces::kGlass) != 0)) glass_ = layers_++;
}

std::uint32_t ReconstructProgram::shaded_bytes() const {
  return layers_ * static_cast<std::uint32_t>(sizeof(VisibleRecord<float>) + sizeof(ColourRecord<float>));
}
std::uint32_t ReconstructProgram::other_bytes() const {
  return kOtherSamples * layers_ * static_cast<std::uint32_t>(sizeof(VisibleRecord<float>));
}
std::uint32_t ReconstructProgram::attribute_bytes() const {
  return has_geometry() ? kGeometrySamples * layers_ * static_cast<std::uint32_t>(sizeof(VisibleRecord<float>)) : 0;
}

FrameRequirements ReconstructProgram::requirements() const {
  const std::uint32_t pixels = tiles_.side() * tiles_.side();
  FrameRequirements needs;
  needs.tile_samples = layers_ * pixels;
  needs.wave_samples = has_geometry() ? kOtherSamples * pixels : pixels;
  needs.attribute_bytes = reconstruct_.attributes == AttributeStorage::kTile ? pixels * attribute_bytes() : 0;
  needs.region_bytes = {std::uint64_t{tiles_.count()} * tiles_.most_pixels() * kPixelBytes,
                        tiles_.count() * store_bytes(), 0};
  return needs;
}

ReconstructProgram::Tile ReconstructProgram::tile_of(const SampleTile& at, Wavefront& wave, TileResult& out) const {
  return {at, tiles_.finished(at, out), out.width * out.height, wave, out, out.buffer};
}

void ReconstructProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                  TileResult& out) const {
  const SampleTile at = tiles_.tiles().tile(order_[tile_index]);
  tiles_.place(at, out);
  out.sampling = {};
  out.marks.clear();
  out.work.frame = frame_;
  out.work.tile = at.index;
  out.work.samples = at.width * at.height;
  out.buffer.hold_visible(std::size_t{layers_} * layer(), tiles_.most_pixels());
  Wavefront wave(scene_, tracer, record, cone_uniforms(camera_, 1), out);
  Tile tile = tile_of(at, wave, out);
  out.linear.resize(tile.pixels);
  out.packed.resize(tile.pixels);

  const Part own{tiles_.halo(), tiles_.halo(), at.width, at.height};
  trace(tile, own, own, true);
  export_borders(tile);  // needs nothing of the halo, so no tile waits for a row of others
  make_halo(tile);
  park_attributes(tile);
  Node made = has_geometry() ? reconstruct(tile) : show_shaded(tile);
  if (tests_colours()) made = shade_contrasts(tile, made);
  wave.put_out(made, std::uint64_t{at.index} * tiles_.most_pixels() * kPixelBytes);
  wave.finish();
  count(tile);
}

VisibleSamples ReconstructProgram::records(bool are_shaded) const {
  VisibleSamples records{.are_kept = has_geometry(), .are_shaded = are_shaded};
  records.have_shadows = filters_apart();
  records.mirrored = mirrors_ * layer();
  records.refracted = glass_ * layer();
  if (!are_shaded) records.depth = layers_ > 1 ? 2 : 1;
  records.eye = eye_uniforms(camera_, config_.width, config_.height, depth_scale_);
  records.depth_scale = depth_scale_;
  return records;
}

/// Shaded samples of a rectangle, other samples of one.
void ReconstructProgram::trace(Tile& tile, const Part& shaded, const Part& others, bool is_own) const {
  const Node cleared = clear_branches(tile, shaded);
  trace_shaded(tile, shaded, cleared);
  if (has_geometry()) trace_others(tile, others, cleared);
  if (tile.wave.is_muted()) return;
  const std::uint32_t samples = shaded.pixels() + (has_geometry() ? kOtherSamples * others.pixels() : 0);
  tile.out.sampling.traced += samples;
  if (!is_own) tile.out.sampling.halo += samples;
}

ReconstructProgram::Node ReconstructProgram::clear_branches(Tile& tile, const Part& part) const {
  Node last = Wavefront::kNone;
  for (std::uint32_t b = 1; b < layers_; ++b) {
    ClearBranch::Ports<float> ports;
    ports.lattice = tiles_.lattice(part.x, part.y, part.across);
    ports.lattice.first += static_cast<float>(b * layer());
    ports.apart = positions();
    const Node cleared = tile.wave.launch<ClearBranch>(ports, part.pixels());
    tile.wave.wait_all(cleared, last);
    last = cleared;
  }
  if (last != Wavefront::kNone) tile.wave.adds_records(last);
  return last;
}

VisibleRayPorts<float>& ReconstructProgram::bind(VisibleRayPorts<float>& ports, const Tile& tile,
                                                 const Part& part) const {
  bind_pixels(ports, tile);
  ports.lattice = tiles_.lattice(part.x, part.y, part.across);
  return ports;
}

/// Says in which pixels the wave's samples lie, and those of what mirrors and glass show.
void ReconstructProgram::place(Tile& tile, std::uint32_t rays) const {
  if (!tile.wave.counts_pixels()) return;
  for (std::uint32_t i = 0; i < rays; ++i) {
    const std::uint32_t sample = tile.buffer.wave.paths[i].sample, position = sample % positions();
    const std::uint32_t x = tile.at.x + position % tiles_.pitch() - tiles_.halo();
    const std::uint32_t y = tile.at.y + position / tiles_.pitch() - tiles_.halo();
    for (std::uint32_t b = 0; b < layers_; ++b) tile.wave.place(sample + b * layer(), x, y);
  }
}

void ReconstructProgram::trace_shaded(Tile& tile, const Part& part, Node cleared) const {
  Wavefront& wave = tile.wave;
  tile.buffer.hold_wave(part.pixels());
  GenerateShadedRays::Ports<float> ports;
  bind(ports, tile, part);
  const Node generated = wave.launch<GenerateShadedRays>(ports, part.pixels());
  place(tile, part.pixels());
  wave.adds_records(generated);
  Wavefront::RetainedRecords retained;
  retained.visible = records(true);
  retained.cleared = generated;
  retained.cleared_secondary = cleared;
  wave.run(generated, part.pixels(), retained);
  if (has_geometry()) limit(tile, part);
}

void ReconstructProgram::trace_others(Tile& tile, const Part& part, Node cleared) const {
  Wavefront& wave = tile.wave;
  const std::uint32_t items = kOtherSamples * part.pixels();
  tile.buffer.hold_wave(items);
  GenerateVisibleRays::Ports<float> ports;
  bind(ports, tile, part);
  ports.apart = static_cast<float>(positions());
  const Node generated = wave.launch<GenerateVisibleRays>(ports, items);
  place(tile, items);
  wave.adds_records(generated);
  Wavefront::RetainedRecords retained;
  retained.visible = records(false);
  retained.cleared = generated;
  retained.cleared_secondary = cleared;
  wave.run(generated, items, retained);
}

void ReconstructProgram::limit(Tile& tile, const Part& part) const {
  const auto launch = [&]<std::uint32_t kBranches> {
    typename LimitColours<kBranches>::template Ports<float> ports;
    ports.lattice = tiles_.lattice(part.x, part.y, part.across);
    ports.branch = layer();
    const Node limited = tile.wave.launch<LimitColours<kBranches>>(ports, part.pixels());
    tile.wave.wait_for_colours(limited);
    if (!tile.wave.is_muted()) tile.wave.colours_are_in(limited);
  };
  with_branches(launch);
}

}  // namespace kernels
