#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace traces {

/// The smallest block: a zstd frame of nothing.
inline constexpr std::uint64_t kLeastPacked = 9;

/// Packs blocks: one zstd frame each, with size and checksum of what is inside.
class Packer {
 public:
  /// Higher levels save little of a trace: most of a tile are walks, which hardly shrink.
  explicit Packer(int level = 1);
  /// Valid until the next one.
  std::string_view pack(std::string_view bytes);
  /// The same, of no less than a byte for every `bytes_a_byte`, at least 4.
  std::string_view pack_loosely(std::string_view bytes, std::size_t bytes_a_byte);

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
  /// Bytes of the block that these begin with. InputError, without the file's name, if they begin with none.
  static std::size_t size_of(std::string_view bytes);
  /// Contents of a block, followed by kBitsPadding bytes more; valid until the next one. InputError, without the file's
  /// name, if it is damaged or holds more than `most` bytes, before it takes any.
  std::string_view unpack(std::string_view block, std::uint64_t most);

 private:
  struct Free {
    void operator()(ZSTD_DCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_DCtx_s, Free> context_;
  std::string bytes_;
};

}  // namespace traces
