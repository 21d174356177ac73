#include "tools/run/frame/kept_work.h"

#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "tools/host/interrupt.h"
#include "traces/trace_file/walk_code.h"

namespace tools {

void KeptWork::add(const traces::TileWork& work) {
  encoded_.clear();
  encoder_.encode(work, scope_.links, encoded_);
  encoded_.resize(encoded_.size() + traces::kBitsPadding);
  bytes_ += encoded_.size();
  if (bytes_ > most_bytes_) {
    throw sim::InputError(
        fmt::format("{}: the frame's work takes more than limits.memory, {} MiB; allowed: a smaller --resolution, "
                    "fewer samples, or a larger limits.memory",
                    kept_for_, most_bytes_ >> 20));
  }
  tiles_.push_back(encoded_);
}

void KeptWork::read(std::uint32_t tile_index, traces::TileDecoder& decoder, traces::TileWork& out) const {
  const std::string_view bytes = tiles_[tile_index];
  decoder.decode(bytes.substr(0, bytes.size() - traces::kBitsPadding), scope_, out);
}

void KeptProgram::run_tile(std::uint32_t tile_index, const traces::Tracer& /*tracer*/, bool /*record*/,
                           kernels::TileResult& out) const {
  if (interrupted()) throw Interrupted{};
  work_.read(tile_index, decoder_, out.work);
  on_tile_();
}

}  // namespace tools
