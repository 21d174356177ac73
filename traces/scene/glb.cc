#include "traces/scene/glb.h"

#include <cstdint>
#include <cstring>

namespace traces {
namespace {

// Layout of a GLB file: magic, version, length of the file. Then the first chunk: size, type, JSON.
constexpr std::size_t kFileLength = 8, kChunkSize = 12, kJson = 20;

// GLB is little-endian, as are all supported hosts.
std::uint32_t read_word(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

void set_word(std::string& bytes, std::size_t at, std::size_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  std::memcpy(bytes.data() + at, &word, sizeof word);
}

}  // namespace

std::string_view glb_json(std::string_view glb) { return glb.substr(kJson, read_word(glb, kChunkSize)); }

void set_glb_json(std::string& glb, std::string json) {
  while (json.size() % 4 != 0) json += ' ';
  glb.replace(kJson, read_word(glb, kChunkSize), json);
  set_word(glb, kFileLength, glb.size());
  set_word(glb, kChunkSize, json.size());
}

}  // namespace traces
