#include "shader_kernels/programs/adaptive/undersample.h"

#include <glm/common.hpp>

namespace kernels {

namespace {

constexpr std::uint32_t kRecordBytes =
    sizeof(GeometryRecord<float>) + sizeof(SurfaceRecord<float>) + sizeof(ColourRecord<float>);

}  // namespace

UndersampleProgram::UndersampleProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                       const RenderConfig& config, const UndersampleConfig& undersample,
                                       float scene_size, std::uint32_t frame)
    : BlockProgram(image, camera, config, undersample,
                   {.grid = undersample.grid(),
                    .block = undersample.block,
                    .whole = undersample.block,
                    .record_bytes = kRecordBytes},
                   frame),
      undersample_(undersample),
      apart_(static_cast<float>(undersample.position) * scene_size),
      faint_(faint_channel(static_cast<float>(undersample.colour))),
      correction_(undersample, config.width * undersample.grid(), config.height * undersample.grid(),
                  sample_tiles().side()) {}

Wavefront::RetainedRecords UndersampleProgram::records_to_retain(bool is_last) const {
  Wavefront::RetainedRecords retained;
  retained.surfaces = !is_last;
  retained.geometry = is_last && correction_.scans() > 0;
  return retained;
}

void UndersampleProgram::traced(Tile& tile, std::vector<std::uint32_t>& list, std::uint32_t items, std::uint32_t lanes,
                                const Wavefront::RetainedRecords& retained) const {
  if (!retained.surfaces) return;
  const auto launch = [&]<class K>(typename K::template Ports<float>& ports) {
    ports_of<RecordGlobal>(ports).samples.bind(list.data());
    const Wavefront::Node node = tile.wave.launch<K>(ports, items, lanes);
    tile.wave.wait_for_colours(node);
    tile.wave.adds_records(node);
  };
  if (tile.wave.fuses()) {
    RecordCounted::Ports<float> ports;
    ports_of<CountColoured>(ports).samples.bind(list.data());
    ports_of<CountColoured>(ports).faint = faint_;
    launch.operator()<RecordCounted>(ports);
    tile.coloured += ports_of<CountColoured>(ports).coloured_count.value;
  } else {
    RecordGlobal::Ports<float> ports;
    launch.operator()<RecordGlobal>(ports);
  }
}

/// Has the machine count what the neighbour's samples add to the tile's colours. Here they have been counted when they
/// were traced.
void UndersampleProgram::imported(Tile& tile, std::uint32_t samples) const {
  if (!tile.wave.fuses()) return;
  const Wavefront::Node node = tile.wave.note<CountColoured>(samples);
  tile.wave.wait_for_records(node);
  tile.wave.adds_records(node);
}

BlockProgram::Verdict UndersampleProgram::check(Tile& tile, bool along_y, const LineUniforms<float>& line,
                                                std::uint32_t items) const {
  return along_y ? check_along<true>(tile, line, items) : check_along<false>(tile, line, items);
}

/// Leaves out what nothing in the scene, or in the tile, can fail.
template <bool kAlongY>
BlockProgram::Verdict UndersampleProgram::check_along(Tile& tile, const LineUniforms<float>& line,
                                                      std::uint32_t items) const {
  const bool has_textures = !scene().fuses || scene().has_textures;
  const bool has_colours = !scene().fuses || tile.coloured != 0;
  if (has_colours) {
    return has_textures ? check_with<CheckAttributes<kAlongY, true, true>>(tile, line, items)
                        : check_with<CheckAttributes<kAlongY, false, true>>(tile, line, items);
  }
  return has_textures ? check_with<CheckAttributes<kAlongY, true, false>>(tile, line, items)
                      : check_with<CheckAttributes<kAlongY, false, false>>(tile, line, items);
}

template <class K>
BlockProgram::Verdict UndersampleProgram::check_with(Tile& tile, const LineUniforms<float>& line,
                                                     std::uint32_t items) const {
  const auto colour = static_cast<float>(undersample_.colour);
  typename K::template Ports<float> ports;
  ports.line = line;
  ports.apart_squared = apart_ * apart_;
  ports.least_dot = static_cast<float>(undersample_.normal);
  ports.texture = static_cast<float>(undersample_.texture);
  ports.colour_squared = colour * colour;
  const Wavefront::Node node = tile.wave.launch<K>(ports, items);
  return {node, ports.passed_count.value, ports.failed_count.value};
}

void UndersampleProgram::interpolate(Tile& tile, bool along_y, const LineUniforms<float>& line,
                                     const Verdict& verdict) const {
  along_y ? interpolate_with<true>(tile, line, verdict) : interpolate_with<false>(tile, line, verdict);
}

template <bool kAlongY>
void UndersampleProgram::interpolate_with(Tile& tile, const LineUniforms<float>& line, const Verdict& verdict) const {
  TileBuffer& buffer = tile.buffer;
  buffer.hold_wave(verdict.passed);
  using Interpolate = InterpolateAttributes<kAlongY>;
  const std::uint32_t lanes = verdict.passed + verdict.failed;
  if (tile.wave.fuses() && tile.wave.has_lights()) {
    typename InterpolateLit<kAlongY>::template Ports<float> fused;
    ports_of<Interpolate>(fused).line = line;
    tile.wave.interpolate_lit<InterpolateLit<kAlongY>>(fused, verdict.passed, lanes, verdict.node);
    return;
  }
  typename Interpolate::template Ports<float> ports;
  ports.line = line;
  const Wavefront::Node node = tile.wave.launch<Interpolate>(ports, verdict.passed, lanes);
  tile.wave.wait_all(node, verdict.node);
  tile.wave.adds_records(node);
  tile.wave.adds_colours(node);
  tile.wave.shade_interpolated(node, verdict.passed, lanes);
}

void UndersampleProgram::settled(Tile& tile) const {
  if (correction_.scans() == 0 || packs_samples(tile.wave)) return;
  undersample_.correct_shadows ? store_identities<StoreIdentities<true>>(tile)
                               : store_identities<StoreIdentities<false>>(tile);
}

Wavefront::Node UndersampleProgram::pack_samples(Tile& tile) const {
  if (correction_.scans() == 0) return BlockProgram::pack_samples(tile);
  return undersample_.correct_shadows ? store_identities<PackIdentified<true>>(tile)
                                      : store_identities<PackIdentified<false>>(tile);
}

/// Launches K, which writes down what samples show, and moves that to memory.
template <class K>
Wavefront::Node UndersampleProgram::store_identities(Tile& tile) const {
  typename K::template Ports<float> ports;
  if constexpr (requires { ports.lattice; }) {
    ports.lattice = own_samples(tile.at);
  } else {
    ports_of<TakeGridSample>(ports).lattice = own_samples(tile.at);
    ports_of<typename K::Identities>(ports).lattice = own_samples(tile.at);
  }
  const std::uint32_t samples = tile.at.width * tile.at.height;
  const Wavefront::Node node = tile.wave.launch<K>(ports, samples);
  tile.wave.wait_for_records(node);
  const Wavefront::Node out =
      tile.wave.transfer(traces::Region::kSamples, true, scan_store(tile.at.index), samples * scanned_bytes());
  tile.wave.wait_all(out, node);
  tile.wave.wait_for_colours(out);
  tile.out.shown.clear();
  for (std::uint32_t i = 0; i < samples; ++i) {
    const std::uint32_t sample = (i / tile.at.width + 1) * pitch() + i % tile.at.width + 1;
    tile.out.shown.push_back({tile.buffer.identities[i], tile.out.colour(sample)});
  }
  return node;
}

}  // namespace kernels
