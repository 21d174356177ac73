#include "tools/sampling/slice_player.h"

#include <numeric>

#include "sim/host_clock.h"
#include "tools/run/frame/machine_run.h"

namespace tools {

void MachineSpan::subtract_mark(const Mark& earlier) {
  time -= earlier.time;
  sim::subtract_reports(units, earlier.units);
  for (std::size_t k = 0; k < kernels.size(); ++k) kernels[k] -= earlier.kernels[k];
}

void MachineSpan::add(const MachineSpan& other) {
  time += other.time;
  sim::add_reports(units, other.units);
  for (std::size_t k = 0; k < kernels.size(); ++k) kernels[k] += other.kernels[k];
}

SlicePlayer::SlicePlayer(const Inputs& inputs, const kernels::FrameProgram& frame)
    : inputs_(inputs),
      requirements_(frame.requirements()),
      tiles_(frame.tiles()),
      shape_(slice_shape(*inputs.config.gpu, requirements_)),
      scheduled_(std::make_shared<const hw::ScheduledKernels>(hw::schedule_kernels(*inputs.config.gpu))) {}

std::unique_ptr<hw::Gpu> SlicePlayer::make_machine(hw::TileSource& tiles) const {
  return make_gpu(inputs_, inputs_.config, requirements_, tiles, {}, {}, scheduled_);
}

MachineSpan SlicePlayer::initial_state() const {
  NoTiles none;
  return MachineSpan(*make_machine(none));
}

PlayedSlice SlicePlayer::run_slice(SharedFrame& frame, const traces::Tracer& tracer, const Slice& slice,
                                   std::uint32_t workers) const {
  const double begin = sim::thread_seconds();
  SliceProgram program(frame, slice);
  const bool is_last = slice.end == tiles_;
  std::vector<std::uint32_t> tile_indices((is_last ? slice.end : slice.end + 1) - slice.begin());
  std::iota(tile_indices.begin(), tile_indices.end(), slice.begin());
  FrontEnd front_end(program, tracer, workers, true, std::move(tile_indices));
  std::vector<std::uint32_t> marked;
  if (slice.first != 0) marked = {slice.first - shape_.probe, slice.first};
  if (!is_last) marked.insert(marked.end(), {slice.end - shape_.probe, slice.end});
  std::optional<std::uint32_t> stop_at;
  if (!is_last) stop_at = slice.end;
  TimedTiles tiles(front_end, {{slice.lead_begin(), slice.first, is_last ? slice.end : slice.end + 1, slice.warming}},
                   std::move(marked), stop_at);
  const auto gpu = make_machine(tiles);
  tiles.set_gpu(*gpu);
  run_to_end(*gpu);

  PlayedSlice played;
  played.slice = slice;
  played.own = is_last ? MachineSpan(*gpu) : MachineSpan(tiles.mark_at(slice.end));
  if (slice.first != 0) {
    played.own.subtract_mark(tiles.mark_at(slice.first));
    played.before = measure_probe(tiles, slice.first);
  }
  if (!is_last) played.after = measure_probe(tiles, slice.end);
  frame.add_times(front_end.result());
  played.seconds = sim::thread_seconds() - begin;
  played.timing_seconds = played.seconds - tiles.making_seconds();
  return played;
}

Probe SlicePlayer::measure_probe(const TimedTiles& tiles, std::uint32_t border) const {
  MachineSpan stretch(tiles.mark_at(border));
  stretch.subtract_mark(tiles.mark_at(border - shape_.probe));
  return {static_cast<double>(stretch.time), energy_of(stretch.units, stretch.time, inputs_.config).total_pj.nominal};
}

}  // namespace tools
