#include "shader_kernels/programs/adaptive/multirate.h"

namespace kernels {

namespace {

std::uint32_t record_bytes(const MultirateConfig& config) {
  return sizeof(GeometryRecord<float>) + (config.secondary_checks ? sizeof(SecondaryRecord<float>) : 0);
}

}  // namespace

MultirateProgram::MultirateProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                   const RenderConfig& config, const MultirateConfig& multirate, std::uint32_t grid,
                                   const RateMap& rates, std::uint32_t frame)
    : BlockProgram(image, camera, config, multirate,
                   {.grid = grid,
                    .block = multirate.block,
                    .whole = multirate.rate_control == RateControl::kOff ? multirate.block : RateMap::kCoarse,
                    .record_bytes = record_bytes(multirate)},
                   frame),
      multirate_(multirate),
      rates_(rates) {}

Wavefront::RetainedRecords MultirateProgram::records_to_retain(bool is_last) const {
  Wavefront::RetainedRecords retained;
  retained.geometry = !is_last;
  retained.secondary = !is_last && multirate_.secondary_checks;
  return retained;
}

Wavefront::RetainedRecords MultirateProgram::clear(Tile& tile, std::vector<std::uint32_t>& list, Wavefront::Node lister,
                                                   std::uint32_t items, std::uint32_t lanes,
                                                   const Wavefront::RetainedRecords& retained) const {
  Wavefront::RetainedRecords cleared = retained;
  if (retained.geometry) {
    ClearGeometry::Ports<float> ports;
    ports.samples.bind(list.data());
    cleared.cleared = tile.wave.launch<ClearGeometry>(ports, items, lanes);
    tile.wave.wait_all(cleared.cleared, lister);
    tile.wave.adds_records(cleared.cleared);
  }
  if (retained.secondary) {
    ClearSecondary::Ports<float> ports;
    ports.samples.bind(list.data());
    cleared.cleared_secondary = tile.wave.launch<ClearSecondary>(ports, items, lanes);
    tile.wave.wait_all(cleared.cleared_secondary, lister);
    tile.wave.adds_records(cleared.cleared_secondary);
  }
  return cleared;
}

BlockProgram::Verdict MultirateProgram::check(Tile& tile, bool along_y, const LineUniforms<float>& line,
                                              std::uint32_t items) const {
  if (multirate_.secondary_checks) {
    return along_y ? check_with<CheckSimilarity<true, true>>(tile, line, items)
                   : check_with<CheckSimilarity<false, true>>(tile, line, items);
  }
  return along_y ? check_with<CheckSimilarity<true, false>>(tile, line, items)
                 : check_with<CheckSimilarity<false, false>>(tile, line, items);
}

template <class K>
BlockProgram::Verdict MultirateProgram::check_with(Tile& tile, const LineUniforms<float>& line,
                                                   std::uint32_t items) const {
  typename K::template Ports<float> ports;
  ports.line = line;
  ports.least_dot = static_cast<float>(multirate_.normal);
  const Wavefront::Node node = tile.wave.launch<K>(ports, items);
  return {node, ports.passed_count.value, ports.failed_count.value};
}

void MultirateProgram::interpolate(Tile& tile, bool along_y, const LineUniforms<float>& line,
                                   const Verdict& verdict) const {
  if (along_y) return interpolate_with<InterpolateSample<true, false>>(tile, line, verdict);
  if (multirate_.secondary_checks) return interpolate_with<InterpolateSample<false, true>>(tile, line, verdict);
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
