#include <array>

#include "tests/fuzz/scene.h"
#include "traces/scene/images.h"

// Fuzz target: a PNG or JPEG file, as in a scene, or an EXR file, as `compare` reads it. Mutations of a PNG correct the
// checksums of its chunks.

namespace {

constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n", kExr = "\x76\x2f\x31\x01";

std::uint32_t crc(std::string_view bytes) {
  std::uint32_t sum = ~0U;
  for (const char byte : bytes) {
    sum ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ ((sum & 1) != 0 ? 0xedb88320U : 0);
  }
  return ~sum;
}

/// Reads a big-endian number.
std::uint32_t big_endian(const std::uint8_t* at) {
  return std::uint32_t{at[0]} << 24 | std::uint32_t{at[1]} << 16 | std::uint32_t{at[2]} << 8 | at[3];
}

/// Corrects the checksums of a PNG. A chunk has size, kind, content, and a checksum of kind and content.
void set_checksums(std::uint8_t* data, std::size_t size) {
  std::size_t at = kPng.size();
  while (at + 12 <= size) {
    const std::size_t content = big_endian(data + at);
    if (content > size - at - 12) return;
    const std::uint32_t sum = crc(fuzz::text_of(data + at + 4, content + 4));
    for (std::size_t i = 0; i < 4; ++i) data[at + 8 + content + i] = static_cast<std::uint8_t>(sum >> (24 - 8 * i));
    at += 12 + content;
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  const std::size_t changed = LLVMFuzzerMutate(data, size, most);
  if (seed % 8 != 0 && fuzz::text_of(data, changed).starts_with(kPng)) set_checksums(data, changed);
  return changed;
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  fuzz::ignore_input_errors([&] {
    if (bytes.starts_with(kExr)) {
      traces::read_exr(fuzz::file_of(bytes, "input.exr"), fuzz::small_limits());
    } else {
      traces::read_image(std::as_bytes(std::span(data, size)), "image", fuzz::small_limits());
    }
  });
  return 0;
}
