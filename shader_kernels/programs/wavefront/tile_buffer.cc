#include "shader_kernels/programs/wavefront/tile_buffer.h"

#include "shader_kernels/kernels/subpixels.h"

namespace kernels {
namespace {

void grow(auto& array, std::size_t size) {
  if (array.size() < size) array.resize(size);
}

template <class Item>
void grow(Queue<Item>& queue, std::size_t items) {
  grow(queue.entries, items + 1);
}

}  // namespace

void RaySlots::hold(std::size_t slots) {
  grow(rays, slots);
  grow(paths, slots);
  grow(hits, slots);
}

void StageQueues::clear_surfaces() {
  for (SlotQueue* queue : {&textured, &diffuse, &mirror, &glass, &emissive, &deferred, &absorbing, &vertexed, &based,
                           &physical, &bumped, &blended, &glowing, &occluded}) {
    queue->items = 0;
  }
}

void TileBuffer::reserve_wave(std::size_t slots) {
  rays.wave.hold(slots);
  StageQueues& q = queues;
  for (SlotQueue* queue :
       {&q.misses, &q.surfaces, &q.textured, &q.diffuse, &q.deferred, &q.mirror, &q.glass, &q.emissive}) {
    grow(*queue, slots);
  }
  grow(surfaces.points, slots);
  grow(surfaces.mattes, slots);
  grow(surfaces.texcoords, slots);
  grow(surfaces.optics, slots);
}

void TileBuffer::reserve_details(std::size_t slots) {
  StageQueues& q = queues;
  for (SlotQueue* queue :
       {&q.absorbing, &q.vertexed, &q.based, &q.physical, &q.bumped, &q.blended, &q.glowing, &q.occluded}) {
    grow(*queue, slots);
  }
  grow(surfaces.tangents, slots);
}

void TileBuffer::reserve_layers(std::size_t slots) {
  grow(queues.layers, slots);
  grow(queues.targets, slots);
  rays.layer.hold(slots + 1);
}

void TileBuffer::reserve_samples(std::size_t count) {
  grow(samples.colours, count);
  grow(samples.geometry, count);
  grow(samples.secondary, count);
  grow(samples.kept, count);
  grow(samples.globals, count);
  grow(checks.verdicts, count);
  grow(checks.identities, count);
  for (SampleQueue* queue : {&checks.samples, &checks.passed, &checks.failed}) grow(*queue, count);
}

void TileBuffer::reserve_subpixels(std::size_t centres, std::size_t pixels) {
  SubpixelRecords& s = subpixels;
  grow(s.traits, centres);
  grow(s.secondary_traits, centres);
  grow(s.branches, centres);
  grow(s.verdicts, 4 * pixels);
  // Rejected entries are written after a list's end, and chunks may be up to three entries short.
  const std::size_t chunks = (4 * pixels + kChunk - 4) / (kChunk - 3) + 1;
  grow(s.active, chunks * kChunk + 4);
  grow(s.masters, pixels);
  grow(s.fills, chunks + 1);
  grow(s.shown, 4 * pixels);
  grow(s.states, 12 * pixels + 4);  // one more line on each side, for pixels of any shape
}

void TileBuffer::reserve_visible(std::size_t count, std::size_t pixels) {
  grow(filters.visible, count);
  grow(samples.colours, count);
  grow(subpixels.masters, pixels);
}

void TileBuffer::reserve_rated(std::size_t count, std::size_t light_count) {
  grow(filters.visible, count);
  grow(samples.colours, count);
  grow(checks.passed, count);
  grow(filters.lights, count * light_count);
  grow(filters.ratios, count * light_count);
}

}  // namespace kernels
