#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/wavefront/tile_graph.h"
#include "traces/stream.h"

namespace kernels {

/// A range of bytes in a region of memory.
struct MemoryPiece {
  std::uint64_t begin = 0, end = 0;
};

/// Bytes that a pass reads or writes.
struct PassStream {
  /// Which part of the bytes a batch moves.
  enum class Share : std::uint8_t {
    kItems,   ///< the share of its items
    kBatch,   ///< as many bytes for each batch, such as counts of its keys; batches follow each other
    kAll,     ///< all bytes: each batch reads the same
    kPieces,  ///< pieces anywhere in the array, such as runs of sorted keys
  };
  traces::Region region = traces::Region::kBuild;
  bool is_written = false;
  std::uint64_t base = 0;   ///< offset of the first byte within the region
  std::uint64_t bytes = 0;  ///< bytes of all items; those of each batch for kBatch
  Share share = Share::kItems;
  std::vector<MemoryPiece> pieces{};         ///< for kPieces, batch by batch; relative to `base`
  std::vector<std::uint32_t> first_piece{};  ///< for kPieces: each batch's first piece; then the end
};

/// Records of region kBuild that a kernel reads through the data cache, one per item.
struct PassGather {
  std::uint64_t base = 0;
  std::uint64_t record_bytes = 0;
  std::vector<std::uint32_t> numbers{};  ///< record of each item; empty: the pass gathers nothing
};

/// A kernel and its items in all batches of a pass together.
struct PassKernel {
  traces::KernelId kernel = 0;
  std::uint64_t items = 0;
};

/// One pass: kernels that are launched batch by batch.
struct KernelPass {
  const char* name = "";
  std::vector<PassKernel> kernels;
  std::uint64_t items = 0;  ///< items that batches divide
  std::vector<PassStream> streams;
  std::uint32_t batch = 1;  ///< items of one entry of the tile list
  std::uint32_t stage = 0;
  PassGather gather{};  ///< records that the last kernel reads

  std::uint32_t entry_count() const { return static_cast<std::uint32_t>((items + batch - 1) / batch); }
  /// Returns the bytes that all batches read and write, and the records that they gather.
  std::uint64_t moved_bytes() const;
};

/// Passes of kernels over arrays in memory, which precede a frame's tiles.
///
/// 1. Each batch reads its inputs into the tile buffer by transfers, launches its kernels one after the other, and
///    writes its outputs. It is an entry of the tile list.
/// 2. Passes are in order of their stages. A stage begins when the previous one has ended; its passes do not wait for
///    each other.
class KernelPasses {
 public:
  /// `space`: bytes of the tile buffer for a batch. `build_offset`: bytes from the beginning of region kSamples to that
  /// of region kBuild, because accesses of kind kStored name words from the former on.
  KernelPasses(std::uint32_t space, std::uint64_t build_offset) : space_(space), build_offset_(build_offset) {}

  const std::vector<KernelPass>& passes() const { return passes_; }
  std::uint32_t entry_count() const;
  std::uint64_t scratch_bytes() const { return scratch_; }
  /// Records an entry of the tile list: one batch of a pass. Sets `after_all` if the entry begins a stage.
  void record_entry(std::uint32_t entry, StreamBuilder& stream, traces::TileWork& work) const;

  /// Sets aside bytes of region kBuild, and returns the offset of the first.
  std::uint64_t reserve(std::uint64_t bytes);
  /// Adds a pass and returns it; the pointer is valid until the next call. Its batches fit the space, but have 16 items
  /// or more. Without items, no pass is added, and null is returned.
  KernelPass* add(std::uint32_t stage, const char* name, std::vector<PassKernel> kernels, std::uint64_t items,
                  std::vector<PassStream> streams);

 private:
  void record_gather(const KernelPass& pass, std::uint64_t first, std::uint64_t end, StreamBuilder& stream,
                     traces::TileWork& work) const;

  const std::uint32_t space_;
  const std::uint64_t build_offset_;
  std::vector<KernelPass> passes_;
  std::uint64_t scratch_ = 0;
};

/// Stage of the passes that pose geometry, before all builds.
inline constexpr std::uint32_t kPoseStage = 0;

/// Returns a stream of region kBuild that a pass reads, or writes.
inline PassStream read_stream(std::uint64_t base, std::uint64_t bytes,
                              PassStream::Share share = PassStream::Share::kItems) {
  return {.base = base, .bytes = bytes, .share = share};
}
inline PassStream write_stream(std::uint64_t base, std::uint64_t bytes,
                               PassStream::Share share = PassStream::Share::kItems) {
  return {.is_written = true, .base = base, .bytes = bytes, .share = share};
}

}  // namespace kernels
