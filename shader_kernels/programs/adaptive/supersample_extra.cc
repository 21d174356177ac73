#include <algorithm>
#include <numeric>

#include "shader_kernels/programs/adaptive/supersample.h"
#include "sim/hash.h"

namespace kernels {

/// Returns the launch that completes the tile's pixels.
SupersampleProgram::Node SupersampleProgram::sample_active(Tile& tile, Node tested, Node weighed) const {
  std::vector<Chunk> chunks;
  const Node packed = pack(tile, tested, chunks);
  Node summed = weighed;
  std::uint32_t subpixels = 0;
  const bool is_spilt = supersample_.packing == Packing::kAtomic;
  for (const Chunk& chunk : chunks) {
    const std::uint32_t first_sample = centres() + (is_spilt ? kExtra * chunk.first : 0);
    trace_extra(tile, chunk, first_sample, packed);
    if (supersample_.propagate != 0) settle(tile, chunk, first_sample, 0);
    is_spilt ? spill_chunk(tile, chunk) : void(summed = sum_up(tile, chunk, weighed));
    tile.out.sampling.padding += chunk.padding;
    subpixels += chunk.subpixels;
  }
  tile.out.sampling.traced += kExtra * std::uint64_t{subpixels};
  if (is_spilt && subpixels != 0) summed = sum_from_memory(tile, subpixels, weighed);
  return summed;
}

SupersampleProgram::Node SupersampleProgram::pack(Tile& tile, Node tested, std::vector<Chunk>& chunks) const {
  switch (supersample_.packing) {
    case Packing::kBlock:
      return pack_by_block(tile, tested, chunks);
    case Packing::kAtomic:
      return pack_by_atomics(tile, tested, chunks);
    case Packing::kNone:
      break;
  }
  take_all(tile, chunks);
  return tested;
}

SupersampleProgram::Node SupersampleProgram::pack_by_block(Tile& tile, Node tested, std::vector<Chunk>& chunks) const {
  TileBuffer& buffer = tile.buffer;
  const std::uint32_t across = (tile.out.width + kBlockWidth - 1) / kBlockWidth;
  const std::uint32_t down = (tile.out.height + kBlockHeight - 1) / kBlockHeight;
  PackSubpixels::Ports<float> ports;
  ports.across = static_cast<float>(across);
  ports.inverse_across = 1.0F / ports.across;
  ports.width = static_cast<float>(tile.out.width);
  ports.height = static_cast<float>(tile.out.height);
  ports.verdicts.bind(buffer.subpixels.data());
  const Node node = tile.wave.launch<PackSubpixels>(ports, across * down * kBlockWidth * kBlockHeight);
  tile.wave.wait_all(node, tested);

  const auto length = static_cast<std::uint32_t>(ports.list_end.value);
  for (std::uint32_t first = 0, masters = 0; first < length; first += kChunk) {
    const std::uint32_t fill = buffer.fills[first / kChunk];
    const std::uint32_t taken = fill & ((1U << PackSubpixels::kFillBits) - 1);
    const std::uint32_t masters_end = fill >> PackSubpixels::kFillBits;
    const std::uint32_t padding = first + kChunk < length ? kChunk - taken : 0;
    chunks.push_back({first, taken, padding, masters, masters_end - masters});
    masters = masters_end;
  }
  return node;
}

SupersampleProgram::Node SupersampleProgram::pack_by_atomics(Tile& tile, Node tested,
                                                             std::vector<Chunk>& chunks) const {
  TileBuffer& buffer = tile.buffer;
  const std::uint32_t subpixels = 4 * tile.pixels;
  // Near the golden section of all, so that neighbours in the list are far apart in the picture.
  std::uint32_t stride = static_cast<std::uint32_t>(std::uint64_t{subpixels} * 618 / 1000) | 1U;
  while (std::gcd(stride, subpixels) != 1) stride += 2;
  buffer.fills[0] = 0;
  PackSubpixelsAtomic::Ports<float> ports;
  ports.verdicts.bind(buffer.subpixels.data());
  ports.length.bind(buffer.fills.data());
  ports.subpixel.value = static_cast<float>(sim::hash(frame_, tile.at.index) % subpixels);
  ports.stride = static_cast<float>(stride % subpixels);
  ports.subpixels = static_cast<float>(subpixels);
  const Node node = tile.wave.launch<PackSubpixelsAtomic>(ports, subpixels);
  tile.wave.wait_all(node, tested);
  for (std::uint32_t first = 0; first < buffer.fills[0]; first += kChunk) {
    chunks.push_back({first, std::min(kChunk, buffer.fills[0] - first), 0, 0, 0});
  }
  return node;
}

/// Takes all sub-pixels, which the machine does not list: each item of a chunk looks for itself whether there is
/// something to do.
void SupersampleProgram::take_all(Tile& tile, std::vector<Chunk>& chunks) const {
  TileBuffer& buffer = tile.buffer;
  constexpr std::uint32_t kChunkPixels = kChunk / 4;
  std::uint32_t masters = 0;
  for (std::uint32_t pixel = 0; pixel < tile.pixels; pixel += kChunkPixels) {
    const std::uint32_t end = std::min(pixel + kChunkPixels, tile.pixels);
    const std::uint32_t first = pixel * 4;
    Chunk chunk{first, 0, 0, masters, 0};
    for (std::uint32_t subpixel = first; subpixel < 4 * end; ++subpixel) {
      std::uint32_t& verdict = buffer.subpixels[subpixel];
      if (active_bit<float>(verdict) == 0) continue;
      const std::uint32_t index = first + chunk.subpixels++;
      verdict |= index << kIndexShift;
      buffer.active[index] = subpixel;
      if (chunk.masters == 0 || buffer.masters[masters - 1] != subpixel / 4) {
        buffer.masters[masters++] = subpixel / 4;
        ++chunk.masters;
      }
    }
    chunk.padding = 4 * end - first - chunk.subpixels;
    chunks.push_back(chunk);
  }
}

/// Takes the samples of a chunk's sub-pixels, whose colours lie from `first_sample` on.
void SupersampleProgram::trace_extra(Tile& tile, const Chunk& chunk, std::uint32_t first_sample, Node after) const {
  Wavefront& wave = tile.wave;
  TileBuffer& buffer = tile.buffer;
  const std::uint32_t items = kExtra * chunk.subpixels;
  const std::uint32_t padding = kExtra * chunk.padding;
  buffer.hold_wave(items);
  wave.set_cone(cone_uniforms(camera_, kWholeGrid));
  GenerateExtraRays::Ports<float> generate;
  generate.active.bind(buffer.active.data() + chunk.first);
  generate.camera = camera_;
  generate.x0 = static_cast<float>(tile.out.x);
  generate.y0 = static_cast<float>(tile.out.y);
  generate.width = tile.finished.width;
  generate.inverse_width = tile.finished.inverse_width;
  generate.first_sample = static_cast<float>(first_sample);
  generate.image_width = config_.width;
  generate.seed = jitter_seed(frame_);
  const Node generated = wave.launch<GenerateExtraRays>(generate, items, items + padding, padding);
  wave.wait_all(generated, after);
  wave.wait_for_colours(generated);  // the slots are free
  for (std::uint32_t i = 0; wave.counts_pixels() && i < items; ++i) {
    const std::uint32_t pixel = buffer.active[chunk.first + i / kExtra] / 4;
    wave.place_ray(i, tile.out.x + pixel % tile.out.width, tile.out.y + pixel / tile.out.width);
  }
  if (items != 0) wave.run(generated, items, {}, items + padding, padding);
}

/// Has the samples of a chunk wait in memory.
void SupersampleProgram::spill_chunk(Tile& tile, const Chunk& chunk) const {
  Wavefront& wave = tile.wave;
  const std::uint32_t items = kExtra * chunk.subpixels;
  const std::uint64_t offset =
      store_bytes() * (tile.at.index + 1) -
      (std::uint64_t{tile_pixels()} * kWhole - std::uint64_t{kExtra} * chunk.first) * sizeof(ColourRecord<float>);
  const Node out = wave.transfer(traces::Region::kSamples, true, offset, items * sizeof(ColourRecord<float>));
  wave.wait_for_colours(out);
  wave.colours_are_in(out);
}

SupersampleProgram::Node SupersampleProgram::sum_up(Tile& tile, const Chunk& chunk, Node weighed) const {
  const bool is_listed = supersample_.packing == Packing::kBlock;
  const std::uint32_t idle = is_listed ? 0 : (chunk.subpixels + chunk.padding) / 4 - chunk.masters;
  return sum(tile, tile.buffer.masters.data() + chunk.first_master, chunk.masters, idle, chunk.first, weighed);
}

SupersampleProgram::Node SupersampleProgram::sum_from_memory(Tile& tile, std::uint32_t subpixels, Node weighed) const {
  const std::uint64_t offset =
      store_bytes() * (tile.at.index + 1) - std::uint64_t{tile_pixels()} * kWhole * sizeof(ColourRecord<float>);
  const auto bytes = static_cast<std::uint32_t>(kExtra * subpixels * sizeof(ColourRecord<float>));
  const Node in = tile.wave.transfer(traces::Region::kSamples, false, offset, bytes);
  tile.wave.wait_for_colours(in);
  tile.wave.colours_are_in(in);
  ListSamples::Ports<float> list;
  list.samples.bind(tile.buffer.masters.data());
  list.lattice = {.first = 0,
                  .across = static_cast<float>(tile.pixels),
                  .inverse_across = 1.0F / static_cast<float>(tile.pixels),
                  .step = 1,
                  .row_step = 0};
  const Node listed = tile.wave.launch<ListSamples>(list, tile.pixels);
  tile.wave.adds_colours(listed);
  return sum(tile, tile.buffer.masters.data(), tile.pixels, 0, 0, weighed);
}

/// Completes listed pixels. The active sub-pixel at `first_index` has the first of the samples' colours.
SupersampleProgram::Node SupersampleProgram::sum(Tile& tile, std::uint32_t* listed, std::uint32_t pixels,
                                                 std::uint32_t padding, std::uint32_t first_index, Node weighed) const {
  SumSubpixels::Ports<float> ports;
  ports.listed.bind(listed);
  ports.verdicts.bind(tile.buffer.subpixels.data());
  ports.first_sample = static_cast<float>(centres()) - static_cast<float>(kExtra * first_index);
  const Node node = tile.wave.launch<SumSubpixels>(ports, kWhole * pixels, 0, kWhole * padding);
  tile.wave.wait_all(node, weighed);
  tile.wave.wait_for_colours(node);
  tile.wave.colours_are_in(node);
  return node;
}

}  // namespace kernels
