#include "shader_kernels/programs/denoise/history.h"

#include <algorithm>
#include <cstring>

#include "sim/error.h"

namespace kernels {
namespace {

constexpr std::uint64_t kAlignment = 64;

bool are_equal(const std::vector<traces::InstanceRecord>& a, const std::vector<traces::InstanceRecord>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(traces::InstanceRecord)) == 0);
}

}  // namespace

DenoiseLayout::DenoiseLayout(const DenoiseRecordBytes& bytes, std::uint64_t pixels, std::uint64_t tiles,
                             std::uint64_t tile_pixels, std::uint64_t past_triangles) {
  const auto add_array = [&](std::uint64_t size) {
    const std::uint64_t begin = end;
    end = (end + size + kAlignment - 1) / kAlignment * kAlignment;
    return begin;
  };
  blocks = add_array(tiles * tile_pixels * bytes.block());
  for (History& history : histories) {
    history = {add_array(pixels * bytes.light), add_array(pixels * bytes.guide), add_array(pixels * bytes.moments)};
  }
  for (std::uint64_t& begin : light) begin = add_array(std::max(pixels, tiles * tile_pixels) * bytes.light);
  past_vertices = add_array(past_triangles * 3 * sizeof(PastVertexRecord<float>));
}

std::vector<glm::vec3> vertices_of(const traces::MemoryImage& image) {
  std::uint32_t count = 0;
  const bool is_flat = !image.has_two_levels();
  for (const traces::TriangleRecord& t : image.triangles) count = std::max(count, t.source + 1);
  std::vector<glm::vec3> out(std::size_t{3} * (is_flat ? count : image.triangles.size()));
  for (std::size_t i = 0; i < image.triangles.size(); ++i) {
    const traces::TriangleRecord& t = image.triangles[i];
    const std::size_t to = 3 * (is_flat ? t.source : i);
    out[to] = t.v0;
    out[to + 1] = t.v1;
    out[to + 2] = t.v2;
  }
  return out;
}

bool has_moved_since(const DenoiseHistory& history, const traces::MemoryImage& image) {
  const bool has_moved = history.vertices != vertices_of(image) || !are_equal(history.instances, image.instances);
  if (has_moved && image.has_two_levels()) {
    throw sim::InputError(
        "denoise.filter: atrous: the previous positions of instances are not stored; allowed: bvh.instances=flatten, "
        "or a scene without motion");
  }
  return has_moved;
}

}  // namespace kernels
