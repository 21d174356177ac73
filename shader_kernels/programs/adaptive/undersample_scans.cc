#include <algorithm>
#include <set>
#include <utility>

#include "shader_kernels/programs/adaptive/undersample.h"

namespace kernels {

using traces::Region;

namespace {

constexpr std::uint32_t kWordBytes = sizeof(WordRecord<float>);
constexpr std::uint32_t kScanned = 0;  // the border of a tile that others read in a scan: all words that it corrects
constexpr auto kPicture = static_cast<std::size_t>(Region::kPicture);
constexpr auto kSamples = static_cast<std::size_t>(Region::kSamples);

/// Number of pixels that samples belong to.
std::uint32_t pixels_of(std::span<const PostCorrection::Suspect> suspects, std::uint32_t grid) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pixels;
  for (const PostCorrection::Suspect& s : suspects) pixels.emplace(s.x / grid, s.y / grid);
  return static_cast<std::uint32_t>(pixels.size());
}

}  // namespace

std::uint32_t UndersampleProgram::tiles() const { return sample_tiles().count() * (1 + correction_.scans()); }

std::uint32_t UndersampleProgram::pass_end(std::uint32_t tile_index) const {
  const std::uint32_t count = sample_tiles().count();
  return (tile_index / count + 1) * count;
}

/// A sample's word for the scans; where pixels have several samples, their colours too, to average them again.
std::uint32_t UndersampleProgram::scanned_bytes() const {
  return kWordBytes + (undersample_.samples > 1 ? static_cast<std::uint32_t>(sizeof(ColourRecord<float>)) : 0);
}

std::uint64_t UndersampleProgram::scan_store(std::uint32_t tile) const {
  const std::uint64_t side = sample_tiles().side();
  return BlockProgram::requirements().region_bytes[kSamples] + tile * side * side * scanned_bytes();
}

FrameRequirements UndersampleProgram::requirements() const {
  FrameRequirements needs = BlockProgram::requirements();
  if (correction_.scans() > 0) {
    needs.region_bytes[kSamples] = scan_store(sample_tiles().count());
    // A tile of a scan keeps its samples' words.
    needs.pass_attribute_bytes = needs.tile_samples * kWordBytes;
  }
  return needs;
}

void UndersampleProgram::begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) {
  const std::uint32_t count = sample_tiles().count();
  if (tile_index < count) return;
  const PostCorrection::Scan scan = correction_.scan(scan_of(tile_index));
  TileResult scratch;
  const auto trace = [&](std::span<const PostCorrection::Suspect> suspects) {
    // All suspects of a step lie in one column, or in one row.
    const std::uint32_t pitch = scan.is_along_y ? width() * undersample_.grid() : 1;
    const PostCorrection::Suspect& first = suspects.front();
    const GridUniforms<float> grid = scan.is_along_y ? grid_uniforms(0, static_cast<float>(first.y), pitch)
                                                     : grid_uniforms(static_cast<float>(first.x), 0, pitch);
    Wavefront wave(scene(), tracer, false, cone(), scratch);
    const auto sample = [&](const PostCorrection::Suspect& s) { return scan.is_along_y ? s.x : s.y; };
    list_suspects(suspects, scratch, sample);
    trace_suspects(wave, scratch, grid, static_cast<std::uint32_t>(suspects.size()), Wavefront::kNone);
    PostCorrection::Found found;
    for (const PostCorrection::Suspect& s : suspects) {
      const GeometryRecord<float>& geometry = scratch.buffer.geometry[sample(s)];
      const std::uint32_t shown =
          undersample_.correct_shadows ? shown_by<float, true>(geometry) : shown_by<float, false>(geometry);
      found.identities.push_back(shown | kTracedSample);
      found.colours.push_back(scratch.colour(sample(s)));
    }
    return found;
  };
  const std::uint32_t grid = undersample_.grid();
  for (const PostCorrection::Suspect& s : correction_.run(scan, trace)) {
    average_again(s.x / grid, s.y / grid);
    if (!kept_marks().empty()) {
      kept_marks()[std::size_t{s.y} * width() * grid + s.x] = kTracedMark | kCorrectedMark;
    }
  }
}

template <class Sample>
void UndersampleProgram::list_suspects(std::span<const PostCorrection::Suspect> suspects, TileResult& out,
                                       Sample&& sample) const {
  std::uint32_t most = 0;
  for (const PostCorrection::Suspect& s : suspects) most = std::max(most, sample(s));
  out.buffer.hold_samples(std::max(std::size_t{most} + 1, suspects.size()));
  std::ranges::transform(suspects, out.buffer.samples.begin(), sample);
}

/// Traces the listed samples.
void UndersampleProgram::trace_suspects(Wavefront& wave, TileResult& out, const GridUniforms<float>& grid,
                                        std::uint32_t items, Wavefront::Node lister) const {
  out.buffer.hold_wave(items);
  GenerateListedRays::Ports<float> generate;
  generate.camera = camera();
  generate.grid = grid;
  Wavefront::RetainedRecords retained;
  retained.geometry = true;
  const Wavefront::Node generated = wave.generate(generate, out.buffer.samples, lister, items, retained);
  wave.run(generated, items, retained);
}

void UndersampleProgram::average_again(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t grid = undersample_.grid();
  glm::vec3 sum(0);
  for (std::uint32_t row = 0; row < grid; ++row) {
    for (std::uint32_t column = 0; column < grid; ++column) {
      sum += correction_.colour(x * grid + column, y * grid + row);
    }
  }
  sum *= 1.0F / static_cast<float>(grid * grid);
  float* to = kept_picture().data() + std::size_t{3} * (std::size_t{y} * width() + x);
  for (int channel = 0; channel < 3; ++channel) to[channel] = sum[channel];
}

void UndersampleProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                  TileResult& out) const {
  if (tile_index < sample_tiles().count()) {
    BlockProgram::run_tile(tile_index, tracer, record, out);
  } else {
    run_scan(tile_index, tracer, record, out);
  }
}

void UndersampleProgram::run_scan(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                                  TileResult& out) const {
  const std::uint32_t count = sample_tiles().count();
  const std::uint32_t number = scan_of(tile_index);
  const PostCorrection::Scan scan = correction_.scan(number);
  const std::uint32_t in_pass = tile_index % count;
  const SampleTile at = sample_tiles().tile(order()[scan.is_backward ? count - 1 - in_pass : in_pass]);
  const std::uint32_t samples = at.width * at.height;
  out.tile = (number + 1) * count + at.index;
  out.x = out.y = out.width = out.height = 0;
  out.marks.clear();
  out.linear.clear();
  out.packed.clear();
  out.sampling = {};
  Wavefront wave(scene(), tracer, record, cone(), out);
  out.work.frame = frame();
  out.work.tile = out.tile;
  out.work.samples = samples;
  out.work.after_all = in_pass == 0;
  const std::uint32_t step = scan.is_along_y ? sample_tiles().across() : 1;
  const bool has_behind = scan.is_along_y ? (scan.is_backward ? at.has_below : at.has_above)
                                          : (scan.is_backward ? at.has_right : at.has_left);
  const auto behind = [&](std::uint32_t tile) { return scan.is_backward ? tile + step : tile - step; };

  const Wavefront::Node in = wave.transfer(Region::kSamples, false, scan_store(at.index), samples * 4);
  Wavefront::Node border = Wavefront::kNone;
  if (has_behind) {
    const std::uint32_t words = scan.is_along_y ? at.width : at.height;
    border = wave.import_border({behind(out.tile), kScanned}, scan_store(behind(at.index)), words * 4);
  }
  const Wavefront::Node found = note_search(wave, samples);
  wave.wait_all(found, in);
  wave.wait_all(found, border);
  correct(wave, out, at, found);
  wave.finish();
  out.sampling.traced_background = out.background.size();
}

Wavefront::Node UndersampleProgram::note_search(Wavefront& wave, std::uint32_t items) const {
  return undersample_.neighbours == Neighbourhood::kEight ? wave.note<FindSuspects<true>>(items)
                                                          : wave.note<FindSuspects<false>>(items);
}

/// Traces a tile's suspects, round by round, and puts out what that changes. `found`: the first search.
void UndersampleProgram::correct(Wavefront& wave, TileResult& out, const SampleTile& at, Wavefront::Node found) const {
  std::span<const PostCorrection::Suspect> left = correction_.suspects_of(at.index);
  out.sampling.traced = out.sampling.correction = left.size();
  if (left.empty()) return;
  const std::uint32_t pixels = pixels_of(left, undersample_.grid());
  const auto corrected = static_cast<std::uint32_t>(left.size());
  const GridUniforms<float> grid =
      grid_uniforms(static_cast<float>(at.x) - 1.0F, static_cast<float>(at.y) - 1.0F, pitch());
  while (!left.empty()) {
    const auto end = std::ranges::find_if(
        left, [&](std::uint32_t round) { return round != left.front().round; }, &PostCorrection::Suspect::round);
    const std::span round = left.first(static_cast<std::size_t>(end - left.begin()));
    left = left.subspan(round.size());
    const auto items = static_cast<std::uint32_t>(round.size());
    list_suspects(round, out,
                  [&](const PostCorrection::Suspect& s) { return (s.y - at.y + 1) * pitch() + s.x - at.x + 1; });
    trace_suspects(wave, out, grid, items, found);
    const Wavefront::Node stored = undersample_.correct_shadows ? wave.note<StoreIdentities<true>>(items)
                                                                : wave.note<StoreIdentities<false>>(items);
    wave.wait_for_records(stored);
    found = note_search(wave, items);
    wave.wait_all(found, stored);
  }
  put_corrected(wave, at, corrected, pixels, found);
}

/// Averages and encodes the corrected pixels and writes them and their words: each a line of its own, as long as those
/// are not more than all of the tile's.
void UndersampleProgram::put_corrected(Wavefront& wave, const SampleTile& at, std::uint32_t corrected,
                                       std::uint32_t corrected_pixels, Wavefront::Node last) const {
  const std::uint64_t store = scan_store(at.index);
  const std::uint64_t stored = scan_store(at.index + 1) - store;
  Wavefront::Node packed = Wavefront::kNone;
  if (wave.fuses() && undersample_.samples == 1 && !wave.dma_encodes()) {
    packed = wave.note<PackGridSample>(corrected_pixels);
    wave.wait_for_colours(packed);
  } else {
    const Wavefront::Node averaged = wave.note<AverageSamples>(corrected_pixels * undersample_.samples);
    wave.wait_for_colours(averaged);
    if (undersample_.samples > 1) {
      const Wavefront::Node in = wave.transfer(Region::kSamples, false, store,
                                               scattered_bytes(corrected_pixels * undersample_.grid(), stored));
      wave.wait_all(averaged, in);
    }
    packed = wave.dma_encodes() ? averaged : wave.note<PackColour>(corrected_pixels);
    if (packed != averaged) wave.wait_all(packed, averaged);
  }
  const std::uint64_t pixels = requirements().region_bytes[kPicture] / sample_tiles().count();
  wave.wait_all(wave.transfer(Region::kPicture, true, pixels * at.index, scattered_bytes(corrected_pixels, pixels)),
                packed);
  wave.wait_all(wave.export_border(kScanned, store, scattered_bytes(corrected, stored)), last);
}

void UndersampleProgram::keep(const TileResult& tile) {
  if (tile.tile >= sample_tiles().count()) return FrameProgram::keep(tile);
  BlockProgram::keep(tile);
  correction_.keep(tile, sample_tiles().tile(tile.tile));
}

}  // namespace kernels
