#include <algorithm>
#include <bit>

#include "shader_kernels/programs/adaptive/block_program.h"

namespace kernels {

namespace {

float inverse_or_one(std::uint32_t n) { return 1.0F / static_cast<float>(std::max(n, 1U)); }

LineUniforms<float> line_uniforms(std::uint32_t inner, std::uint32_t block) {
  LineUniforms<float> line{};
  line.inner = static_cast<float>(inner);
  line.inverse_inner = inverse_or_one(inner);
  line.gaps = static_cast<float>(block - 1);
  line.inverse_gaps = inverse_or_one(block - 1);
  line.block = static_cast<float>(block);
  line.inverse_block = inverse_or_one(block);
  return line;
}

}  // namespace

GridUniforms<float> BlockProgram::grid_uniforms(float x0, float y0, std::uint32_t pitch) const {
  return {.x0 = x0,
          .y0 = y0,
          .pitch = static_cast<float>(pitch),
          .inverse_pitch = inverse_or_one(pitch),
          .grid = static_cast<float>(setup_.grid),
          .inverse_grid = inverse_or_one(setup_.grid)};
}

/// Traces `across` samples to a row, from sample `first` on.
void BlockProgram::trace_lattice(Tile& tile, std::uint32_t first, std::uint32_t across, std::uint32_t step,
                                 std::uint32_t row_step, std::uint32_t items, bool is_own) const {
  if (items == 0) return;
  ListSamples::Ports<float> ports;
  ports.lattice = {.first = static_cast<float>(first),
                   .across = static_cast<float>(across),
                   .inverse_across = inverse_or_one(across),
                   .step = static_cast<float>(step),
                   .row_step = static_cast<float>(row_step)};
  const Wavefront::Node listed = tile.wave.launch<ListSamples>(ports, items);
  tile.wave.wait_all(listed, tile.start);
  trace_listed(tile, tile.buffer.samples, listed, items, false, is_own, items);
  if (!is_own) return;
  for (std::uint32_t i = 0; i < items; ++i) {
    const std::uint32_t sample = tile.buffer.samples[i];
    const std::size_t own = std::size_t{sample / pitch() - 1} * tile.at.width + sample % pitch() - 1;
    tile.out.marks[own] = kTracedMark | kReferenceMark;
  }
}

void BlockProgram::trace_listed(Tile& tile, std::vector<std::uint32_t>& list, Wavefront::Node lister,
                                std::uint32_t items, bool is_last, bool is_own, std::uint32_t lanes) const {
  if (items == 0) return;
  Wavefront& wave = tile.wave;
  tile.buffer.hold_wave(items);
  GenerateListedRays::Ports<float> generate;
  generate.camera = camera_;
  generate.grid = grid_uniforms(static_cast<float>(tile.at.x) - 1.0F, static_cast<float>(tile.at.y) - 1.0F, pitch());
  Wavefront::RetainedRecords retained = records_to_retain(is_last);
  const Wavefront::Node generated = wave.generate(generate, list, lister, items, retained, lanes);
  wave.run(generated, items, retained, lanes);
  traced(tile, list, items, lanes, retained);
  if (wave.is_muted()) return;
  tile.out.sampling.traced += items;
  if (!is_own) tile.out.sampling.halo += items;
}

/// Checks the samples of lines, interpolates those that pass and traces the others.
void BlockProgram::resolve(Tile& tile, bool along_y, const LineUniforms<float>& line, std::uint32_t items,
                           bool is_own) const {
  if (items == 0) return;
  const Verdict verdict = check(tile, along_y, line, items);
  tile.wave.wait_for_records(verdict.node);
  if (is_own) mark(tile, verdict, line);
  if (verdict.passed != 0) interpolate(tile, along_y, line, verdict);
  trace_listed(tile, tile.buffer.failed, verdict.node, verdict.failed, along_y, is_own, items);
  if (is_own && along_y && carries_rates()) {
    const Wavefront::Node kept = tile.wave.transfer(traces::Region::kRates, true, tile.at.index, 1);
    tile.wave.wait_all(kept, verdict.node);
  }
}

LineUniforms<float> BlockProgram::line_along_x(const Tile& tile, std::uint32_t block, bool is_halo) const {
  LineUniforms<float> line = line_uniforms(tile.at.width - tile.at.width / block, block);
  line.first = is_halo ? 0.0F : static_cast<float>(block * pitch());
  line.step = 1;
  line.line_step = static_cast<float>(block * pitch());
  line.low = tile.at.has_left ? 0.0F : 1.0F;
  line.high = static_cast<float>(tile.at.width);
  return line;
}

LineUniforms<float> BlockProgram::line_along_y(const Tile& tile) const {
  LineUniforms<float> line = line_uniforms(tile.at.width, tile.block);
  line.first = 1;
  line.step = static_cast<float>(pitch());
  line.line_step = 1;
  line.low = tile.at.has_above ? 0.0F : 1.0F;
  line.high = static_cast<float>(tile.at.height);
  return line;
}

/// Notes what the checks said, for pictures and counts.
void BlockProgram::mark(Tile& tile, const Verdict& verdict, const LineUniforms<float>& line) const {
  const auto own = [&](std::uint32_t sample) -> SampleMark& {
    return tile.out.marks[std::size_t{sample / pitch() - 1} * tile.at.width + sample % pitch() - 1];
  };
  Sampling& sampling = tile.out.sampling;
  const auto step = static_cast<std::uint32_t>(line.step);
  std::uint32_t unchecked = 0;
  for (std::uint32_t i = 0; i < verdict.passed; ++i) {
    const std::uint32_t word = tile.buffer.passed[i];
    const std::uint32_t sample = word & kSampleMask;
    const std::uint32_t before = sample - ((word >> kGapShift) + 1) * step;
    if (tile.buffer.geometry[before].object == kNoObject) sampling.background += 1;
    own(sample) = 0;
  }
  for (std::uint32_t i = 0; i < verdict.failed; ++i) {
    const std::uint32_t sample = tile.buffer.failed[i];
    const std::uint32_t failed = tile.buffer.verdicts[sample];
    if (failed == bit(Check::kBorder)) unchecked += 1;
    own(sample) = static_cast<SampleMark>(failed | kTracedMark);
    for (std::size_t check = 0; check < sampling.failed.size(); ++check) sampling.failed[check] += failed >> check & 1U;
    sampling.first_failed[static_cast<std::size_t>(std::countr_zero(failed))] += 1;
  }
  sampling.checked += verdict.passed + verdict.failed - unchecked;
  sampling.passed += verdict.passed;
  sampling.rough += verdict.rough;
}

LatticeUniforms<float> BlockProgram::own_samples(const SampleTile& at) const {
  return {.first = static_cast<float>(pitch() + 1),
          .across = static_cast<float>(at.width),
          .inverse_across = inverse_or_one(at.width),
          .step = 1,
          .row_step = static_cast<float>(pitch())};
}

Wavefront::Node BlockProgram::pack_samples(Tile& tile) const {
  PackGridSample::Ports<float> ports;
  ports.lattice = own_samples(tile.at);
  return tile.wave.launch<PackGridSample>(ports, tile.at.width * tile.at.height);
}

void BlockProgram::average(Tile& tile) const {
  Wavefront& wave = tile.wave;
  TileResult& out = tile.out;
  const std::uint32_t per_pixel = setup_.grid * setup_.grid;
  const std::uint64_t offset = requirements().region_bytes[0] / tiles_.count() * tile.at.index;
  if (packs_samples(wave)) {
    const Wavefront::Node packed = pack_samples(tile);
    wave.wait_for_colours(packed);
    wave.put_packed(packed, offset);
    return;
  }
  AverageSamples::Ports<float> ports;
  ports.samples = static_cast<float>(per_pixel);
  ports.inverse_samples = inverse_or_one(per_pixel);
  ports.width = static_cast<float>(out.width);
  ports.inverse_width = inverse_or_one(out.width);
  ports.grid = static_cast<float>(setup_.grid);
  ports.inverse_grid = inverse_or_one(setup_.grid);
  ports.first = static_cast<float>(pitch() + 1);
  ports.pitch = static_cast<float>(pitch());
  const Wavefront::Node averaged = wave.launch<AverageSamples>(ports, out.width * out.height * per_pixel);
  wave.wait_for_colours(averaged);
  wave.put_out(averaged, offset);
}

void BlockProgram::count(Tile& tile) const {
  Sampling& sampling = tile.out.sampling;
  sampling.wanted = std::uint64_t{tile.at.width} * tile.at.height;
  sampling.traced_background = tile.out.background.size();
  for (const std::uint32_t sample : tile.out.background) {
    if (sample % pitch() != 0 && sample / pitch() != 0) sampling.background += 1;
  }
}

}  // namespace kernels
