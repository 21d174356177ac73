#include "tools/run/frame/replay_program.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "tools/run/frame/recorded.h"

namespace tools {

ReplayProgram::ReplayProgram(const traces::TraceReader& trace, const traces::TraceReader::Part& part,
                             const traces::TileScope& scope, std::span<const traces::KernelId> kernels)
    : FrameProgram(0, 0), trace_(trace), part_(part), scope_(scope), kernels_(kernels), tiles_(trace.tiles(part)) {
  FrontEnd::Result result = trace.naming_file([&] { return result_of(part.result); });
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
  const traces::TileRays rays = trace_.naming_file([&] {
    try {
      return cursor->read(tiles_[tile_index], scope_, out.work);
    } catch (const sim::InputError& error) {
      throw sim::InputError(fmt::format("frame {}, tile {} of the list: {}", part_.frame, tile_index, error.what()));
    }
  });
  for (traces::WorkNode& node : out.work.nodes) {
    if (node.kind == traces::WorkNode::Kind::kLaunch) node.kernel = kernels_[node.kernel];
  }
  out.tile = out.work.tile;
  std::ranges::copy(rays.by_kind, out.rays.begin());
  out.traversal_steps = rays.steps.all();
  out.triangle_tests = rays.steps.tests;
  out.continued = tile_index == 0 ? continued_ : 0;
  const std::lock_guard lock(mutex_);
  cursors_.push_back(std::move(cursor));
}

void ReplayProgram::commit_tile(const kernels::TileResult& tile) {
  const traces::TileWork& work = tile.work;
  const auto is_earlier = [&](std::uint32_t t) { return t < seen_.size() && seen_[t]; };
  trace_.naming_file([&] {
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
    trace_.naming_file([&] { throw sim::InputError(fmt::format("frame {} has no rays", part_.frame)); });
  kept_sampling() = sampling_;
}

const traces::TileScope* scope_of(const kernels::FrameProgram& program) {
  const auto* replay = dynamic_cast<const ReplayProgram*>(&program);
  return replay == nullptr ? nullptr : &replay->scope();
}

}  // namespace tools
