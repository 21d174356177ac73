#include "tools/simulation/kept_work.h"

#include <algorithm>
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

const traces::TileWork* KeptTiles::next() {
  if (interrupted()) throw Interrupted{};
  if (next_ == work_.tiles()) return nullptr;
  if (spare_.empty()) spare_.push_back(std::make_unique<traces::TileWork>());
  work_.read(next_++, decoder_, *spare_.back());
  handed_.push_back(std::move(spare_.back()));
  spare_.pop_back();
  return handed_.back().get();
}

void KeptTiles::give_back(const traces::TileWork* work) {
  const auto at = std::ranges::find(handed_, work, &Tile::get);
  spare_.push_back(std::move(*at));
  handed_.erase(at);
  finished_();
}

}  // namespace tools
