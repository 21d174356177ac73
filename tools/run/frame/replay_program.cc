#include "tools/run/frame/replay_program.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "tools/host/process.h"
#include "tools/run/frame/trace_header.h"
#include "traces/trace_file/walk_code.h"

namespace tools {

ReplayProgram::ReplayProgram(const traces::TraceReader& trace, const traces::TraceReader::Part& part,
                             const traces::TileScope& scope, std::span<const traces::KernelId> kernels)
    : FrameProgram(0, 0), trace_(trace), part_(part), scope_(scope), kernels_(kernels), tiles_(trace.tiles(part)) {
  RenderResult result = trace.add_file_name_to_errors([&] { return parse_recorded_result(part.result); });
  continued_ = result.continued;
  sampling_ = std::move(result.sampling);
}

kernels::FrameRequirements ReplayProgram::requirements() const { return part_.requirements; }

std::unique_ptr<ReplayProgram::Cursor> ReplayProgram::take_cursor() const {
  const std::lock_guard lock(mutex_);
  if (cursors_.empty()) return std::make_unique<Cursor>(trace_);
  std::unique_ptr<Cursor> cursor = std::move(cursors_.back());
  cursors_.pop_back();
  return cursor;
}

void ReplayProgram::run_tile(std::uint32_t tile_index, const traces::Tracer&, bool, kernels::TileResult& out) const {
  std::unique_ptr<Cursor> cursor = take_cursor();
  const traces::TileRays rays = trace_.add_file_name_to_errors([&] {
    try {
      return cursor->read_tile(tiles_[tile_index], scope_, out.work);
    } catch (const sim::InputError& error) {
      throw sim::InputError(fmt::format("frame {}, tile {} of the list: {}", part_.frame, tile_index, error.what()));
    }
  });
  for (traces::WorkNode& node : out.work.nodes) {
    if (node.kind == traces::WorkNode::Kind::kLaunch) node.kernel = kernels_[node.kernel];
  }
  out.tile = out.work.tile;
  std::ranges::copy(rays.by_kind, out.rays.begin());
  out.traversal_steps = rays.steps.total_steps();
  out.triangle_tests = rays.steps.tests;
  out.continued = tile_index == 0 ? continued_ : 0;
  const std::lock_guard lock(mutex_);
  cursors_.push_back(std::move(cursor));
}

void ReplayProgram::commit_tile(const kernels::TileResult& tile) {
  const traces::TileWork& work = tile.work;
  const auto is_earlier = [&](std::uint32_t t) { return t < seen_.size() && seen_[t]; };
  trace_.add_file_name_to_errors([&] {
    if (is_earlier(work.tile)) throw sim::InputError(fmt::format("tile {} is there twice", work.tile));
    if (!std::ranges::all_of(work.imports, is_earlier, &traces::Border::tile)) {
      throw sim::InputError(fmt::format("tile {} imports from one that does not come before it", work.tile));
    }
  });
  if (seen_.size() <= work.tile) seen_.resize(std::size_t{work.tile} + 1);
  seen_[work.tile] = true;
  rays_ += work.ray_begin.size();
  if (++kept_ < part_.tiles) return;
  if (rays_ == 0 && !part_.requirements.raster)
    trace_.add_file_name_to_errors([&] { throw sim::InputError(fmt::format("frame {} has no rays", part_.frame)); });
  mutable_sampling() = sampling_;
}

const traces::TileScope* scope_of(const kernels::FrameProgram& program) {
  const auto* replay = dynamic_cast<const ReplayProgram*>(&program);
  return replay == nullptr ? nullptr : &replay->tile_scope();
}

void InMemoryTrace::add(const traces::TileWork& work) {
  encoded_.clear();
  encoder_.encode_tile(work, scope_.links, encoded_);
  encoded_.resize(encoded_.size() + traces::kBitsPadding);
  bytes_ += encoded_.size();
  if (bytes_ > most_bytes_) {
    throw sim::InputError(
        fmt::format("{}: the frame's work takes more than limits.memory, {} MiB; allowed: a smaller --resolution, "
                    "fewer samples, or a larger limits.memory",
                    requested_by_, most_bytes_ >> 20));
  }
  tiles_.push_back(encoded_);
}

void InMemoryTrace::decode_tile(std::uint32_t tile_index, traces::TileDecoder& decoder, traces::TileWork& out) const {
  const std::string_view bytes = tiles_[tile_index];
  decoder.decode_tile(bytes.substr(0, bytes.size() - traces::kBitsPadding), scope_, out);
}

void InMemoryTraceProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& /*tracer*/, bool /*record*/,
                                    kernels::TileResult& out) const {
  if (is_interrupted()) throw Interrupted{};
  work_.decode_tile(tile_index, decoder_, out.work);
  on_tile_();
}

}  // namespace tools
