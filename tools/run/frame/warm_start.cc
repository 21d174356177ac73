#include "tools/run/frame/warm_start.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "tools/host/process.h"
#include "tools/run/frame/front_end.h"

namespace tools {
namespace {

/// View of a frame program that executes the program's tiles but does not commit the results. Throws Interrupted.
class UncommittedTiles final : public kernels::FrameProgram {
 public:
  explicit UncommittedTiles(const kernels::FrameProgram& frame) : FrameProgram(0, 0), frame_(frame) {}

  std::uint32_t tiles() const override { return frame_.tiles(); }
  kernels::FrameRequirements requirements() const override { return frame_.requirements(); }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override {
    if (is_interrupted()) throw Interrupted{};
    frame_.run_tile(tile_index, tracer, record, out);
  }
  void commit_tile(const kernels::TileResult& /*tile*/) override {}

 private:
  const kernels::FrameProgram& frame_;
};

bool has_one_pass(const kernels::FrameProgram& frame) { return frame.pass_end(0) == frame.tiles(); }

/// Number of tiles in the first attempt to fill the caches, and factor by which each further attempt has more tiles.
constexpr std::uint32_t kFirstTiles = 64, kMoreTiles = 4;
/// Number of L2 fills, divided by the number of lines in all shared caches, after which the lines of earlier tiles are
/// assumed to be evicted.
constexpr std::uint64_t kFillsPerLine = 2;

/// Warms the machine's caches with the tiles of a front end, which are assigned to cores round robin. Returns the
/// number of lines filled into the L2.
std::uint64_t warm_caches_from(hw::Gpu& gpu, FrontEnd& front_end) {
  std::uint64_t filled = 0;
  std::uint32_t core = 0;
  while (const traces::TileWork* work = front_end.next()) {
    filled += gpu.warm_caches(*work, core);
    core = core + 1 == gpu.core_count() ? 0 : core + 1;
    front_end.release_work(work);
  }
  return filled;
}

}  // namespace

void warm_with_last_tiles(hw::Gpu& gpu, kernels::FrameProgram& frame, const traces::Tracer& tracer,
                          std::uint32_t workers) {
  const std::uint32_t all = frame.tiles();
  if (!has_one_pass(frame)) {
    FrontEnd front_end(frame, tracer, workers);
    warm_caches_from(gpu, front_end);
    return;
  }
  const hw::CacheContents empty = gpu.cache_contents();
  for (std::uint32_t tiles = kFirstTiles;; tiles *= kMoreTiles) {
    const std::uint32_t first = all - std::min(tiles, all);
    std::vector<std::uint32_t> last(all - first);
    std::iota(last.begin(), last.end(), first);
    UncommittedTiles program(frame);
    FrontEnd front_end(program, tracer, workers, true, std::move(last));
    const std::uint64_t filled = warm_caches_from(gpu, front_end);
    if (first == 0 || filled >= kFillsPerLine * gpu.shared_line_count()) return;
    gpu.set_cache_contents(empty);
  }
}

}  // namespace tools
