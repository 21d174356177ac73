#include "tests/fuzz/common.h"
#include "tools/tiles/tile_table.h"

// Fuzz target: tiles.json of a run. It is read, written and read again, and must be the same.

namespace {

void round_trip_text(const tools::TileTable& table) {
  const std::string text = tools::tiles_text(table);
  const tools::TileTable again = tools::load_tiles(fuzz::file_of(text, "again.json"));
  if (tools::tiles_text(again) != text) std::abort();
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  return fuzz::mutate_json(data, size, most, seed);
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::file_of(fuzz::text_of(data, size), "input.json");
  fuzz::ignore_input_errors([&] { round_trip_text(tools::load_tiles(file)); });
  return 0;
}
