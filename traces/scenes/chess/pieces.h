#pragma once
#include <array>
#include <cstdint>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::chess {

enum class Piece : std::uint8_t { kPawn, kRook, kKnight, kBishop, kQueen, kKing };
inline constexpr std::size_t kPieces = 6;
inline constexpr std::array<std::uint32_t, kPieces> kInSet = {8, 2, 2,
                                                              2, 1, 1};  ///< pieces of each kind, in one colour

/// A piece in the Staunton pattern, standing on y = 0 about the y axis; a square of the board is 1 wide. Knights look
/// along -z. `detail` scales how finely curves are cut.
Mesh make_piece(Piece piece, const Detail& detail);

/// A knight without its foot.
Mesh make_horse(const Detail& detail);

}  // namespace traces::chess
