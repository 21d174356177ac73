#include "traces/trace_file/packing.h"

#include <algorithm>
#include <new>

#include <fmt/format.h>
#include <zstd.h>

#include "sim/error.h"
#include "traces/trace_file/walk_code.h"

namespace traces {
namespace {

// Limits of a zstd block: largest contents and smallest packed size, in bytes.
constexpr std::uint64_t kMostInBlock = 128U << 10, kLeastOfBlock = 3;

// Start of a zstd frame (RFC 8878, 3.1.1): the magic number, followed by a byte of flags.
constexpr std::string_view kFrameMagic = "\x28\xb5\x2f\xfd";
constexpr unsigned kChecksumFlag = 1U << 2;

[[noreturn]] void throw_damaged() { throw sim::InputError("is damaged"); }

}  // namespace

void Packer::Free::operator()(ZSTD_CCtx_s* context) const { ZSTD_freeCCtx(context); }
void Unpacker::Free::operator()(ZSTD_DCtx_s* context) const { ZSTD_freeDCtx(context); }

Packer::Packer(int level) : context_(ZSTD_createCCtx()) {
  if (!context_) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, level);
  ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_checksumFlag, 1);
}

std::string_view Packer::pack_block(std::string_view bytes) {
  const std::size_t most = ZSTD_compressBound(bytes.size());
  if (packed_.size() < most) packed_.resize(most);
  const std::size_t size = ZSTD_compress2(context_.get(), packed_.data(), packed_.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the only possible error
  return {packed_.data(), size};
}

std::string_view Packer::pack_with_limited_ratio(std::string_view bytes, std::size_t bytes_a_byte) {
  ZSTD_CCtx_setPledgedSrcSize(context_.get(), bytes.size());
  packed_.clear();
  std::string piece(ZSTD_CStreamOutSize(), '\0');
  // A flush after every `most` bytes ends a zstd block, which limits the compression ratio.
  const std::size_t most = (kLeastOfBlock + 1) * bytes_a_byte;
  for (bool is_last = false; !is_last; bytes.remove_prefix(std::min(most, bytes.size()))) {
    is_last = bytes.size() <= most;
    ZSTD_inBuffer from{bytes.data(), std::min(most, bytes.size()), 0};
    for (std::size_t left = 1; left != 0;) {
      ZSTD_outBuffer to{piece.data(), piece.size(), 0};
      left = ZSTD_compressStream2(context_.get(), &to, &from, is_last ? ZSTD_e_end : ZSTD_e_flush);
      if (ZSTD_isError(left) != 0) throw std::bad_alloc();  // the only possible error
      packed_.append(piece, 0, to.pos);
    }
  }
  return packed_;
}

Unpacker::Unpacker() : context_(ZSTD_createDCtx()) {
  if (!context_) throw std::bad_alloc();
}

std::size_t Unpacker::size_of(std::string_view bytes) {
  const std::size_t size = ZSTD_findFrameCompressedSize(bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0) throw_damaged();
  return size;
}

std::string_view Unpacker::unpack_block(std::string_view block, std::uint64_t most) {
  const unsigned long long size = ZSTD_getFrameContentSize(block.data(), block.size());
  if (!block.starts_with(kFrameMagic) || size == ZSTD_CONTENTSIZE_ERROR) throw_damaged();
  if ((static_cast<unsigned char>(block[kFrameMagic.size()]) & kChecksumFlag) == 0) {
    throw sim::InputError(
        "has a block without a checksum; allowed: blocks with a checksum and the size of their content");
  }
  if (size == ZSTD_CONTENTSIZE_UNKNOWN) {
    throw sim::InputError("has a block without a size; allowed: blocks with a checksum and the size of their content");
  }
  if (size > most) {
    throw sim::InputError(fmt::format("has a block of {} bytes that holds {}; allowed: {}", block.size(), size, most));
  }
  // An impossible size, refused before memory is allocated.
  if (size > (block.size() / kLeastOfBlock + 1) * kMostInBlock) throw_damaged();
  if (ZSTD_findFrameCompressedSize(block.data(), block.size()) != block.size()) throw_damaged();
  if (bytes_.size() < size + kBitsPadding) bytes_.resize(size + kBitsPadding);
  if (ZSTD_decompressDCtx(context_.get(), bytes_.data(), size, block.data(), block.size()) != size) throw_damaged();
  return {bytes_.data(), size};
}

}  // namespace traces
