#include "shader_kernels/programs/wavefront/tile_result.h"

#include <algorithm>

#include <glm/common.hpp>

#include "shader_kernels/kernels/subpixels.h"

namespace kernels {
namespace {

void grow_to(auto& array, std::size_t size) {
  if (array.size() < size) array.resize(size);
}

template <class Item>
void grow_to(Queue<Item>& queue, std::size_t items) {
  grow_to(queue.entries, items + 1);
}

}  // namespace

void RaySlots::reserve_slots(std::size_t slots) {
  grow_to(rays, slots);
  grow_to(paths, slots);
  grow_to(hits, slots);
}

void StageQueues::clear_surfaces() {
  for (SlotQueue* queue : {&textured, &diffuse, &mirror, &glass, &emissive, &deferred, &absorbing, &vertexed, &based,
                           &physical, &bumped, &blended, &glowing, &occluded, &rough}) {
    queue->items = 0;
  }
}

void TileBuffer::reserve_wave(std::size_t slots) {
  rays.wave.reserve_slots(slots);
  StageQueues& q = queues;
  for (SlotQueue* queue :
       {&q.misses, &q.surfaces, &q.textured, &q.diffuse, &q.deferred, &q.mirror, &q.glass, &q.emissive}) {
    grow_to(*queue, slots);
  }
  grow_to(surfaces.points, slots);
  grow_to(surfaces.mattes, slots);
  grow_to(surfaces.texcoords, slots);
  grow_to(surfaces.optics, slots);
}

void TileBuffer::reserve_details(std::size_t slots) {
  StageQueues& q = queues;
  for (SlotQueue* queue :
       {&q.absorbing, &q.vertexed, &q.based, &q.physical, &q.bumped, &q.blended, &q.glowing, &q.occluded}) {
    grow_to(*queue, slots);
  }
  grow_to(surfaces.tangents, slots);
}

void TileBuffer::reserve_layers(std::size_t slots) {
  grow_to(queues.layers, slots);
  grow_to(queues.targets, slots);
  rays.layer.reserve_slots(slots + 1);
}

void TileBuffer::reserve_paths(std::size_t slots) {
  grow_to(queues.blended, slots);
  grow_to(queues.rough, slots);
  grow_to(samples.seeds, slots);
}

void TileBuffer::reserve_samples(std::size_t sample_count) {
  grow_to(samples.colours, sample_count);
  grow_to(samples.geometry, sample_count);
  grow_to(samples.secondary, sample_count);
  grow_to(samples.kept, sample_count);
  grow_to(samples.globals, sample_count);
  grow_to(checks.verdicts, sample_count);
  grow_to(checks.identities, sample_count);
  for (SampleQueue* queue : {&checks.samples, &checks.passed, &checks.failed}) grow_to(*queue, sample_count);
}

void TileBuffer::reserve_subpixels(std::size_t centres, std::size_t pixels) {
  SubpixelRecords& s = subpixels;
  grow_to(s.traits, centres);
  grow_to(s.secondary_traits, centres);
  grow_to(s.branches, centres);
  grow_to(s.verdicts, 4 * pixels);
  // Rejected entries are written after the end of a list, and a chunk may have up to three empty entries.
  const std::size_t chunks = (4 * pixels + kChunk - 4) / (kChunk - 3) + 1;
  grow_to(s.active, chunks * kChunk + 4);
  grow_to(s.masters, pixels);
  grow_to(s.fills, chunks + 1);
  grow_to(s.shown, 4 * pixels);
  grow_to(s.states, 12 * pixels + 4);  // includes one more line of sub-pixels on each side, for tiles of any shape
}

void TileBuffer::reserve_visible(std::size_t record_count, std::size_t pixels) {
  grow_to(filters.visible, record_count);
  grow_to(samples.colours, record_count);
  grow_to(subpixels.masters, pixels);
}

void TileBuffer::reserve_low_rate(std::size_t sample_count, std::size_t light_count) {
  grow_to(filters.visible, sample_count);
  grow_to(samples.colours, 2 * sample_count);  // the second half collects the light of diffuse rays
  grow_to(checks.passed, sample_count);
  grow_to(filters.lights, sample_count * light_count);
  grow_to(filters.ratios, sample_count * light_count);
}

void TileBuffer::reserve_denoise(std::size_t sample_count, std::size_t pixels) {
  DenoiseRecords& d = denoise;
  grow_to(d.guides, sample_count);
  grow_to(d.guide_words, pixels);
  grow_to(d.half_light, pixels);
  grow_to(d.half_filtered, pixels);
  grow_to(d.light, pixels);
  grow_to(d.filtered, pixels);
  grow_to(d.half_moments, pixels);
  grow_to(d.moments, pixels);
  grow_to(d.motions, pixels);
  grow_to(d.albedos, pixels);
  grow_to(d.taps, pixels);
  grow_to(d.guide_taps, pixels);
}

void TileResult::clear_for_pass_entry(std::uint32_t frame, std::uint32_t entry) {
  tile = entry;
  x = y = width = height = 0;
  rays = {};
  continued = traversal_steps = triangle_tests = 0;
  pixel_work.clear();
  linear.clear();
  packed.clear();
  marks.clear();
  background.clear();
  sampling = {};
  work.frame = frame;
  work.tile = entry;
  work.samples = 0;
}

glm::vec3 TileResult::averaged_colour(std::uint32_t sample) const {
  const Vec3<float>& rgb = buffer.samples.colours[sample].rgb;
  return glm::clamp(glm::vec3(rgb.x, rgb.y, rgb.z), 0.0F, 1.0F);
}

void TileSummaries::add(const TileResult& tile) {
  TileSummary sum{.tile = tile.tile,
                  .x = tile.x,
                  .y = tile.y,
                  .width = tile.width,
                  .height = tile.height,
                  .begins_pass = tile.work.after_all,
                  .rays = tile.rays,
                  .steps = tile.traversal_steps,
                  .tests = tile.triangle_tests,
                  .accesses = tile.work.accesses.size()};
  const auto first = static_cast<std::ptrdiff_t>(kernels.size());
  for (const traces::WorkNode& node : tile.work.nodes) {
    if (node.kind == traces::WorkNode::Kind::kTransfer) sum.transfer_bytes += node.items;
    if (node.kind != traces::WorkNode::Kind::kLaunch) continue;
    const auto known = std::find_if(kernels.begin() + first, kernels.end(),
                                    [&](const KernelItems& k) { return k.kernel == node.kernel; });
    if (known == kernels.end()) {
      kernels.push_back({node.kernel, node.items + node.idle});
    } else {
      known->items += node.items + node.idle;
    }
  }
  sum.kernels = kernels.size();
  tiles.push_back(sum);
}

}  // namespace kernels
