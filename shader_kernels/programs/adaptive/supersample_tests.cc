#include <algorithm>
#include <bit>

#include "shader_kernels/programs/adaptive/supersample.h"

namespace kernels {

/// Samples at pixels' centres; `x`, `y` are the first one's position in the tile buffer.
void SupersampleProgram::trace_centres(Tile& tile, std::uint32_t x, std::uint32_t y, std::uint32_t across,
                                       std::uint32_t down, bool is_own) const {
  Wavefront& wave = tile.wave;
  TileBuffer& buffer = tile.buffer;
  const std::uint32_t items = across * down;
  ListSamples::Ports<float> list;
  list.lattice = tiles_.lattice(x, y, across);
  const Node listed = wave.launch<ListSamples>(list, items);

  buffer.hold_wave(items);
  GenerateListedRays::Ports<float> generate;
  generate.camera = camera_;
  generate.grid = {.x0 = static_cast<float>(tile.at.x) - static_cast<float>(tiles_.halo()),
                   .y0 = static_cast<float>(tile.at.y) - static_cast<float>(tiles_.halo()),
                   .pitch = static_cast<float>(tiles_.pitch()),
                   .inverse_pitch = 1.0F / static_cast<float>(tiles_.pitch()),
                   .grid = 1,
                   .inverse_grid = 1};
  Wavefront::RetainedRecords retained;
  retained.traits = true;
  const Node generated = wave.generate(generate, buffer.samples, listed, items, retained);
  wave.run(generated, items, retained);
  if (wave.is_muted()) return;
  tile.out.sampling.traced += items;
  if (!is_own) tile.out.sampling.halo += items;
}

/// Thresholds of the attributes; no contrast reaches that of one that is not compared.
std::array<float, kAttributes> SupersampleProgram::thresholds() const {
  const SupersampleConfig& c = supersample_;
  const std::array<double, kAttributes> all{c.colour,           c.object,           c.normal,
                                            c.shadow,           c.texture,          c.secondary_object,
                                            c.secondary_normal, c.secondary_shadow, c.secondary_texture};
  std::array<float, kAttributes> reached{};
  std::ranges::transform(all, reached.begin(), [](double t) { return t < 0 ? kNever : static_cast<float>(t); });
  return reached;
}

/// The sample at a finished pixel's centre.
std::size_t SupersampleProgram::centre_of(const Tile& tile, std::uint32_t pixel) {
  const DivMod<float> row = finished_pixel<float>(static_cast<float>(pixel), tile.finished);
  return static_cast<std::size_t>(centre_sample<float>(row, tile.finished));
}

SupersampleProgram::Node SupersampleProgram::test(Tile& tile) const {
  TestSubpixels::Ports<float> ports;
  ports.finished = tile.finished;
  ports.secondary.bind(tile.buffer.secondary_traits.data());
  ports.verdicts.bind(tile.buffer.subpixels.data());
  ports.thresholds = thresholds();
  ports.compared = 0;
  for (std::size_t i = 0; i < kAttributes; ++i) {
    if (ports.thresholds[i] < kNever) ports.compared |= 1U << i;
  }
  ports.same_normal = static_cast<float>(supersample_.same_normal);
  ports.focus = supersample_.focus ? traces::kFocusObject : 0;
  ports.textured = ports.focus | kTexturedObject;
  const Node node = tile.wave.launch<TestSubpixels>(ports, 4 * tile.pixels);
  tile.wave.wait_for_records(node);
  tile.wave.wait_for_colours(node);
  return node;
}

SupersampleProgram::Node SupersampleProgram::weigh(Tile& tile, Node tested) const {
  return supersample_.filter == SubpixelFilter::kBilinear ? weigh_with<true>(tile, tested)
                                                          : weigh_with<false>(tile, tested);
}

template <bool kBilinear>
SupersampleProgram::Node SupersampleProgram::weigh_with(Tile& tile, Node tested) const {
  typename WeighCentres<kBilinear>::template Ports<float> ports;
  ports.finished = tile.finished;
  ports.verdicts.bind(tile.buffer.subpixels.data());
  const Node node = tile.wave.launch<WeighCentres<kBilinear>>(ports, tile.pixels);
  tile.wave.wait_all(node, tested);
  return node;
}

void SupersampleProgram::count(Tile& tile) const {
  TileResult& out = tile.out;
  Sampling& sampling = out.sampling;
  sampling.wanted = std::uint64_t{kWhole} * tile.pixels;
  sampling.traced_background = out.background.size();
  for (const std::uint32_t sample : out.background) sampling.background += sample >= centres() ? 1 : 0;
  for (std::uint32_t pixel = 0; pixel < tile.pixels; ++pixel) {
    std::uint32_t active = 0, reasons = 0;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t verdict = tile.buffer.subpixels[4 * pixel + i];
      if (active_bit<float>(verdict) == 0) continue;
      active += 1;
      reasons |= verdict & ((1U << kAttributes) - 1);
      for (std::size_t a = 0; a < kAttributes; ++a) sampling.reasons[a] += verdict >> a & 1U;
      sampling.first_reasons[static_cast<std::size_t>(std::countr_zero(verdict))] += 1;
    }
    out.marks[pixel] = static_cast<SampleMark>(reasons | active << kActiveCountShift);
    sampling.active[active] += 1;
    if (tile.buffer.traits[centre_of(tile, pixel)].object == kNoObject) sampling.background += kExtra * (4 - active);
  }
}

}  // namespace kernels
