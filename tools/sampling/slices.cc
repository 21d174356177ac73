#include "tools/sampling/slices.h"

#include <algorithm>
#include <charconv>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "shader_kernels/programs/full.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/printable.h"
#include "tools/host/on_threads.h"
#include "tools/sampling/pilot.h"
#include "tools/sampling/slice_file.h"
#include "tools/sampling/slice_play.h"
#include "tools/sampling/slice_sum.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {
namespace {

/// Automatic length of slices in leads: leads cost less than a tenth, in small frames up to 15 %.
constexpr std::uint32_t kTilesOfALead = 10;

/// Simulates all slices, `threads` at a time. Further threads render ahead.
std::vector<PlayedSlice> play_all(const SlicePlayer& player, SharedFrame& frame, const traces::Tracer& tracer,
                                  std::span<const Slice> slices, std::uint32_t threads) {
  const std::uint32_t at_once = std::min(threads, static_cast<std::uint32_t>(slices.size()));
  std::vector<PlayedSlice> played(slices.size());
  do_all(slices.size(), at_once, [&](std::size_t i, std::size_t thread) {
    const std::uint32_t workers = threads / at_once - 1 + (thread < threads % at_once ? 1 : 0);
    played[i] = player.play(frame, tracer, slices[i], workers);
  });
  return played;
}

kernels::FullProgram frame_of(const Inputs& inputs, const kernels::ProgramSpec& program) {
  return {inputs.image, inputs.camera, inputs.config.render, program.samples, inputs.frame};
}

void check_can_cut(const kernels::RenderConfig& render) {
  if (render.primary != kernels::Primary::kRays) {
    throw sim::InputError(
        "--slices: all tiles wait for a rasteriser's geometry pass, which no slice has; allowed: render.primary=rays");
  }
  if (render.effect_rate != kernels::EffectRate::kFull) {
    throw sim::InputError(
        "--slices: tiles wait for what effects found in others, of other slices; allowed: render.effect_rate=full");
  }
}

/// A frame, its program and tracer, and its slices.
struct CutFrame {
  CutFrame(const Inputs& inputs, const kernels::ProgramSpec& spec, std::uint32_t threads, std::uint32_t slices)
      : tracer(inputs.image),
        program(frame_of(inputs, spec)),
        player(inputs, program),
        plan(plan_slices(guess_costs(inputs, spec, tracer, threads), slices, player.shape())) {}

  const traces::BvhTracer tracer;
  kernels::FullProgram program;
  const SlicePlayer player;
  const std::vector<Slice> plan;
};

}  // namespace

std::uint32_t parse_slices(const std::string& text) {
  if (text == "auto") return kAutoSlices;
  std::uint32_t slices = 0;
  const char* end = text.data() + text.size();
  const auto [rest, bad] = std::from_chars(text.data(), end, slices);
  if (bad == std::errc{} && rest == end && slices != 0) return slices;
  throw sim::InputError(
      fmt::format("--slices '{}' is neither a number from 1 on, e.g. 2, nor auto", sim::printable(text)));
}

void check_slices(const kernels::ProgramSpec& program) {
  if (program.kind == kernels::ProgramSpec::Kind::kFull) return;
  throw sim::InputError(fmt::format(
      "--slices: tiles of {} wait for what their neighbours found, which may be in other slices; allowed: full:N",
      program.name()));
}

std::uint32_t slices_of(const RunConfig& config, const kernels::ProgramSpec& program, std::uint32_t asked) {
  check_can_cut(config.render);
  const traces::MemoryImage no_scene;  // the tiles do not depend on the scene
  const kernels::FullProgram frame(no_scene, {}, config.render, program.samples, 0);
  const SliceShape shape = slice_shape(*config.gpu, frame.requirements());
  if (asked == kAutoSlices) return std::max(1U, frame.tiles() / (kTilesOfALead * shape.lead));
  const std::uint32_t most = std::max(1U, frame.tiles() / shape.lead);
  if (asked <= most) return asked;
  throw sim::InputError(
      fmt::format("--slices {}: too many for a frame of {} tile{}, as each slice needs {} to fill this machine; "
                  "allowed: at most {}",
                  asked, frame.tiles(), frame.tiles() == 1 ? "" : "s", shape.lead, most));
}

FrameResult simulate_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                            std::uint32_t slices, Progress* progress) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  threads = host_threads(threads);
  CutFrame cut(inputs, program, threads, slices);
  if (progress != nullptr) progress->begin_part("simulating", inputs.frame, cut.program.tiles());
  SharedFrame frame(cut.program, progress);
  std::vector<PlayedSlice> played = play_all(cut.player, frame, cut.tracer, cut.plan, threads);
  FrameResult s = add_up(cut.player, program, frame.take_function(), std::move(played));
  s.wall_seconds = sim::seconds_since(begin);
  return s;
}

sim::Json simulate_slice(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                         std::uint32_t slices, std::uint32_t index) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  threads = host_threads(threads);
  CutFrame cut(inputs, program, threads, slices);
  SharedFrame frame(cut.program, nullptr);
  SlicePart part;
  part.played = cut.player.play(frame, cut.tracer, cut.plan.at(index), threads - 1);
  part.function = frame.take_function();
  part.wall_seconds = sim::seconds_since(begin);
  return slice_json(part);
}

FrameResult join_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::span<const sim::Json> slices) {
  const SlicePlayer player(inputs, frame_of(inputs, program));
  const Stretch nothing = player.nothing();
  std::vector<PlayedSlice> played;
  FrontEnd::Result function;
  double wall_seconds = 0;
  std::uint32_t next = 0;
  const auto read = [&](const sim::Json& slice) {
    try {
      return read_slice(slice, nothing);
    } catch (const sim::InputError& error) {
      throw sim::InputError(fmt::format("slice {}: {}", played.size() + 1, error.what()));
    }
  };
  for (const sim::Json& slice : slices) {
    SlicePart part = read(slice);
    const bool follows = part.played.slice.first == next && part.played.slice.end > next;
    next = part.played.slice.end;
    if (!follows || (next == player.tiles()) != (played.size() + 1 == slices.size())) {
      throw sim::InputError(fmt::format("slice {}: its tiles do not follow those before it", played.size() + 1));
    }
    function.add(part.function);
    wall_seconds += part.wall_seconds;
    played.push_back(std::move(part.played));
  }
  FrameResult s = add_up(player, program, std::move(function), std::move(played));
  s.wall_seconds = wall_seconds;
  return s;
}

SlicedFrame uncut(const FrameResult& s) {
  return {.tiles = s.tiles,
          .cycles = {static_cast<double>(s.cycles), 0, 0},
          .energy_pj = {s.energy.total_pj.nominal, 0, 0},
          .seconds = {}};
}

void SlicedFrame::add(const SlicedFrame& other) {
  tiles += other.tiles;
  again += other.again;
  warmed += other.warmed;
  cycles.add(other.cycles);
  energy_pj.add(other.energy_pj);
  for (std::size_t i = 0; i < seconds.size(); ++i) seconds[i] += other.seconds[i];
  timing_seconds += other.timing_seconds;
}

}  // namespace tools
