#include <cstring>

#include "tests/fuzz/scene.h"

// Fuzz target: a .glb file. Mutations change the content of its two chunks and correct the sizes in its headers.

namespace {

constexpr std::size_t kHeader = 12, kChunkHeader = 8;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  if (at + sizeof word <= bytes.size()) std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

std::string word(std::size_t value) {
  const auto number = static_cast<std::uint32_t>(value);
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

std::string file_of_chunks(std::string json, std::string binary) {
  json.append((4 - json.size() % 4) % 4, ' ');
  binary.append((4 - binary.size() % 4) % 4, '\0');
  const std::string chunks = word(json.size()) + "JSON" + json + word(binary.size()) + std::string("BIN\0", 4) + binary;
  return "glTF" + word(2) + word(kHeader + chunks.size()) + chunks;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::size_t begin = kHeader + kChunkHeader, json_size = word_at(bytes, kHeader);
  if (seed % 8 == 0 || size < begin || json_size > size - begin) return LLVMFuzzerMutate(data, size, most);
  std::string json(bytes.substr(begin, json_size)), binary;
  if (size - begin - json_size > kChunkHeader) binary = bytes.substr(begin + json_size + kChunkHeader);
  if (seed % 8 < 6) {
    json = fuzz::mutated_json(json, seed / 8);
    if (json.empty()) return LLVMFuzzerMutate(data, size, most);
  } else {
    binary = fuzz::mutated_bytes(binary, 64);
  }
  return fuzz::replace(data, size, most, file_of_chunks(json, binary));
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::load_scene(fuzz::text_of(data, size), "input.glb");
  return 0;
}
