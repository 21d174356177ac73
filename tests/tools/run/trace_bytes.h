#pragma once
#include <cstdint>
#include <string>

#include <zstd.h>

// Encoders for parts of trace files, following docs/trace-format.md.

namespace test {

/// Fields of a compressed block that a test can leave out. The reader must then refuse the block.
struct Form {
  bool checksum = true, size = true;
};

inline std::string block(const std::string& content, const Form& form = {}) {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, form.checksum ? 1 : 0);
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, form.size ? 1 : 0);
  std::string packed(ZSTD_compressBound(content.size()), '\0');
  packed.resize(ZSTD_compress2(context, packed.data(), packed.size(), content.data(), content.size()));
  ZSTD_freeCCtx(context);
  return packed;
}

/// Encodes a number, lowest byte first.
inline std::string number(std::uint64_t value, int bytes) {
  std::string out;
  for (; bytes > 0; --bytes, value >>= 8) out += static_cast<char>(value & 0xff);
  return out;
}

/// Encodes a number with 7 bits per byte, lowest first. The top bit is set in all bytes but the last.
inline std::string varint(std::uint64_t value) {
  std::string out;
  for (; value >= 0x80; value >>= 7) out += static_cast<char>((value & 0x7f) | 0x80);
  return out += static_cast<char>(value);
}

}  // namespace test
