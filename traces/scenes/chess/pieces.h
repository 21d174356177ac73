#pragma once
#include <array>
#include <cstdint>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::chess {

enum class Piece : std::uint8_t { kPawn, kRook, kKnight, kBishop, kQueen, kKing };
inline constexpr std::size_t kPieces = 6;
inline constexpr std::array<std::uint32_t, kPieces> kInSet = {8, 2, 2,
                                                              2, 1, 1};  ///< number of pieces of each kind in one
                                                                         ///< colour

/// Makes a chess piece of the Staunton pattern about the y axis, with its foot at y = 0. A square of the board is 1
/// wide; knights face -z.
Mesh make_piece(Piece piece, const Detail& detail);

/// Makes a chess knight without its foot.
Mesh make_horse(const Detail& detail);

}  // namespace traces::chess
