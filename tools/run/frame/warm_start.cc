#include "tools/run/frame/warm_start.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <utility>
#include <vector>

#include "tools/host/interrupt.h"
#include "tools/run/frame/front_end.h"

namespace tools {
namespace {

/// View of a frame program that executes tiles and leaves the program as it is. Throws Interrupted.
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

/// Warms caches with the tiles of a front end from entry `first` on. Tiles go to cores round robin.
void warm_from(hw::Gpu& gpu, FrontEnd& front_end, std::uint32_t first) {
  std::uint32_t core = 0, index = 0;
  while (const traces::TileWork* work = front_end.next()) {
    if (index++ >= first) {
      gpu.warm_caches(*work, core);
      core = core + 1 == gpu.core_count() ? 0 : core + 1;
    }
    front_end.give_back(work);
  }
}

}  // namespace

static std::uint32_t tiles_that_fill_caches() {
  const char* text = std::getenv("RAYWATT_TAIL");
  return text != nullptr ? static_cast<std::uint32_t>(std::atoi(text)) : 1U << 30;
}

void warm_with_last_tiles(hw::Gpu& gpu, kernels::FrameProgram& frame, const traces::Tracer& tracer,
                          std::uint32_t workers) {
  const std::uint32_t tiles = tiles_that_fill_caches();
  const std::uint32_t first = frame.tiles() - std::min(tiles, frame.tiles());
  if (!has_one_pass(frame)) {
    FrontEnd front_end(frame, tracer, workers);
    return warm_from(gpu, front_end, first);
  }
  std::vector<std::uint32_t> last(frame.tiles() - first);
  std::iota(last.begin(), last.end(), first);
  UncommittedTiles program(frame);
  FrontEnd front_end(program, tracer, workers, true, std::move(last));
  warm_from(gpu, front_end, 0);
}

}  // namespace tools
