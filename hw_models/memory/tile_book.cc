#include "hw_models/memory/tile_book.h"

namespace hw {

void TileBook::count(Owner owner, std::uint64_t TileAccount::*kind) { of(owner).*kind += 1; }

void TileBook::count(Owner owner, Asker asker) { of(owner).lines[static_cast<std::size_t>(asker)] += 1; }

}  // namespace hw
