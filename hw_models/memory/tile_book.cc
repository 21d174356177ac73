#include "hw_models/memory/tile_book.h"

namespace hw {

void TileBook::count(Owner owner, std::uint64_t TileAccount::*kind) { of(owner).*kind += 1; }

}  // namespace hw
