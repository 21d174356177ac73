#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hw_models/frame/tile_dispatcher.h"
#include "traces/trace_file/tile_code.h"

namespace tools {

/// The work of a frame in memory, as a trace would have it, for machines that play it again: some hundred bytes a
/// sample.
class KeptWork {
 public:
  /// InputError from add() beyond `most_bytes`, which names who wants it: an option or a verb.
  KeptWork(traces::TileScope scope, std::uint64_t most_bytes, std::string kept_for)
      : scope_(std::move(scope)), most_bytes_(most_bytes), kept_for_(std::move(kept_for)) {}

  void add(const traces::TileWork& work);
  std::uint32_t tiles() const { return static_cast<std::uint32_t>(tiles_.size()); }
  /// Reads a tile back; threads may, each with a decoder of its own.
  void read(std::uint32_t tile_index, traces::TileDecoder& decoder, traces::TileWork& out) const;

 private:
  const traces::TileScope scope_;
  const std::uint64_t most_bytes_;
  const std::string kept_for_;
  std::uint64_t bytes_ = 0;
  traces::TileEncoder encoder_;
  std::string encoded_;
  std::vector<std::string> tiles_;
};

/// Kept work on its way to one machine. Interrupted from next() after an interrupt by the user.
class KeptTiles final : public hw::TileSource {
 public:
  /// `finished` is called for each tile that the machine has finished.
  KeptTiles(const KeptWork& work, std::function<void()> finished) : work_(work), finished_(std::move(finished)) {}

  const traces::TileWork* next() override;
  void give_back(const traces::TileWork* work) override;

 private:
  using Tile = std::unique_ptr<traces::TileWork>;

  const KeptWork& work_;
  const std::function<void()> finished_;
  traces::TileDecoder decoder_;
  std::uint32_t next_ = 0;
  std::vector<Tile> handed_, spare_;  ///< out in the machine; to be used again
};

}  // namespace tools
