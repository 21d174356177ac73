#include "shader_kernels/programs/adaptive/undersample.h"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include <glm/common.hpp>

#include "shader_kernels/kernels/similarity.h"

namespace kernels {

PostCorrection::PostCorrection(const UndersampleConfig& config, std::uint32_t width, std::uint32_t height,
                               std::uint32_t tile_side)
    : config_(config), width_(width), height_(height), side_(tile_side), across_((width + tile_side - 1) / tile_side) {
  if (scan_count() == 0) return;
  identities_.resize((std::size_t{width} + 2) * (std::size_t{height} + 2));
  rounds_.resize(identities_.size());
  colours_.resize(std::size_t{width} * height);
}

std::uint32_t PostCorrection::scan_count() const {
  if (config_.correction == Correction::kOff) return 0;
  return config_.correction == Correction::kTwo ? 2 : 4;
}

void PostCorrection::store_samples(const TileResult& tile, const SampleTile& at) {
  if (scan_count() == 0) return;
  for (std::uint32_t row = 0; row < at.height; ++row) {
    for (std::uint32_t column = 0; column < at.width; ++column) {
      const CorrectionSample& sample = tile.shown[std::size_t{row} * at.width + column];
      identities_[sample_index(at.x + column, at.y + row)] = sample.identity;
      colours_[std::size_t{at.y + row} * width_ + at.x + column] = sample.colour;
    }
  }
}

void PostCorrection::begin_scan() {
  all_.clear();
  std::ranges::fill(rounds_, std::uint16_t{0});
}

/// Finds the suspect samples at position `step` of every row or column of the picture.
void PostCorrection::find_suspects(const Scan& scan, std::uint32_t step) {
  const std::uint32_t lines = scan.is_along_y ? width_ : height_;
  const std::uint32_t length = scan.is_along_y ? height_ : width_;
  const std::uint32_t at = scan.is_backward ? length - 1 - step : step;
  const std::uint32_t along = scan.is_along_y ? width_ + 2 : 1;
  const std::uint32_t across = scan.is_along_y ? 1 : width_ + 2;
  const std::uint32_t ahead = scan.is_backward ? 0 - along : along;
  line_.resize(lines);
  found_.resize(lines + 1);
  const std::uint32_t first = scan.is_along_y ? sample_index(0, at) : sample_index(at, 0);
  for (std::uint32_t line = 0; line < lines; ++line) line_[line] = first + line * across;

  const bool eight = config_.neighbours == Neighbourhood::kEight;
  const auto run = [&]<class K>(K) {
    typename K::template Ports<float> ports;
    ports.samples.bind(line_.data());
    ports.identities.bind(identities_.data());
    ports.suspects.bind(found_.data());
    ports.step = ahead;
    ports.line_step = across;
    for (std::uint32_t line = 0; line < lines; ++line) K::template body<float>(line, ports);
    return ports.suspect_count.value;
  };
  const std::uint32_t count = eight ? run(FindSuspects<true>{}) : run(FindSuspects<false>{});
  fresh_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t found = found_[i];
    const std::uint32_t x = found % (width_ + 2) - 1;
    const std::uint32_t y = found / (width_ + 2) - 1;
    std::uint32_t before = rounds_[found - ahead];
    if (eight) {
      before = std::max(
          {before, std::uint32_t{rounds_[found - ahead - across]}, std::uint32_t{rounds_[found - ahead + across]}});
    }
    constexpr std::uint32_t kMost = std::numeric_limits<std::uint16_t>::max();
    rounds_[found] = static_cast<std::uint16_t>(std::min(before + 1, kMost));
    fresh_.push_back({y / side_ * across_ + x / side_, rounds_[found], x, y});
  }
}

void PostCorrection::apply_results(const SuspectResults& found) {
  for (std::size_t i = 0; i < fresh_.size(); ++i) {
    const Suspect& s = fresh_[i];
    identities_[sample_index(s.x, s.y)] = found.identities[i];
    colours_[std::size_t{s.y} * width_ + s.x] = found.colours[i];
  }
  all_.insert(all_.end(), fresh_.begin(), fresh_.end());
}

void PostCorrection::end_scan() {
  std::ranges::stable_sort(all_, {}, [](const Suspect& s) { return std::tuple(s.tile, s.round); });
}

std::span<const PostCorrection::Suspect> PostCorrection::suspects_of(std::uint32_t tile) const {
  const auto first = std::ranges::lower_bound(all_, tile, {}, &Suspect::tile);
  return {first, std::ranges::upper_bound(first, all_.end(), tile, {}, &Suspect::tile)};
}

namespace {

constexpr std::uint32_t kRecordBytes =
    sizeof(GeometryRecord<float>) + sizeof(SurfaceRecord<float>) + sizeof(ColourRecord<float>);

BlockSetup block_setup(const UndersampleConfig& undersample) {
  BlockSetup setup{.grid = undersample.pixel_grid_side(),
                   .block = undersample.block,
                   .whole = undersample.block,
                   .record_bytes = kRecordBytes,
                   .faint = largest_faint_channel(static_cast<float>(undersample.colour))};
  setup.before_check_y.surfaces = true;
  setup.after_check_y.geometry = undersample.correction != Correction::kOff;
  return setup;
}

}  // namespace

UndersampleProgram::UndersampleProgram(const traces::MemoryImage& image, const traces::Camera& camera,
                                       const RenderConfig& config, const UndersampleConfig& undersample,
                                       float scene_size, std::uint32_t frame)
    : FrameProgram(config.width, config.height),
      undersample_(undersample),
      blocks_(image, camera, config, undersample, block_setup(undersample), frame),
      apart_(static_cast<float>(undersample.position) * scene_size),
      correction_(undersample, config.width * undersample.pixel_grid_side(),
                  config.height * undersample.pixel_grid_side(), blocks_.tiles.tile_side()) {
  blocks_.allocate_counts(mutable_sampling());
}

void UndersampleProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                  TileResult& out) const {
  if (tile_index >= blocks_.tiles.tile_count()) return run_scan(tile_index, tracer, record, out);
  BlockTile tile(blocks_, tile_index, tracer, record, out, [this](std::uint32_t) { return undersample_.block; });
  const auto resolve = [&](const BlockLines& lines) {
    if (lines.samples == 0) return;
    const Verdict verdict = check_samples(tile, lines);
    const std::uint32_t checked = verdict.passed + verdict.failed;
    if (verdict.passed != 0 && lines.along_y) {
      tile.wave.shade_interpolated<true>(lines.uniforms, verdict.passed, checked, verdict.node);
    } else if (verdict.passed != 0) {
      tile.wave.shade_interpolated<false>(lines.uniforms, verdict.passed, checked, verdict.node);
    }
    tile.trace_failed_samples(lines, verdict);
  };

  tile.trace_references();
  tile.export_right_border();  // exported before the imports, which keeps chains of waiting tiles short
  tile.import_left_halo();
  tile.spill_references_to_dram();
  resolve(tile.lines_along_x());
  tile.export_lower_border();
  tile.import_upper_halo(resolve);
  tile.spill_reference_rows_to_dram();
  resolve(tile.lines_along_y());
  average_pixels(tile);
  tile.finish();
}

/// Checks samples for similarity. Similarity checks that no sample of the scene or tile can fail are omitted.
Verdict UndersampleProgram::check_samples(BlockTile& tile, const BlockLines& lines) const {
  const bool has_textures = !blocks_.scene.fuses || blocks_.scene.has_textures;
  const bool has_colours = !blocks_.scene.fuses || tile.coloured != 0;
  const auto along = [&]<bool kTextures, bool kColours> {
    return lines.along_y ? launch_check<CheckAttributes<true, kTextures, kColours>>(tile, lines)
                         : launch_check<CheckAttributes<false, kTextures, kColours>>(tile, lines);
  };
  if (has_colours) {
    return has_textures ? along.template operator()<true, true>() : along.template operator()<false, true>();
  }
  return has_textures ? along.template operator()<true, false>() : along.template operator()<false, false>();
}

template <class K>
Verdict UndersampleProgram::launch_check(BlockTile& tile, const BlockLines& lines) const {
  const auto colour = static_cast<float>(undersample_.colour);
  typename K::template Ports<float> ports;
  ports.line = lines.uniforms;
  ports.apart_squared = apart_ * apart_;
  ports.least_dot = static_cast<float>(undersample_.normal);
  ports.texture = static_cast<float>(undersample_.texture);
  ports.colour_squared = colour * colour;
  const Wavefront::Node node = tile.graph.launch<K>(ports, lines.samples);
  tile.graph.wait_for_record_writers(node);
  return {node, ports.passed_count.value, ports.failed_count.value};
}

/// Averages the samples of each pixel. With post-correction, also writes the identity words of the samples to memory.
void UndersampleProgram::average_pixels(BlockTile& tile) const {
  if (correction_.scan_count() == 0) return tile.average_pixels();
  const auto store = [&]<class Shadows, class Plain>(std::type_identity<Shadows>, std::type_identity<Plain>) {
    return undersample_.correct_shadows ? store_identity_words<Shadows>(tile) : store_identity_words<Plain>(tile);
  };
  using std::type_identity;
  if (tile.can_pack_samples()) {
    tile.write_packed_pixels(store(type_identity<PackIdentified<true>>{}, type_identity<PackIdentified<false>>{}));
  } else {
    store(type_identity<StoreIdentities<true>>{}, type_identity<StoreIdentities<false>>{});
    tile.average_pixels();
  }
}

/// Launches kernel K, which stores for each sample, in the tile buffer, a word that identifies what the sample shows.
/// Then adds the transfer of these words to memory.
template <class K>
Wavefront::Node UndersampleProgram::store_identity_words(BlockTile& tile) const {
  typename K::template Ports<float> ports;
  if constexpr (requires { ports.lattice; }) {
    ports.lattice = blocks_.own_sample_lattice(tile.at);
  } else {
    ports_of<TakeGridSample>(ports).lattice = blocks_.own_sample_lattice(tile.at);
    ports_of<typename K::Identities>(ports).lattice = blocks_.own_sample_lattice(tile.at);
  }
  const std::uint32_t samples = tile.at.width * tile.at.height;
  const Wavefront::Node node = tile.graph.launch<K>(ports, samples);
  tile.graph.wait_for_record_writers(node);
  const Wavefront::Node out = tile.graph.add_transfer(traces::Region::kSamples, true, scan_address(tile.at.index),
                                                      samples * scan_bytes_per_sample());
  tile.graph.wait_for_all(out, node);
  tile.graph.wait_for_colour_writers(out);
  tile.out.shown.clear();
  for (std::uint32_t i = 0; i < samples; ++i) {
    const std::uint32_t sample = (i / tile.at.width + 1) * blocks_.row_pitch() + i % tile.at.width + 1;
    tile.out.shown.push_back({tile.buffer.checks.identities[i], tile.out.averaged_colour(sample)});
  }
  return node;
}

using traces::Region;

namespace {

constexpr std::uint32_t kWordBytes = sizeof(WordRecord<float>);
constexpr std::uint32_t kScanned = 0;  // border number for all identity words that a scan has corrected in a tile
constexpr auto kPicture = static_cast<std::size_t>(Region::kPicture);
constexpr auto kSamples = static_cast<std::size_t>(Region::kSamples);

/// Returns the number of different pixels to which the samples belong. `samples_per_side`: number of samples along the
/// side of a pixel.
std::uint32_t count_pixels_of(std::span<const PostCorrection::Suspect> suspects, std::uint32_t samples_per_side) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pixels;
  for (const PostCorrection::Suspect& s : suspects) pixels.emplace(s.x / samples_per_side, s.y / samples_per_side);
  return static_cast<std::uint32_t>(pixels.size());
}

}  // namespace

std::uint32_t UndersampleProgram::tiles() const { return blocks_.tiles.tile_count() * (1 + correction_.scan_count()); }

std::uint32_t UndersampleProgram::pass_end(std::uint32_t tile_index) const {
  const std::uint32_t count = blocks_.tiles.tile_count();
  return (tile_index / count + 1) * count;
}

/// Returns the bytes that a scan of post-correction reads per sample: the identity word and, if pixels have several
/// samples, the colour.
std::uint32_t UndersampleProgram::scan_bytes_per_sample() const {
  return kWordBytes + (undersample_.samples > 1 ? static_cast<std::uint32_t>(sizeof(ColourRecord<float>)) : 0);
}

std::uint64_t UndersampleProgram::scan_address(std::uint32_t tile) const {
  const std::uint64_t side = blocks_.tiles.tile_side();
  return blocks_.requirements().region_bytes[kSamples] + tile * side * side * scan_bytes_per_sample();
}

FrameRequirements UndersampleProgram::requirements() const {
  FrameRequirements needs = blocks_.requirements();
  if (correction_.scan_count() > 0) {
    needs.region_bytes[kSamples] = scan_address(blocks_.tiles.tile_count());
    // During a scan, a tile keeps the words of its samples in the tile buffer.
    needs.pass_attribute_bytes = needs.tile_samples * kWordBytes;
  }
  return needs;
}

void UndersampleProgram::begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) {
  const std::uint32_t count = blocks_.tiles.tile_count();
  if (tile_index < count) return;
  const PostCorrection::Scan scan = correction_.scan_direction(scan_number(tile_index));
  TileResult scratch;
  const auto trace = [&](std::span<const PostCorrection::Suspect> suspects) {
    // All samples found in one step are in one column or one row.
    const std::uint32_t pitch = scan.is_along_y ? width() * undersample_.pixel_grid_side() : 1;
    const PostCorrection::Suspect& first = suspects.front();
    const GridUniforms<float> grid = scan.is_along_y ? blocks_.grid_uniforms(0, static_cast<float>(first.y), pitch)
                                                     : blocks_.grid_uniforms(static_cast<float>(first.x), 0, pitch);
    Wavefront wave(blocks_.scene, tracer, false, blocks_.ray_cone(), scratch);
    const auto sample = [&](const PostCorrection::Suspect& s) { return scan.is_along_y ? s.x : s.y; };
    list_suspect_samples(suspects, scratch, sample);
    trace_suspects(wave, scratch, grid, static_cast<std::uint32_t>(suspects.size()), Wavefront::kNone);
    PostCorrection::SuspectResults found;
    for (const PostCorrection::Suspect& s : suspects) {
      const GeometryRecord<float>& geometry = scratch.buffer.samples.geometry[sample(s)];
      const std::uint32_t shown =
          undersample_.correct_shadows ? identity_bits<float, true>(geometry) : identity_bits<float, false>(geometry);
      found.identities.push_back(shown | kTracedSample);
      found.colours.push_back(scratch.averaged_colour(sample(s)));
    }
    return found;
  };
  const std::uint32_t grid = undersample_.pixel_grid_side();
  for (const PostCorrection::Suspect& s : correction_.run_scan(scan, trace)) {
    average_pixel_again(s.x / grid, s.y / grid);
    if (!mutable_marks().empty()) {
      mutable_marks()[std::size_t{s.y} * width() * grid + s.x] = kTracedMark | kCorrectedMark;
    }
  }
}

template <class Sample>
void UndersampleProgram::list_suspect_samples(std::span<const PostCorrection::Suspect> suspects, TileResult& out,
                                              Sample&& sample) const {
  std::uint32_t most = 0;
  for (const PostCorrection::Suspect& s : suspects) most = std::max(most, sample(s));
  out.buffer.reserve_samples(std::max(std::size_t{most} + 1, suspects.size()));
  std::ranges::transform(suspects, out.buffer.checks.samples.entries.begin(), sample);
}

/// Traces the listed samples, which a scan of post-correction has found suspect.
void UndersampleProgram::trace_suspects(Wavefront& wave, TileResult& out, const GridUniforms<float>& grid,
                                        std::uint32_t items, Wavefront::Node lister) const {
  out.buffer.reserve_wave(items);
  GenerateListedRays::Ports<float> generate;
  generate.camera = blocks_.camera;
  generate.grid = grid;
  RetainedRecords retained;
  retained.geometry = true;
  const Wavefront::Node generated =
      wave.generate_listed_rays(generate, out.buffer.checks.samples, lister, items, retained);
  wave.run(generated, items, retained);
}

void UndersampleProgram::average_pixel_again(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t grid = undersample_.pixel_grid_side();
  glm::vec3 sum(0);
  for (std::uint32_t row = 0; row < grid; ++row) {
    for (std::uint32_t column = 0; column < grid; ++column) {
      sum += correction_.sample_colour(x * grid + column, y * grid + row);
    }
  }
  sum *= 1.0F / static_cast<float>(grid * grid);
  float* to = mutable_picture().data() + std::size_t{3} * (std::size_t{y} * width() + x);
  for (int channel = 0; channel < 3; ++channel) to[channel] = sum[channel];
}

void UndersampleProgram::run_scan(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                  TileResult& out) const {
  const std::uint32_t count = blocks_.tiles.tile_count();
  const std::uint32_t number = scan_number(tile_index);
  const PostCorrection::Scan scan = correction_.scan_direction(number);
  const std::uint32_t in_pass = tile_index % count;
  const SampleTile at = blocks_.tiles.sample_tile(blocks_.order[scan.is_backward ? count - 1 - in_pass : in_pass]);
  const std::uint32_t samples = at.width * at.height;
  out.tile = (number + 1) * count + at.index;
  out.x = out.y = out.width = out.height = 0;
  out.marks.clear();
  out.linear.clear();
  out.packed.clear();
  out.sampling = {};
  Wavefront wave(blocks_.scene, tracer, record, blocks_.ray_cone(), out);
  TileGraph& graph = wave.tile_graph();
  out.work.frame = blocks_.number;
  out.work.tile = out.tile;
  out.work.samples = samples;
  out.work.after_all = in_pass == 0;
  const std::uint32_t step = scan.is_along_y ? blocks_.tiles.tiles_across() : 1;
  const bool has_behind = scan.is_along_y ? (scan.is_backward ? at.has_below : at.has_above)
                                          : (scan.is_backward ? at.has_right : at.has_left);
  const auto behind = [&](std::uint32_t tile) { return scan.is_backward ? tile + step : tile - step; };

  const Wavefront::Node in = graph.add_transfer(Region::kSamples, false, scan_address(at.index), samples * 4);
  Wavefront::Node border = Wavefront::kNone;
  if (has_behind) {
    const std::uint32_t words = scan.is_along_y ? at.width : at.height;
    border = graph.import_border({behind(out.tile), kScanned}, scan_address(behind(at.index)), words * 4);
  }
  const Wavefront::Node found = record_suspect_search(graph, samples);
  graph.wait_for_all(found, in);
  graph.wait_for_all(found, border);
  correct_samples(wave, out, at, found);
  wave.finish();
  out.sampling.traced_background = out.background.size();
}

Wavefront::Node UndersampleProgram::record_suspect_search(TileGraph& graph, std::uint32_t items) const {
  return undersample_.neighbours == Neighbourhood::kEight ? graph.record_known_launch<FindSuspects<true>>(items)
                                                          : graph.record_known_launch<FindSuspects<false>>(items);
}

/// Traces the samples that a scan of post-correction corrects in a tile, round by round, and writes the corrected
/// pixels. `found`: launch that found the samples of the first round.
void UndersampleProgram::correct_samples(Wavefront& wave, TileResult& out, const SampleTile& at,
                                         Wavefront::Node found) const {
  TileGraph& graph = wave.tile_graph();
  std::span<const PostCorrection::Suspect> left = correction_.suspects_of(at.index);
  out.sampling.traced = out.sampling.correction = left.size();
  if (left.empty()) return;
  const std::uint32_t pixels = count_pixels_of(left, undersample_.pixel_grid_side());
  const auto corrected = static_cast<std::uint32_t>(left.size());
  const GridUniforms<float> grid =
      blocks_.grid_uniforms(static_cast<float>(at.x) - 1.0F, static_cast<float>(at.y) - 1.0F, blocks_.row_pitch());
  while (!left.empty()) {
    const auto end = std::ranges::find_if(
        left, [&](std::uint32_t round) { return round != left.front().round; }, &PostCorrection::Suspect::round);
    const std::span round = left.first(static_cast<std::size_t>(end - left.begin()));
    left = left.subspan(round.size());
    const auto items = static_cast<std::uint32_t>(round.size());
    list_suspect_samples(round, out, [&](const PostCorrection::Suspect& s) {
      return (s.y - at.y + 1) * blocks_.row_pitch() + s.x - at.x + 1;
    });
    trace_suspects(wave, out, grid, items, found);
    const Wavefront::Node stored = undersample_.correct_shadows
                                       ? graph.record_known_launch<StoreIdentities<true>>(items)
                                       : graph.record_known_launch<StoreIdentities<false>>(items);
    graph.wait_for_record_writers(stored);
    found = record_suspect_search(graph, items);
    graph.wait_for_all(found, stored);
  }
  write_corrected_pixels(graph, at, corrected, pixels, found);
}

/// Averages and encodes the pixels that a scan of post-correction has changed, and writes them and the identity words
/// of their samples. A scattered pixel costs a memory line, and all of them together cost at most the whole tile.
void UndersampleProgram::write_corrected_pixels(TileGraph& graph, const SampleTile& at, std::uint32_t corrected,
                                                std::uint32_t corrected_pixels, Wavefront::Node last) const {
  const std::uint64_t store = scan_address(at.index);
  const std::uint64_t stored = scan_address(at.index + 1) - store;
  Wavefront::Node packed = Wavefront::kNone;
  if (blocks_.scene.fuses && undersample_.samples == 1 && !blocks_.scene.dma_encodes) {
    packed = graph.record_known_launch<PackGridSample>(corrected_pixels);
    graph.wait_for_colour_writers(packed);
  } else {
    const Wavefront::Node averaged = graph.record_known_launch<AverageSamples>(corrected_pixels * undersample_.samples);
    graph.wait_for_colour_writers(averaged);
    if (undersample_.samples > 1) {
      const Wavefront::Node in = graph.add_transfer(
          Region::kSamples, false, store, scattered_bytes(corrected_pixels * undersample_.pixel_grid_side(), stored));
      graph.wait_for_all(averaged, in);
    }
    packed = blocks_.scene.dma_encodes ? averaged : graph.record_known_launch<PackColour>(corrected_pixels);
    if (packed != averaged) graph.wait_for_all(packed, averaged);
  }
  const std::uint64_t pixels = requirements().region_bytes[kPicture] / blocks_.tiles.tile_count();
  graph.wait_for_all(
      graph.add_transfer(Region::kPicture, true, pixels * at.index, scattered_bytes(corrected_pixels, pixels)), packed);
  graph.wait_for_all(graph.export_border(kScanned, store, scattered_bytes(corrected, stored)), last);
}

void UndersampleProgram::commit_tile(const TileResult& tile) {
  if (tile.tile >= blocks_.tiles.tile_count()) return FrameProgram::commit_tile(tile);
  FrameProgram::commit_tile(tile);
  blocks_.count_tile(tile, undersample_.block, mutable_sampling());
  correction_.store_samples(tile, blocks_.tiles.sample_tile(tile.tile));
}

}  // namespace kernels
