#include "shader_kernels/programs/denoise/denoised.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "traces/stream.h"

namespace kernels {

using traces::Region;

namespace {

constexpr auto kSamplesRegion = static_cast<std::size_t>(Region::kSamples);

template <class T>
void copy_array(std::vector<std::uint32_t>& to, std::uint64_t begin, const std::vector<std::uint32_t>& from, T bytes) {
  std::memcpy(to.data() + begin / 4, from.data() + begin / 4, bytes);
}

/// Returns the tile's array of light in the precision of the history, before or after a filter.
template <bool kHalf>
auto& light_of(TileResult& out) {
  if constexpr (kHalf) {
    return out.buffer.denoise.half_light;
  } else {
    return out.buffer.denoise.light;
  }
}
template <bool kHalf>
auto& filtered_of(TileResult& out) {
  if constexpr (kHalf) {
    return out.buffer.denoise.half_filtered;
  } else {
    return out.buffer.denoise.filtered;
  }
}
template <bool kHalf>
auto& moments_of(TileResult& out) {
  if constexpr (kHalf) {
    return out.buffer.denoise.half_moments;
  } else {
    return out.buffer.denoise.moments;
  }
}

}  // namespace

DenoisedProgram::DenoisedProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                 const RenderConfig& render, const DenoiseConfig& denoise,
                                 const DenoiseHistory* history, std::uint32_t frame, const NoisyProgram& noisy)
    : FrameProgram(render.width, render.height),
      image_(image),
      render_(render),
      denoise_(denoise),
      scene_(image, render),
      most_(noisy.clamps_samples ? 1.0F : kLargestHalf),
      frame_(frame),
      tiles_(noisy.tiles),
      tile_count_(tiles_.tile_count()),
      bytes_(denoise.history),
      projection_(projection_of(camera_uniforms(camera, render.width, render.height))),
      has_moved_(history != nullptr && has_moved_since(*history, image)),
      parity_(history != nullptr ? history->parity ^ 1U : 0),
      layout_(bytes_, std::uint64_t{render.width} * render.height, tile_count_, tiles_.most_pixels(),
              has_moved_ ? image.triangles.size() : 0),
      memory_(std::make_shared<std::vector<std::uint32_t>>(layout_.end / 4)),
      guides_{{projection_, history != nullptr ? history->projection : projection_},
              has_moved_,
              memory_->data(),
              layout_.past_vertices / 4},
      program_(noisy.make(*this)) {
  if (history == nullptr) return;
  const std::uint64_t pixels = std::uint64_t{render.width} * render.height;
  const DenoiseLayout::History& past = layout_.histories[parity_ ^ 1U];
  copy_array(*memory_, past.light, *history->memory, pixels * bytes_.light);
  copy_array(*memory_, past.guides, *history->memory, pixels * bytes_.guide);
  copy_array(*memory_, past.moments, *history->memory, pixels * bytes_.moments);
  if (!has_moved_) return;
  auto* corners = reinterpret_cast<PastVertexRecord<float>*>(memory_->data() + guides_.past_word);
  for (const traces::TriangleRecord& triangle : image.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      // A triangle without a past position, of a scene that has more triangles than before, has not moved.
      const std::size_t from = std::size_t{3} * triangle.source + i;
      const std::array<glm::vec3, 3> now{triangle.v0, triangle.v1, triangle.v2};
      const glm::vec3& v = from < history->vertices.size() ? history->vertices[from] : now[i];
      *corners++ = {{v.x, v.y, v.z}, 0};
    }
  }
}

FrameRequirements DenoisedProgram::requirements() const {
  FrameRequirements needs = program_->requirements();
  const std::uint32_t pixels = tiles_.most_pixels();
  const std::uint32_t halo_side = tiles_.most_side() + 2 * kMostHalo,
                      taps = sizeof(LightRecord<float>) + sizeof(GuideTapRecord<float>);
  needs.attribute_bytes +=
      needs.tile_samples * static_cast<std::uint32_t>(sizeof(GuideRecord<float>)) + pixels * bytes_.block();
  const std::uint32_t accumulated = pixels * (bytes_.block() + bytes_.light + bytes_.moments);
  const std::uint32_t filtered = halo_side * halo_side * (bytes_.light + bytes_.guide + taps) + pixels * bytes_.light;
  needs.pass_attribute_bytes = denoise_.iterations == 0 ? accumulated : std::max(accumulated, filtered);
  needs.region_bytes[kSamplesRegion] += layout_.end;
  return needs;
}

std::shared_ptr<const DenoiseHistory> DenoisedProgram::make_history() const {
  return std::make_shared<const DenoiseHistory>(
      DenoiseHistory{memory_, parity_, projection_, vertices_of(image_), image_.instances});
}

void DenoisedProgram::commit_tile(const TileResult& tile) {
  if (tile.tile < tile_count_) {
    mutable_sampling().add(tile.sampling);
  } else if (tile.tile >= tile_count_ * (pass_count() - 1)) {
    FrameProgram::commit_tile(tile);
  }
}

void DenoisedProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                               TileResult& out) const {
  if (tile_index < tile_count_) return program_->run_tile(tile_index, tracer, record, out);
  const std::uint32_t index = tile_index % tile_count_;
  tiles_.set_finished_rect(tiles_.sample_tiles().sample_tile(index), out);
  out.tile = out.work.tile = tile_index;
  out.rays = {};
  out.continued = out.traversal_steps = out.triangle_tests = 0;
  out.pixel_work.clear();
  out.marks.clear();
  out.background.clear();
  out.sampling = {};
  out.work.frame = frame_;
  out.work.samples = out.width * out.height;
  out.linear.clear();
  out.packed.clear();
  TileGraph graph(scene_, record, out);
  out.work.after_all = index == 0;
  Tile tile{index, {out.x, out.y, out.width, out.height}, graph, out};
  const std::uint32_t pass = tile_index / tile_count_;
  is_half() ? run_filter_tile<true>(pass, tile) : run_filter_tile<false>(pass, tile);
  graph.finish();
}

// Pass of the program.

void DenoisedProgram::begin_rays(TileGraph& graph, Node generated, std::uint32_t rays, std::uint32_t samples,
                                 TileResult& out, RetainedRecords& retained) const {
  out.buffer.reserve_denoise(samples, tiles_.most_pixels());
  ClearGuides::Ports<float> ports;
  ports.motion = guides_.motion;
  retained.cleared = graph.launch<ClearGuides>(ports, rays);
  retained.guides = &guides_;
  graph.wait_item_by_item(retained.cleared, generated);
  graph.register_record_writer(retained.cleared);
}

void DenoisedProgram::write_tile(TileGraph& graph, std::uint32_t samples, std::uint32_t per_pixel,
                                 TileResult& out) const {
  is_half() ? split_tile<true>(graph, samples, per_pixel, out) : split_tile<false>(graph, samples, per_pixel, out);
}

void DenoisedProgram::write_grid(TileGraph& graph, const LatticeUniforms<float>& lattice, TileResult& out) const {
  is_half() ? split_grid<true>(graph, lattice, out) : split_grid<false>(graph, lattice, out);
}

template <bool kHalf>
void DenoisedProgram::split_tile(TileGraph& graph, std::uint32_t samples, std::uint32_t per_pixel,
                                 TileResult& out) const {
  typename SplitLight<kHalf>::template Ports<float> ports;
  ports.samples = static_cast<float>(per_pixel);
  ports.inverse_samples = 1.0F / static_cast<float>(per_pixel);
  ports.most = most_;
  write_block<kHalf>(graph, graph.launch<SplitLight<kHalf>>(ports, samples), samples / per_pixel, out);
}

template <bool kHalf>
void DenoisedProgram::split_grid(TileGraph& graph, const LatticeUniforms<float>& lattice, TileResult& out) const {
  typename SplitGridLight<kHalf>::template Ports<float> ports;
  ports.lattice = lattice;
  ports.most = most_;
  const std::uint32_t pixels = out.width * out.height;
  write_block<kHalf>(graph, graph.launch<SplitGridLight<kHalf>>(ports, pixels), pixels, out);
}

template <bool kHalf>
void DenoisedProgram::write_block(TileGraph& graph, Node light_split, std::uint32_t pixels, TileResult& out) const {
  graph.wait_for_colour_writers(light_split);
  graph.wait_for_record_writers(light_split);
  std::byte* to = reinterpret_cast<std::byte*>(memory_->data()) + block_address(out.tile);
  const auto append = [&](const auto& array, std::uint32_t record_bytes) {
    std::memcpy(to, array.data(), std::size_t{pixels} * record_bytes);
    to += std::size_t{pixels} * record_bytes;
  };
  const DenoiseRecords& records = out.buffer.denoise;
  append(light_of<kHalf>(out), bytes_.light);
  append(records.guide_words, bytes_.guide);
  append(records.motions, bytes_.motion);
  append(records.albedos, bytes_.albedo);
  graph.wait_for_all(graph.add_transfer(Region::kSamples, true, block_address(out.tile), pixels * bytes_.block()),
                     light_split);
}

// Later passes.

template <bool kHalf>
void DenoisedProgram::run_filter_tile(std::uint32_t pass, Tile& tile) const {
  const std::size_t halo_side = tiles_.most_side() + 2 * kMostHalo;
  tile.out.buffer.reserve_denoise(0, halo_side * halo_side);
  if (pass == 1) return accumulate<kHalf>(tile);
  const std::uint32_t iteration = pass - 1;
  if (iteration > denoise_.iterations) return modulate<kHalf>(tile);
  if (iteration == 1) return filter_from_tile<kHalf, TapSource::kFirst>(tile, iteration);
  if (2U << (iteration - 1) <= kMostHalo) return filter_from_tile<kHalf, TapSource::kTile>(tile, iteration);
  filter_from_memory<kHalf>(tile, iteration);
}

template <bool kHalf>
void DenoisedProgram::accumulate(Tile& tile) const {
  TileGraph& graph = tile.graph;
  DenoiseRecords& records = tile.out.buffer.denoise;
  const std::uint32_t pixels = tile.at.pixel_count();
  // One transfer reads light, guides and motions, which follow each other in the tile's block.
  const std::byte* from = reinterpret_cast<const std::byte*>(memory_->data()) + block_address(tile.index);
  const auto take = [&](auto& array, std::uint32_t record_bytes) {
    std::memcpy(array.data(), from, std::size_t{pixels} * record_bytes);
    from += std::size_t{pixels} * record_bytes;
  };
  take(light_of<kHalf>(tile.out), bytes_.light);
  take(records.guide_words, bytes_.guide);
  take(records.motions, bytes_.motion);
  const Node in = graph.add_transfer(Region::kSamples, false, block_address(tile.index),
                                     pixels * (bytes_.light + bytes_.guide + bytes_.motion));

  typename AccumulateHistory<kHalf>::template Ports<float> ports;
  const DenoiseLayout::History &past = layout_.histories[parity_ ^ 1U], &now = layout_.histories[parity_];
  ports.stored.bind_stored(memory_->data(), past.guides / 4, graph.access_log());
  ports.stored_light.bind_stored(memory_->data(), past.light / 4, graph.access_log());
  ports.stored_moments.bind_stored(memory_->data(), past.moments / 4, graph.access_log());
  const auto width = static_cast<float>(tile.at.width);
  ports.tile = {.x0 = static_cast<float>(tile.at.x),
                .y0 = static_cast<float>(tile.at.y),
                .width = width,
                .inverse_width = 1.0F / width,
                .last_x = static_cast<float>(render_.width - 1),
                .last_y = static_cast<float>(render_.height - 1),
                .picture_width = static_cast<float>(render_.width)};
  ports.alpha = static_cast<float>(denoise_.alpha);
  ports.moments_alpha = static_cast<float>(denoise_.moments_alpha);
  ports.cap = static_cast<float>(denoise_.history_cap);
  ports.depth_tolerance = static_cast<float>(denoise_.depth_tolerance);
  ports.normal_tolerance = static_cast<float>(2 * (1 - denoise_.normal_tolerance)) * kNormalScale * kNormalScale;
  const Node accumulated = graph.launch<AccumulateHistory<kHalf>>(ports, pixels);
  graph.wait_for_all(accumulated, in);
  write_light(tile, 0, filtered_of<kHalf>(tile.out).data(), accumulated);
  write_rows(tile, now.guides, bytes_.guide, records.guide_words.data(), accumulated);
  write_rows(tile, now.moments, bytes_.moments, moments_of<kHalf>(tile.out).data(), accumulated);
}

template <bool kHalf, TapSource kSource>
void DenoisedProgram::filter_from_tile(Tile& tile, std::uint32_t iteration) const {
  TileGraph& graph = tile.graph;
  DenoiseRecords& records = tile.out.buffer.denoise;
  const std::uint32_t step = 1U << (iteration - 1);
  const Rect stored = with_halo(tile.at, 2 * step);
  read_rows(tile, light_after(iteration - 1), bytes_.light, stored, light_of<kHalf>(tile.out).data());
  read_rows(tile, layout_.histories[parity_].guides, bytes_.guide, stored, records.guide_words.data());
  typename UnpackTaps<kHalf>::template Ports<float> unpack;
  const Node unpacked = graph.launch<UnpackTaps<kHalf>>(unpack, stored.pixel_count());
  graph.wait_for_record_writers(unpacked);

  using Filter = FilterLight<kHalf, kSource>;
  typename Filter::template Ports<float> ports;
  ports.finished = finished_uniforms(tile.at, stored);
  ports.edge = edge_uniforms(step);
  const Node filtered = graph.launch<Filter>(ports, tile.at.pixel_count());
  graph.wait_for_all(filtered, unpacked);
  write_light(tile, iteration, filtered_of<kHalf>(tile.out).data(), filtered);
}

template <bool kHalf>
void DenoisedProgram::filter_from_memory(Tile& tile, std::uint32_t iteration) const {
  using Filter = FilterLight<kHalf, TapSource::kMemory>;
  typename Filter::template Ports<float> ports;
  ports.finished = finished_uniforms(tile.at, {0, 0, render_.width, render_.height});
  ports.edge = edge_uniforms(1U << (iteration - 1));
  ports.stored.bind_stored(memory_->data(), layout_.histories[parity_].guides / 4, tile.graph.access_log());
  ports.stored_light.bind_stored(memory_->data(), light_after(iteration - 1) / 4, tile.graph.access_log());
  const Node filtered = tile.graph.launch<Filter>(ports, tile.at.pixel_count());
  write_light(tile, iteration, filtered_of<kHalf>(tile.out).data(), filtered);
}

template <bool kHalf>
void DenoisedProgram::modulate(Tile& tile) const {
  TileGraph& graph = tile.graph;
  const std::uint32_t pixels = tile.at.pixel_count();
  tile.out.linear.resize(pixels);
  tile.out.packed.resize(pixels);
  auto& light = light_of<kHalf>(tile.out);
  if (is_stored_by_tile(denoise_.iterations)) {
    read(graph, tile_light_address(tile.index), light.data(), pixels * bytes_.light);
  } else {
    read_rows(tile, light_after(denoise_.iterations), bytes_.light, tile.at, light.data());
  }
  const std::uint32_t before = pixels * (bytes_.block() - bytes_.albedo);
  read(graph, block_address(tile.index) + before, tile.out.buffer.denoise.albedos.data(), pixels * bytes_.albedo);
  typename ModulateAlbedo<kHalf>::template Ports<float> ports;
  const Node modulated = graph.launch<ModulateAlbedo<kHalf>>(ports, pixels);
  graph.wait_for_record_writers(modulated);
  graph.write_pixels(modulated, std::uint64_t{tile.index} * tiles_.most_pixels() * kPixelBytes);
}

// Memory.

/// Returns the array that iteration `iteration` of the filter writes; 0: accumulate_history. The first iteration writes
/// the light of the history; without iterations accumulate_history does.
std::uint64_t DenoisedProgram::light_after(std::uint32_t iteration) const {
  const bool is_history = iteration == std::min(1U, denoise_.iterations);
  return is_history ? layout_.histories[parity_].light : layout_.light[iteration == 0 ? 0 : (iteration + 1) % 2];
}

std::uint64_t DenoisedProgram::block_address(std::uint32_t tile) const {
  return layout_.blocks + std::uint64_t{tile} * tiles_.most_pixels() * bytes_.block();
}

std::uint64_t DenoisedProgram::tile_light_address(std::uint32_t tile) const {
  return light_after(denoise_.iterations) + std::uint64_t{tile} * tiles_.most_pixels() * bytes_.light;
}

void DenoisedProgram::read(TileGraph& graph, std::uint64_t address, void* to, std::uint32_t bytes) const {
  std::memcpy(to, memory_->data() + address / 4, bytes);
  graph.register_record_writer(graph.add_transfer(Region::kSamples, false, address, bytes));
}

void DenoisedProgram::write(TileGraph& graph, std::uint64_t address, const void* from, std::uint32_t bytes,
                            Node after) const {
  std::memcpy(memory_->data() + address / 4, from, bytes);
  graph.wait_for_all(graph.add_transfer(Region::kSamples, true, address, bytes), after);
}

/// Reads a rectangle of an array that is stored row by row.
void DenoisedProgram::read_rows(Tile& tile, std::uint64_t array, std::uint32_t record_bytes, const Rect& rect,
                                void* to) const {
  for (std::uint32_t row = 0; row < rect.height; ++row) {
    const std::uint64_t first = std::uint64_t{rect.y + row} * render_.width + rect.x;
    read(tile.graph, array + first * record_bytes,
         static_cast<std::byte*>(to) + std::size_t{row} * rect.width * record_bytes, rect.width * record_bytes);
  }
}

void DenoisedProgram::write_rows(Tile& tile, std::uint64_t array, std::uint32_t record_bytes, const void* from,
                                 Node after) const {
  for (std::uint32_t row = 0; row < tile.at.height; ++row) {
    const std::uint64_t first = std::uint64_t{tile.at.y + row} * render_.width + tile.at.x;
    write(tile.graph, array + first * record_bytes,
          static_cast<const std::byte*>(from) + std::size_t{row} * tile.at.width * record_bytes,
          tile.at.width * record_bytes, after);
  }
}

void DenoisedProgram::write_light(Tile& tile, std::uint32_t iteration, const void* from, Node after) const {
  if (is_stored_by_tile(iteration)) {
    write(tile.graph, tile_light_address(tile.index), from, tile.at.pixel_count() * bytes_.light, after);
  } else {
    write_rows(tile, light_after(iteration), bytes_.light, from, after);
  }
}

/// Returns the rectangle with `reach` more pixels on each side, as far as they are in the picture.
DenoisedProgram::Rect DenoisedProgram::with_halo(const Rect& tile, std::uint32_t reach) const {
  const std::uint32_t x = tile.x - std::min(reach, tile.x), y = tile.y - std::min(reach, tile.y);
  return {x, y, std::min(tile.x + tile.width + reach, render_.width) - x,
          std::min(tile.y + tile.height + reach, render_.height) - y};
}

EdgeUniforms<float> DenoisedProgram::edge_uniforms(std::uint32_t step) const {
  return {.colour = static_cast<float>(1 / denoise_.phi_colour),
          .normal = static_cast<float>(denoise_.phi_normal / 2) / (kNormalScale * kNormalScale),
          .depth = static_cast<float>(1 / denoise_.phi_depth),
          .step = static_cast<float>(step)};
}

/// Returns where the pixels of `tile` are in an array that has the pixels of `stored` row by row.
FinishedUniforms<float> DenoisedProgram::finished_uniforms(const Rect& tile, const Rect& stored) const {
  const auto width = static_cast<float>(tile.width);
  const auto x = static_cast<float>(tile.x), y = static_cast<float>(tile.y);
  return {.width = width,
          .inverse_width = 1.0F / width,
          .first = static_cast<float>((tile.y - stored.y) * stored.width + tile.x - stored.x),
          .pitch = static_cast<float>(stored.width),
          .low_x = -x,
          .high_x = static_cast<float>(render_.width - 1) - x,
          .low_y = -y,
          .high_y = static_cast<float>(render_.height - 1) - y};
}

}  // namespace kernels
