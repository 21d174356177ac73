#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace traces {

/// Size in bytes of the smallest packed block, an empty zstd frame.
inline constexpr std::uint64_t kLeastPacked = 9;

/// Packs blocks of bytes with zstd. Each block becomes one zstd frame, which includes the size and checksum of the
/// block.
class Packer {
 public:
  /// `level` is zstd's compression level. Level 1 is enough: a tile consists mostly of walks, which hardly compress.
  explicit Packer(int level = 1);
  /// Packs bytes into a block. The result is valid until the next call.
  std::string_view pack_block(std::string_view bytes);
  /// Packs bytes like pack_block(), but limits the compression ratio: the block has at least one byte per
  /// `bytes_a_byte` bytes of contents. `bytes_a_byte` must be 4 or more.
  std::string_view pack_with_limited_ratio(std::string_view bytes, std::size_t bytes_a_byte);

 private:
  struct Free {
    void operator()(ZSTD_CCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_CCtx_s, Free> context_;
  std::string packed_;
};

class Unpacker {
 public:
  Unpacker();
  /// Returns the size of the packed block at the beginning of `bytes`. Throws InputError, without a file name, if there
  /// is none.
  static std::size_t size_of(std::string_view bytes);
  /// Unpacks a zstd block of a trace. Returns its contents, which are followed by kBitsPadding more bytes and valid
  /// until the next call. Throws InputError, without a file name, if the block is damaged or holds more than `most`
  /// bytes, which is checked before memory is allocated.
  std::string_view unpack_block(std::string_view block, std::uint64_t most);

 private:
  struct Free {
    void operator()(ZSTD_DCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_DCtx_s, Free> context_;
  std::string bytes_;
};

}  // namespace traces
