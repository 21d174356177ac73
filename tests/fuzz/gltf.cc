#include "tests/fuzz/scene.h"

// Fuzz target: a .gltf file whose buffers are data: URIs.

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  return fuzz::mutate_json(data, size, most, seed);
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::load_scene(fuzz::text_of(data, size), "input.gltf");
  return 0;
}
