#include "shader_kernels/programs/kernel_passes.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

namespace kernels {
namespace {

using Share = PassStream::Share;

/// Returns how many of the `items` of a kernel come before item `item` of the pass.
std::uint64_t items_before(const KernelPass& pass, std::uint64_t items, std::uint64_t item) {
  return items * item / pass.items;
}

}  // namespace

std::uint64_t KernelPass::moved_bytes() const {
  std::uint64_t all = gather.numbers.size() * gather.record_bytes;
  for (const PassStream& stream : streams) {
    const bool by_batch = stream.share == Share::kBatch || stream.share == Share::kAll;
    all += stream.bytes * (by_batch ? entry_count() : 1);
  }
  return all;
}

std::uint64_t KernelPasses::reserve(std::uint64_t bytes) {
  constexpr std::uint64_t kLine = 64;
  const std::uint64_t base = scratch_;
  scratch_ += (bytes + kLine - 1) / kLine * kLine;
  return base;
}

KernelPass* KernelPasses::add(std::uint32_t stage, const char* name, std::vector<PassKernel> kernels,
                              std::uint64_t items, std::vector<PassStream> streams) {
  if (items == 0) return nullptr;
  std::uint64_t per_item = 0, fixed = 0;
  for (const PassStream& stream : streams) {
    const bool by_batch = stream.share == Share::kBatch || stream.share == Share::kAll;
    (by_batch ? fixed : per_item) += by_batch ? stream.bytes : (stream.bytes + items - 1) / items;
  }
  constexpr std::uint64_t kLeastItems = 16;
  const std::uint64_t room = std::max<std::uint64_t>(space_, fixed + kLeastItems * per_item) - fixed;
  const auto batch = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(room / per_item, 1, items));
  const auto next = std::ranges::upper_bound(passes_, stage, {}, &KernelPass::stage);
  return &*passes_.insert(next, {name, std::move(kernels), items, std::move(streams), batch, stage, {}});
}

std::uint32_t KernelPasses::entry_count() const {
  std::uint32_t entries = 0;
  for (const KernelPass& pass : passes_) entries += pass.entry_count();
  return entries;
}

/// Records the lines that items `first` to `end` - 1 read, each by its first word in the record.
void KernelPasses::record_gather(const KernelPass& pass, std::uint64_t first, std::uint64_t end, StreamBuilder& stream,
                                 traces::TileWork& work) const {
  constexpr std::uint64_t kLine = 64;
  for (std::uint64_t item = first; item < end; ++item) {
    stream.begin_item_accesses();
    const std::uint64_t begin = build_offset_ + pass.gather.base + pass.gather.numbers[item] * pass.gather.record_bytes;
    for (std::uint64_t at = begin; at < begin + pass.gather.record_bytes; at = (at / kLine + 1) * kLine) {
      work.accesses.push_back(traces::Access::of_kind(traces::Access::Kind::kStored,
                                                      static_cast<std::uint32_t>(at / traces::kStoredWordBytes)));
    }
  }
}

void KernelPasses::record_entry(std::uint32_t entry, StreamBuilder& stream, traces::TileWork& work) const {
  auto pass = passes_.begin();
  for (; entry >= pass->entry_count(); ++pass) entry -= pass->entry_count();
  work.after_all = entry == 0 && pass != passes_.begin() && pass->stage != std::prev(pass)->stage;
  const std::uint64_t first = std::uint64_t{entry} * pass->batch;
  const std::uint64_t end = std::min(first + pass->batch, pass->items);
  std::vector<StreamBuilder::Node> inputs;
  StreamBuilder::Node launch = StreamBuilder::kNone;
  const auto add_transfer = [&](const PassStream& moved, MemoryPiece piece) {
    if (piece.begin == piece.end) return;
    const StreamBuilder::Node node = stream.add_transfer(moved.region, moved.is_written, moved.base + piece.begin,
                                                         static_cast<std::uint32_t>(piece.end - piece.begin));
    if (moved.is_written) {
      stream.add_wait(node, launch, traces::Edge::Kind::kAll);
    } else {
      inputs.push_back(node);
    }
  };
  const auto add_transfers = [&](const PassStream& moved) {
    switch (moved.share) {
      case Share::kItems:
        return add_transfer(moved, {items_before(*pass, moved.bytes, first), items_before(*pass, moved.bytes, end)});
      case Share::kBatch:
        return add_transfer(moved, {entry * moved.bytes, (entry + 1) * moved.bytes});
      case Share::kAll:
        return add_transfer(moved, {0, moved.bytes});
      case Share::kPieces:
        const std::uint32_t begin = moved.first_piece[entry];
        for (const MemoryPiece& piece : std::span(moved.pieces).subspan(begin, moved.first_piece[entry + 1] - begin)) {
          add_transfer(moved, piece);
        }
    }
  };
  for (const PassStream& moved : pass->streams) {
    if (!moved.is_written) add_transfers(moved);
  }
  for (const PassKernel& k : pass->kernels) {
    const std::uint64_t items = items_before(*pass, k.items, end) - items_before(*pass, k.items, first);
    if (items == 0) continue;
    const StreamBuilder::Node before = launch;
    const bool gathers = &k == &pass->kernels.back() && !pass->gather.numbers.empty();
    launch = stream.add_launch(k.kernel, static_cast<std::uint32_t>(items), gathers);
    if (gathers) record_gather(*pass, first, end, stream, work);
    if (before != StreamBuilder::kNone) stream.add_wait(launch, before, traces::Edge::Kind::kAll);
    for (const StreamBuilder::Node input : inputs) stream.add_wait(launch, input, traces::Edge::Kind::kAll);
  }
  for (const PassStream& moved : pass->streams) {
    if (moved.is_written) add_transfers(moved);
  }
}

}  // namespace kernels
