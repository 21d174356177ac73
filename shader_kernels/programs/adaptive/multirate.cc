#include "shader_kernels/programs/adaptive/multirate.h"

namespace kernels {

namespace {

/// Whether secondary hits are checked. Fusion leaves out checks that nothing in the scene can fail.
bool checks_secondary(const MultirateConfig& multirate, const SceneTables& scene) {
  return multirate.secondary_checks && (!scene.fuses || (scene.has_secondary && scene.depth > 1));
}

/// A distance that no two colours have.
constexpr double kNotCompared = 2;

std::uint32_t record_bytes(bool has_secondary) {
  return sizeof(GeometryRecord<float>) + (has_secondary ? sizeof(SecondaryRecord<float>) : 0);
}

}  // namespace

MultirateProgram::MultirateProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                   const RenderConfig& config, const MultirateConfig& multirate, std::uint32_t grid,
                                   const RateMap& rates, std::uint32_t frame)
    : BlockProgram(image, camera, config, multirate,
                   {.grid = grid,
                    .block = multirate.block,
                    .whole = multirate.rate_control == RateControl::kOff ? multirate.block : RateMap::kCoarse,
                    .record_bytes = record_bytes(checks_secondary(multirate, {image, config}))},
                   frame),
      multirate_(multirate),
      secondary_checks_(checks_secondary(multirate, scene())),
      compares_colours_(multirate.texture < kNotCompared ||
                        (multirate.rate_control != RateControl::kOff && multirate.rate_texture < kNotCompared)),
      rates_(rates) {}

Wavefront::RetainedRecords MultirateProgram::records_to_retain(bool is_last) const {
  Wavefront::RetainedRecords retained;
  retained.geometry = !is_last;
  retained.secondary = !is_last && secondary_checks_;
  return retained;
}

BlockProgram::Verdict MultirateProgram::check(Tile& tile, bool along_y, const LineUniforms<float>& line,
                                              std::uint32_t items) const {
  return compares_colours_ ? check_colours<true>(tile, along_y, line, items)
                           : check_colours<false>(tile, along_y, line, items);
}

template <bool kTexture>
BlockProgram::Verdict MultirateProgram::check_colours(Tile& tile, bool along_y, const LineUniforms<float>& line,
                                                      std::uint32_t items) const {
  if (secondary_checks_) {
    return along_y ? check_with<true, true, kTexture>(tile, line, items)
                   : check_with<false, true, kTexture>(tile, line, items);
  }
  return along_y ? check_with<true, false, kTexture>(tile, line, items)
                 : check_with<false, false, kTexture>(tile, line, items);
}

template <bool kAlongY, bool kSecondary, bool kTexture>
BlockProgram::Verdict MultirateProgram::check_with(Tile& tile, const LineUniforms<float>& line,
                                                   std::uint32_t items) const {
  using Similarity = CheckSimilarity<kAlongY, kSecondary, kTexture>;
  typename Similarity::template Ports<float> ports;
  ports.line = line;
  ports.least_dot = static_cast<float>(multirate_.normal);
  ports.texture_squared = static_cast<float>(multirate_.texture * multirate_.texture);
  ports.rate_squared = static_cast<float>(multirate_.rate_texture * multirate_.rate_texture);
  Wavefront::Node node = Wavefront::kNone;
  if (tile.wave.fuses()) {
    using Interpolate = InterpolateSample<kAlongY, kSecondary && !kAlongY>;
    using Both = CheckInterpolate<kAlongY, kSecondary, kTexture>;
    typename Both::template Ports<float> fused;
    ports_of<Similarity>(fused) = ports;
    ports_of<Interpolate>(fused).line = line;
    node = tile.wave.launch<Both>(fused, items);
    tile.wave.wait_for_colours(node);
    ports = ports_of<Similarity>(fused);
  } else {
    node = tile.wave.launch<Similarity>(ports, items);
    if (kTexture) tile.wave.wait_for_colours(node);
  }
  return {node, ports.passed_count.value, ports.failed_count.value, ports.rough_count.value};
}

void MultirateProgram::interpolate(Tile& tile, bool along_y, const LineUniforms<float>& line,
                                   const Verdict& verdict) const {
  if (tile.wave.fuses()) {  // the check has made them
    tile.wave.adds_colours(verdict.node);
    tile.wave.adds_records(verdict.node);
    return;
  }
  if (along_y) return interpolate_with<InterpolateSample<true, false>>(tile, line, verdict);
  if (secondary_checks_) return interpolate_with<InterpolateSample<false, true>>(tile, line, verdict);
  interpolate_with<InterpolateSample<false, false>>(tile, line, verdict);
}

template <class K>
void MultirateProgram::interpolate_with(Tile& tile, const LineUniforms<float>& line, const Verdict& verdict) const {
  typename K::template Ports<float> ports;
  ports.line = line;
  const Wavefront::Node node = tile.wave.launch<K>(ports, verdict.passed, verdict.passed + verdict.failed);
  tile.wave.wait_all(node, verdict.node);
  tile.wave.wait_for_colours(node);
  tile.wave.adds_colours(node);
  tile.wave.adds_records(node);
}

}  // namespace kernels
