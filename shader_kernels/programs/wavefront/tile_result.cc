#include "shader_kernels/programs/wavefront/tile_result.h"

#include <glm/common.hpp>

#include "shader_kernels/kernels/subpixels.h"

namespace kernels {
namespace {

void grow(auto& array, std::size_t size) {
  if (array.size() < size) array.resize(size);
}

}  // namespace

void RaySlots::hold(std::size_t slots) {
  grow(rays, slots);
  grow(paths, slots);
  grow(hits, slots);
}

void TileBuffer::hold_wave(std::size_t slots) {
  wave.hold(slots);
  // A stream has one more slot than items: what is not kept is written behind its end.
  for (auto* stream : {&misses, &surfaces, &textured, &diffuse, &later, &mirror, &glass, &emissive})
    grow(*stream, slots + 1);
  grow(points, slots);
  grow(mattes, slots);
  grow(texcoords, slots);
  grow(optics, slots);
}

void TileBuffer::hold_details(std::size_t slots) {
  for (auto* stream : {&absorbing, &vertexed, &based, &physical, &bumped, &blended, &glowing, &occluded}) {
    grow(*stream, slots + 1);
  }
  grow(tangents, slots);
}

void TileBuffer::hold_layers(std::size_t slots) {
  grow(layers, slots + 1);
  grow(targets, slots + 1);
  layer.hold(slots + 1);
}

void TileBuffer::hold_samples(std::size_t count) {
  grow(colours, count);
  grow(geometry, count);
  grow(secondary, count);
  grow(kept, count);
  grow(globals, count);
  grow(verdicts, count);
  grow(identities, count);
  for (auto* stream : {&samples, &passed, &failed}) grow(*stream, count + 1);
}

void TileBuffer::hold_subpixels(std::size_t centres, std::size_t pixels) {
  grow(traits, centres);
  grow(secondary_traits, centres);
  grow(branches, centres);
  grow(subpixels, 4 * pixels);
  // Lists have entries to spare: what is not kept is written behind their end, and chunks may stay three short.
  const std::size_t chunks = (4 * pixels + kChunk - 4) / (kChunk - 3) + 1;
  grow(active, chunks * kChunk + 4);
  grow(masters, pixels + 1);
  grow(fills, chunks + 1);
  grow(shown, 4 * pixels);
  grow(states, 12 * pixels + 4);  // a line more on each side, whatever the pixels' shape
}

void TileBuffer::hold_visible(std::size_t count, std::size_t pixels) {
  grow(visible, count);
  grow(colours, count);
  grow(masters, pixels + 1);
}

void TileBuffer::hold_rated(std::size_t count, std::size_t light_count) {
  grow(visible, count);
  grow(colours, count);
  grow(passed, count + 1);
  grow(lights, count * light_count);
  grow(ratios, count * light_count);
}

glm::vec3 TileResult::colour(std::uint32_t sample) const {
  const Vec3<float>& rgb = buffer.colours[sample].rgb;
  return glm::clamp(glm::vec3(rgb.x, rgb.y, rgb.z), 0.0F, 1.0F);
}

}  // namespace kernels
