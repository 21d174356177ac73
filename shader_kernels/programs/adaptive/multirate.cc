#include "shader_kernels/programs/adaptive/multirate.h"

namespace kernels {

namespace {

/// True if similarity checks compare secondary hits. With fused kernels, they do not if the scene emits no secondary
/// rays, because all samples would pass.
bool has_secondary_checks(const MultirateConfig& multirate, const SceneTables& scene) {
  return multirate.secondary_checks && (!scene.fuses || (scene.has_secondary && scene.depth > 1));
}

/// A distance that no two colours reach: they are at most sqrt(3) apart.
constexpr double kNotCompared = 2;

BlockSetup block_setup(const MultirateConfig& multirate, std::uint32_t samples_per_side, bool has_secondary) {
  const bool carries_rates = multirate.rate_control != RateControl::kOff;
  BlockSetup setup{.grid = samples_per_side,
                   .block = multirate.block,
                   .whole = carries_rates ? RateMap::kCoarse : multirate.block,
                   .record_bytes = sizeof(GeometryRecord<float>),
                   .carries_rates = carries_rates};
  if (has_secondary) setup.record_bytes += sizeof(SecondaryRecord<float>);
  setup.before_check_y.geometry = true;
  setup.before_check_y.secondary = has_secondary;
  return setup;
}

}  // namespace

MultirateProgram::MultirateProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                   const RenderConfig& config, const MultirateConfig& multirate,
                                   std::uint32_t samples_per_side, const RateMap& rates, std::uint32_t frame)
    : FrameProgram(config.width, config.height),
      multirate_(multirate),
      blocks_(image, camera, config, multirate,
              block_setup(multirate, samples_per_side, has_secondary_checks(multirate, {image, config})), frame),
      secondary_checks_(blocks_.setup.before_check_y.secondary),
      compares_colours_(multirate.texture < kNotCompared ||
                        (multirate.rate_control != RateControl::kOff && multirate.rate_texture < kNotCompared)),
      rates_(rates) {
  blocks_.allocate_counts(mutable_sampling());
}

void MultirateProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                TileResult& out) const {
  BlockTile tile(blocks_, tile_index, tracer, record, out, [this](std::uint32_t t) { return rates_.block_side(t); });
  const auto resolve = [&](const BlockLines& lines) {
    if (lines.samples == 0) return;
    const Verdict verdict = check_and_interpolate(tile, lines);
    tile.trace_failed_samples(lines, verdict);
  };

  // 1. Trace the reference sample of each block. Export borders before importing halos, which keeps chains of waiting
  // tiles short.
  tile.trace_references();
  tile.export_right_border();
  tile.import_left_halo();
  tile.spill_references_to_dram();
  // 2. Check the samples between two references of a row. Interpolate similar ones, trace the others.
  resolve(tile.lines_along_x());
  tile.export_lower_border();
  tile.import_upper_halo(resolve);
  tile.spill_reference_rows_to_dram();
  // 3. Check the samples of all other rows, between samples above and below.
  resolve(tile.lines_along_y());
  tile.average_pixels();
  tile.finish();
}

Verdict MultirateProgram::check_and_interpolate(BlockTile& tile, const BlockLines& lines) const {
  const auto along = [&]<bool kSecondary, bool kTexture> {
    return lines.along_y ? check_and_interpolate<true, kSecondary, kTexture>(tile, lines)
                         : check_and_interpolate<false, kSecondary, kTexture>(tile, lines);
  };
  if (secondary_checks_) {
    return compares_colours_ ? along.template operator()<true, true>() : along.template operator()<true, false>();
  }
  return compares_colours_ ? along.template operator()<false, true>() : along.template operator()<false, false>();
}

template <bool kAlongY, bool kSecondary, bool kTexture>
Verdict MultirateProgram::check_and_interpolate(BlockTile& tile, const BlockLines& lines) const {
  TileGraph& graph = tile.graph;
  using Similarity = CheckSimilarity<kAlongY, kSecondary, kTexture>;
  using Interpolate = InterpolateSample<kAlongY, kSecondary && !kAlongY>;
  using CheckThenInterpolate = CheckInterpolate<kAlongY, kSecondary, kTexture>;

  typename Similarity::template Ports<float> check;
  check.line = lines.uniforms;
  check.least_dot = static_cast<float>(multirate_.normal);
  check.texture_squared = static_cast<float>(multirate_.texture * multirate_.texture);
  check.rate_squared = static_cast<float>(multirate_.rate_texture * multirate_.rate_texture);
  typename Interpolate::template Ports<float> interpolate;
  interpolate.line = lines.uniforms;

  // With fusion, one kernel interpolates every sample that it checks. Tracing the failed ones later overwrites them.
  if (blocks_.scene.fuses) {
    typename CheckThenInterpolate::template Ports<float> both;
    ports_of<Similarity>(both) = check;
    ports_of<Interpolate>(both) = interpolate;
    const Wavefront::Node node = graph.launch<CheckThenInterpolate>(both, lines.samples);
    graph.wait_for_colour_writers(node);
    graph.wait_for_record_writers(node);
    check = ports_of<Similarity>(both);
    if (check.passed_count.value != 0) {
      graph.register_colour_writer(node);
      graph.register_record_writer(node);
    }
    return {node, check.passed_count.value, check.failed_count.value, check.rough_count.value};
  }

  const Wavefront::Node checked = graph.launch<Similarity>(check, lines.samples);
  if (kTexture) graph.wait_for_colour_writers(checked);
  graph.wait_for_record_writers(checked);
  const std::uint32_t passed = check.passed_count.value, failed = check.failed_count.value;
  if (passed != 0) {
    const Wavefront::Node made = graph.launch<Interpolate>(interpolate, passed, passed + failed);
    graph.wait_for_all(made, checked);
    graph.wait_for_colour_writers(made);
    graph.register_colour_writer(made);
    graph.register_record_writer(made);
  }
  return {checked, passed, failed, check.rough_count.value};
}

void MultirateProgram::commit_tile(const TileResult& tile) {
  FrameProgram::commit_tile(tile);
  blocks_.count_tile(tile, rates_.block_side(tile.tile), mutable_sampling());
}

}  // namespace kernels
