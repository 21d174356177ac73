#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "traces/stream.h"
#include "traces/trace_file/tree_links.h"
#include "traces/walk_steps.h"

namespace traces {

// The walks of a tile's rays (walk.h) as bits, without what follows from the tree: which node is visited next is said
// by the hits so far. Lowest bit first, one ray behind the other:
//
//   visit     near(1) hits(2), hits lowest
//   enter     none: the instance and its root follow from the tree
//   leaf      2 bits for each triangle of the leaf: its exit phase, 0 for those that were not tested
//   pop       where a step is followed by a pop or the end, and the stack is not empty:
//             0  the youngest entry is next           1  all entries are culled: the end
//             2  the end, with entries left           3  then 7 bits (of two levels 8): so many are culled, the next
//             one is next
//   end       hit(1)

/// Bytes that must be there, whatever they hold, behind bits to be decoded.
inline constexpr std::size_t kBitsPadding = 8;

/// Appends the bits of all walks of the tile. False, and `out` is as it was, if a walk is not one on this tree.
bool encode_walks(const TileWork& work, const Links& links, std::string& out);

/// Fills `walk` and `ray_begin` of a tile with the walks of `rays` rays, `words` words together; returns their node
/// visits and triangle tests. `bits` is followed by kBitsPadding. InputError if they are not what encode_walks makes.
WalkSteps decode_walks(std::string_view bits, const Links& links, std::uint32_t rays, std::uint32_t words,
                       TileWork& work);

/// Fills them with walks as walk.h has them, four bytes a word; the same checks.
WalkSteps decode_plain_walks(std::string_view bytes, const Links& links, std::uint32_t rays, TileWork& work);

}  // namespace traces
