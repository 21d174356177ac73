#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "shader_kernels/kernels/subpixels.h"
#include "shader_kernels/programs/adaptive/supersample.h"

namespace kernels {

PropagationState::PropagationState(std::uint32_t width, std::uint32_t height, std::uint32_t tiles)
    : width_(2 * width),
      height_(2 * height),
      states_((std::size_t{width_} + 2) * (std::size_t{height_} + 2)),
      colours_(std::size_t{width_} * height_),
      is_background_(colours_.size()),
      fresh_(tiles),
      next_fresh_(tiles) {}

void PropagationState::store_initial_subpixels(std::uint32_t tile, const std::vector<PropagationSubpixel>& all) {
  const auto is_active = [](const PropagationSubpixel& s) { return s.state.blue_why >> kRoundShift != 0; };
  next_fresh_[tile] = std::ranges::any_of(all, is_active) ? 1 : 0;
  store_subpixels(all);
}

void PropagationState::add_activated_subpixels(std::uint32_t tile, const std::vector<PropagationSubpixel>& found) {
  next_fresh_[tile] = found.empty() ? 0 : 1;
  found_.insert(found_.end(), found.begin(), found.end());
}

void PropagationState::apply_round_results() {
  store_subpixels(found_);
  found_.clear();
  fresh_.swap(next_fresh_);
}

void PropagationState::store_subpixels(const std::vector<PropagationSubpixel>& subpixels) {
  for (const PropagationSubpixel& s : subpixels) {
    states_[std::size_t{s.y + 1} * (width_ + 2) + s.x + 1] = s.state;
    colours_[std::size_t{s.y} * width_ + s.x] = s.colour;
    is_background_[std::size_t{s.y} * width_ + s.x] = s.is_background ? 1 : 0;
  }
}

std::uint32_t PropagationState::active_subpixel_count(std::uint32_t x, std::uint32_t y) const {
  std::uint32_t active = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::size_t at = std::size_t{2 * y + i / 2 + 1} * (width_ + 2) + 2 * x + i % 2 + 1;
    active += states_[at].blue_why >> kRoundShift != 0 ? 1 : 0;
  }
  return active;
}

void PropagationState::copy_states(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height,
                                   SubpixelRecord<float>* to) const {
  for (std::uint32_t row = 0; row < height + 2; ++row) {
    to = std::copy_n(states_.data() + std::size_t{y + row} * (width_ + 2) + x, width + 2, to);
  }
}

using traces::Region;

namespace {

static_assert((std::uint64_t{kMostRounds} + 1) << kRoundShift <= 0xffffffffU);

constexpr std::uint32_t kStateBytes = sizeof(SubpixelRecord<float>);
constexpr std::uint32_t kShownBytes = kStateBytes + sizeof(ColourRecord<float>);

}  // namespace

std::uint32_t SupersampleProgram::pass_end(std::uint32_t tile_index) const {
  return (tile_index / tiles_.tile_count() + 1) * tiles_.tile_count();
}

/// Returns the bytes in memory of the colours and states of a tile's sub-pixels.
std::uint32_t SupersampleProgram::subpixel_bytes() const { return 4 * tile_pixels() * kShownBytes; }

/// Returns the address of the states of a tile's sub-pixels; their colours follow them. After the data of all tiles are
/// two arrays with a byte per tile, for even and odd rounds. The byte records whether the round made sub-pixels of the
/// tile active.
std::uint64_t SupersampleProgram::subpixel_data_address(std::uint32_t tile) const {
  return tiles_.tile_count() * stored_bytes_per_tile() + std::uint64_t{tile} * subpixel_bytes();
}
std::uint64_t SupersampleProgram::newly_active_flag_address(std::uint32_t tile, std::uint32_t round) const {
  return subpixel_data_address(tiles_.tile_count()) + std::uint64_t{round % 2} * tiles_.tile_count() + tile;
}

StateUniforms<float> SupersampleProgram::state_uniforms(const Tile& tile) {
  const float pitch = 2 * tile.finished.width + 2;  // one more sub-pixel on each side
  return {tile.finished.width, tile.finished.inverse_width, pitch + 1, pitch};
}

/// Returns how many bytes of the tile buffer wait for the DMA while rays are traced: the colours and states of one
/// chunk of active sub-pixels. Other data of sub-pixels reuse the slots of finished rays.
std::uint32_t SupersampleProgram::dma_waiting_bytes() { return kChunk * kShownBytes; }

/// Writes colours and states of all sub-pixels as if none were active. apply_round_results() later overwrites the
/// active ones.
void SupersampleProgram::store_inactive_subpixels(Tile& tile) const {
  const auto launch = [&]<class K>(K) {
    typename K::template Ports<float> ports;
    ports.finished = tile.finished;
    ports.grid = state_uniforms(tile);
    return tile.graph.launch<K>(ports, 4 * tile.pixels);
  };
  const Node node =
      supersample_.filter == SubpixelFilter::kBilinear ? launch(ShowSubpixels<true>{}) : launch(ShowSubpixels<false>{});
  tile.graph.wait_for_colour_writers(node);
  tile.graph.register_colour_writer(node);
  tile.shown = tile.graph.add_transfer(Region::kSamples, true, subpixel_data_address(tile.at.index),
                                       4 * tile.pixels * kShownBytes);
  tile.graph.wait_for_all(tile.shown, node);
  tile.graph.register_colour_writer(tile.shown);
}

/// Stores colours and states of a chunk of active sub-pixels in the tile buffer. The samples of these sub-pixels begin
/// at index `first_sample`. Before the first propagation round (`round` 0) it also writes the colours and states to
/// memory.
void SupersampleProgram::store_active_subpixels(Tile& tile, const Chunk& chunk, std::uint32_t first_sample,
                                                std::uint32_t round) const {
  if (chunk.subpixels == 0) return;
  SettleSubpixels::Ports<float> ports;
  ports.grid = state_uniforms(tile);
  ports.active.bind(tile.buffer.subpixels.active.data() + chunk.first);
  ports.verdicts.bind(tile.buffer.subpixels.verdicts.data());
  ports.first_sample = static_cast<float>(first_sample);
  ports.round = (round + 1) << kRoundShift;
  const Node node = tile.graph.launch<SettleSubpixels>(ports, chunk.subpixels);
  tile.graph.wait_for_colour_writers(node);
  tile.graph.register_colour_writer(node);
  if (round != 0) return;
  const std::uint64_t store = subpixel_data_address(tile.at.index);
  const Node out = tile.graph.add_transfer(Region::kSamples, true, store, chunk.subpixels * kShownBytes);
  tile.graph.wait_for_all(out, node);
  tile.graph.wait_for_all(out, tile.shown);
  tile.shown = out;
}

/// Returns the colour and state of one of the tile's sub-pixels, from the tile buffer.
PropagationSubpixel SupersampleProgram::load_propagation_subpixel(const Tile& tile, std::uint32_t subpixel) {
  const std::uint32_t x = 2 * (subpixel / 4 % tile.out.width) + subpixel % 2;
  const std::uint32_t y = 2 * (subpixel / 4 / tile.out.width) + subpixel / 2 % 2;
  const std::uint32_t pitch = 2 * tile.out.width + 2;
  const Vec3<float>& rgb = tile.buffer.subpixels.shown[subpixel].rgb;
  return {2 * tile.out.x + x,
          2 * tile.out.y + y,
          tile.buffer.subpixels.states[(y + 1) * pitch + x + 1],
          {rgb.x, rgb.y, rgb.z}};
}

/// Writes colours and states of all the tile's sub-pixels to memory.
void SupersampleProgram::write_subpixels(Tile& tile) const {
  const Node out = tile.graph.add_transfer(Region::kSamples, true, subpixel_data_address(tile.at.index),
                                           4 * tile.pixels * kShownBytes);
  tile.graph.wait_for_colour_writers(out);
  const Node noted = tile.graph.add_transfer(Region::kSamples, true, newly_active_flag_address(tile.at.index, 0), 1);
  tile.graph.wait_for_all(noted, out);
  for (std::uint32_t i = 0; i < 4 * tile.pixels; ++i) {
    PropagationSubpixel shown = load_propagation_subpixel(tile, i);
    shown.is_background = tile.buffer.subpixels.traits[centre_sample_index(tile, i / 4)].object == kNoObject;
    tile.out.subpixels.push_back(shown);
  }
}

void SupersampleProgram::begin_pass(std::uint32_t tile_index, const traces::Tracer& /*tracer*/) {
  if (tile_index >= tiles_.tile_count()) shown_.apply_round_results();
}

/// True if the previous round made sub-pixels active in the tile or its neighbours. Calls `read(tile, bytes)` for each
/// flag of a tile that the modelled machine reads from memory.
bool SupersampleProgram::has_newly_active_neighbour(const SampleTile& at, auto&& read) const {
  const std::uint32_t first = at.has_left ? at.index - 1 : at.index;
  const std::uint32_t across = 1U + (at.has_left ? 1 : 0) + (at.has_right ? 1 : 0);
  read(first, across);
  bool reached = false;
  for (std::uint32_t i = 0; i < across; ++i) reached |= shown_.is_newly_active(first + i);
  for (const auto& [has, tile] : {std::pair{at.has_above, at.index - tiles_.sample_tiles().tiles_across()},
                                  std::pair{at.has_below, at.index + tiles_.sample_tiles().tiles_across()}}) {
    if (!has) continue;
    read(tile, 1U);
    reached |= shown_.is_newly_active(tile);
  }
  return reached;
}

void SupersampleProgram::run_round(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                   TileResult& out) const {
  const std::uint32_t count = tiles_.tile_count();
  const std::uint32_t round = tile_index / count;
  const SampleTile at = tiles_.sample_tiles().sample_tile(order_[tile_index % count]);
  begin_tile(at, out);
  out.tile = out.work.tile = round * count + at.index;
  Wavefront wave(scene_, tracer, record, cone_uniforms(camera_, kWholeGrid), out);
  TileGraph& graph = wave.tile_graph();
  out.work.after_all = tile_index % count == 0;
  Node before = Wavefront::kNone;
  const bool reached = has_newly_active_neighbour(at, [&](std::uint32_t tile, std::uint32_t bytes) {
    const Node read = graph.add_transfer(Region::kSamples, false, newly_active_flag_address(tile, round - 1), bytes);
    graph.wait_for_all(read, before);
    before = read;
  });
  out.linear.clear();
  out.packed.clear();
  if (reached) {
    Tile tile = make_tile(at, wave, out);
    propagate_round(tile, round, before);
  }
  wave.finish();
  out.sampling.traced_background = out.background.size();
  out.width = out.height = 0;  // the tile returns corrected pixels only
}

/// Reads from memory the states of the tile's sub-pixels and of those next to the tile.
SupersampleProgram::Node SupersampleProgram::read_subpixel_states(Tile& tile, Node before) const {
  const TileResult& out = tile.out;
  shown_.copy_states(2 * out.x, 2 * out.y, 2 * out.width, 2 * out.height, tile.buffer.subpixels.states.data());
  const std::uint32_t index = tile.at.index;
  const auto read = [&](bool has, std::uint32_t from, std::uint32_t subpixels) {
    if (!has) return;
    const Node in =
        tile.graph.add_transfer(Region::kSamples, false, subpixel_data_address(from), subpixels * kStateBytes);
    tile.graph.wait_for_all(in, before);
    before = in;
  };
  read(true, index, 4 * tile.pixels);
  read(tile.at.has_left, index - 1, 2 * out.height);
  read(tile.at.has_right, index + 1, 2 * out.height);
  read(tile.at.has_above, index - tiles_.sample_tiles().tiles_across(), 2 * out.width);
  read(tile.at.has_below, index + tiles_.sample_tiles().tiles_across(), 2 * out.width);
  return before;
}

/// Runs a propagation round in one tile. Called if sub-pixels of the tile or of its neighbours are newly active.
void SupersampleProgram::propagate_round(Tile& tile, std::uint32_t round, Node before) const {
  TileBuffer& buffer = tile.buffer;
  PropagateSubpixels::Ports<float> ports;
  ports.grid = state_uniforms(tile);
  ports.verdicts.bind(buffer.subpixels.verdicts.data());
  ports.last_master.value = -1;
  ports.thresholds = attribute_thresholds();
  ports.round = round << kRoundShift;
  const Node in = read_subpixel_states(tile, before);
  const Node found = tile.graph.launch<PropagateSubpixels>(ports, 4 * tile.pixels);
  tile.graph.wait_for_all(found, in);
  const std::uint32_t subpixels = ports.active_count.value;
  if (subpixels == 0) return;

  for (std::uint32_t first = 0; first < subpixels; first += kChunk) {
    const Chunk chunk{.first = first, .subpixels = std::min(kChunk, subpixels - first)};
    trace_chunk(tile, chunk, 0, found);
    store_active_subpixels(tile, chunk, 0, round);
  }
  tile.out.sampling.propagated = subpixels;
  tile.out.sampling.traced = tile.out.sampling.correction = std::uint64_t{kExtra} * subpixels;
  for (std::uint32_t i = 0; i < subpixels; ++i)
    tile.out.subpixels.push_back(load_propagation_subpixel(tile, buffer.subpixels.active[i]));
  write_corrected_pixels(tile, ports.masters_count.value, subpixels, round);
}

/// Averages the listed pixels again. Writes them and the newly sampled sub-pixels to memory.
void SupersampleProgram::write_corrected_pixels(Tile& tile, std::uint32_t pixels, std::uint32_t subpixels,
                                                std::uint32_t round) const {
  TileGraph& graph = tile.graph;
  TileResult& out = tile.out;
  const std::uint64_t states = 4 * std::uint64_t{tile_pixels()} * kStateBytes;
  const std::uint64_t colours = 4 * std::uint64_t{tile_pixels()} * sizeof(ColourRecord<float>);
  const std::uint64_t store = subpixel_data_address(tile.at.index);
  const Node in = graph.add_transfer(Region::kSamples, false, store + states, scattered_bytes(pixels, colours));
  graph.wait_for_colour_writers(in);
  out.linear.resize(pixels);
  out.packed.resize(pixels);
  for (std::uint32_t i = 0; i < pixels; ++i) load_other_subpixels(tile, tile.buffer.subpixels.masters.entries[i]);

  AverageSubpixels::Ports<float> ports;
  ports.samples = 4;
  ports.inverse_samples = 0.25F;
  const Node averaged = graph.launch<AverageSubpixels>(ports, 4 * pixels);
  graph.wait_for_all(averaged, in);
  const Node packed = graph.launch<PackColour>(pixels);
  graph.wait_for_all(packed, averaged);
  const std::uint64_t picture = std::uint64_t{tile_pixels()} * kPixelBytes;
  graph.wait_for_all(
      graph.add_transfer(Region::kPicture, true, tile.at.index * picture, scattered_bytes(pixels, picture)), packed);
  Node last = averaged;
  const auto put = [&](std::uint64_t offset, std::uint32_t bytes) {
    const Node node = graph.add_transfer(Region::kSamples, true, offset, bytes);
    graph.wait_for_all(node, last);
    last = node;
  };
  put(store, scattered_bytes(subpixels, states));
  put(store + states, scattered_bytes(subpixels, colours));
  put(newly_active_flag_address(tile.at.index, round), 1);
}

/// Loads from memory the colours of those sub-pixels of a pixel that the current propagation round has not sampled.
void SupersampleProgram::load_other_subpixels(Tile& tile, std::uint32_t pixel) const {
  TileResult& out = tile.out;
  const std::uint32_t x = out.x + pixel % out.width, y = out.y + pixel / out.width;
  out.corrected.push_back(y * width() + x);
  const std::span found(tile.buffer.subpixels.active.data(), out.subpixels.size());
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (std::ranges::binary_search(found, 4 * pixel + i)) continue;
    const glm::vec3& colour = shown_.subpixel_colour(2 * x + i % 2, 2 * y + i / 2);
    tile.buffer.subpixels.shown[4 * pixel + i] = {{colour.x, colour.y, colour.z}};
  }
}

void SupersampleProgram::commit_tile(const TileResult& tile) {
  FrameProgram::commit_tile(tile);
  if (supersample_.propagate == 0) return;
  if (tile.tile < tiles_.tile_count()) return shown_.store_initial_subpixels(tile.tile, tile.subpixels);
  shown_.add_activated_subpixels(tile.tile % tiles_.tile_count(), tile.subpixels);
  Sampling& sampling = mutable_sampling();
  sampling.background += tile.background.size();
  for (const PropagationSubpixel& s : tile.subpixels) {
    if (shown_.is_background(s.x, s.y)) sampling.background -= kExtra;
  }
  for (std::size_t i = 0; i < tile.corrected.size(); ++i) {
    const std::uint32_t pixel = tile.corrected[i];
    const glm::vec3& colour = tile.linear[i];
    std::copy_n(&colour.x, 3, mutable_picture().data() + std::size_t{3} * pixel);
    recount_pixel(pixel, tile);
  }
}

/// Updates the frame's counts after a pixel's number of active sub-pixels has changed.
void SupersampleProgram::recount_pixel(std::uint32_t pixel, const TileResult& tile) {
  const std::uint32_t x = pixel % width(), y = pixel / width();
  const auto more = static_cast<std::uint32_t>(
      std::ranges::count_if(tile.subpixels, [&](const auto& s) { return s.x / 2 == x && s.y / 2 == y; }));
  const std::uint32_t before = shown_.active_subpixel_count(x, y);
  mutable_sampling().active[before] -= 1;
  mutable_sampling().active[before + more] += 1;
  if (mutable_marks().empty()) return;
  mutable_marks()[pixel] =
      static_cast<SampleMark>(mutable_marks()[pixel] + (more << kActiveCountShift)) | kCorrectedMark;
}

}  // namespace kernels
