#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "traces/stream.h"
#include "traces/trace_file/tree_links.h"
#include "traces/walk.h"

namespace traces {

// The walks of a tile's rays (walk.h) as bits. Data that follow from the tree are omitted: the hits so far determine
// the next node. Bits are stored lowest first, one ray after the other:
//
//   visit     near(1) hits(2), hits lowest
//   wide      a bit per slot that may have a child: which are hit; then, for each hit child but the last, nearest
//   first:
//             its position among the hit children that are left, in slot order, in as few bits as their number allows
//   enter     none: the instance and its root follow from the tree
//   leaf      2 bits for each triangle of the leaf: its exit phase, or 0 if it was not tested
//   pop       if a step is followed by a pop or the end, and the stack is not empty:
//             0  the youngest entry is next           1  all entries are culled: the end
//             2  the end, with entries left           3  a cull count follows, of 7 bits, in wide trees 10, with two
//                                                        levels one more; the entry after the culled ones is next
//   end       hit(1)
//
// With look-ups, each walk is preceded by the bit look_up(1) and, if it is 1, by
//
//   stored(1) predicted(1) [correct(1) node(27)]
//
// A walk whose prediction is wrong continues at the root, without further bits, when its stack is empty for the first
// time.

/// Number of readable bytes that must follow the encoded bits; their values do not matter.
inline constexpr std::size_t kBitsPadding = 8;

/// True if walks of the tile's rays begin with look-ups of predicted nodes.
bool has_look_ups(const TileWork& work);

/// Appends the bits of the recorded walks of a tile's rays. Returns false, with `out` unchanged, if a walk is not
/// possible in the BVH. `look_ups`: the walks may have look-ups.
bool encode_walks(const TileWork& work, const Links& links, bool look_ups, std::string& out);

/// Decodes the recorded walks of `rays` rays, `words` words in total, and returns their traversal steps. `bits` must be
/// followed by kBitsPadding bytes. Throws InputError if the bits are not valid.
WalkSteps decode_walks(std::string_view bits, const Links& links, bool look_ups, std::uint32_t rays,
                       std::uint32_t words, TileWork& work);

/// Reads the recorded walks of `rays` rays that are stored as plain words of four bytes (walk.h), and returns their
/// traversal steps. Throws InputError if a walk does not fit the BVH.
WalkSteps decode_plain_walks(std::string_view bytes, const Links& links, bool look_ups, std::uint32_t rays,
                             TileWork& work);

}  // namespace traces
