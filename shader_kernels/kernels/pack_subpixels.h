#pragma once
#include <array>
#include <string_view>

#include "shader_kernels/kernels/subpixels.h"
#include "sim/named.h"

namespace kernels {

// Pixels of a block, which are listed together; the last blocks of a row or column may stand out over the tile.
inline constexpr std::uint32_t kBlockWidth = 8, kBlockHeight = 4;

/// Lists the active sub-pixels in chunks of 64, block by block, as Jin et al. (2009) do: one after the other looks at
/// every pixel. Sub-pixels of a pixel do not straddle chunks; entries at the end of one are left empty for that. Pixels
/// that have any are listed as masters, in the same order: they collect the samples of a chunk.
struct PackSubpixels {
  static constexpr std::string_view kName = "pack_subpixels";
  static constexpr std::string_view kMeaning = "pixel -> its active sub-pixels into the list, within one chunk";
  template <class V>
  struct Ports {
    F<V> across, inverse_across;  ///< blocks in a row
    F<V> width, height;           ///< in pixels
    Local<V, WordRecord> verdicts, active, masters;
    Local<V, WordRecord> fills;  ///< per chunk: entries taken; above kFillBits, masters up to there
    Carried<V> list_end;
    Counter<V> masters_count;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.across));
      port(NAMED(p.inverse_across));
      port(NAMED(p.width));
      port(NAMED(p.height));
      port(NAMED(p.verdicts));
      port(NAMED(p.active));
      port(NAMED(p.masters));
      port(NAMED(p.fills));
      port(p.list_end, "places");
      port(NAMED(p.masters_count));
    }
  };
  static constexpr std::uint32_t kFillBits = 8;

  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    constexpr std::uint32_t kColumnBits = 3, kItemBits = 5;
    static_assert(1U << kColumnBits == kBlockWidth && 1U << kItemBits == kBlockWidth * kBlockHeight);
    const DivMod<V> block = divmod<V>(to_float(item >> kItemBits), at.across, at.inverse_across);
    const F<V> column = block.remainder * static_cast<float>(kBlockWidth) + to_float(item & (kBlockWidth - 1));
    const F<V> row =
        block.quotient * static_cast<float>(kBlockHeight) + to_float((item >> kColumnBits) & (kBlockHeight - 1));
    const M<V> inside = both(column < at.width, row < at.height);
    const I<V> pixel = to_int(row * at.width + column);
    const I<V> first = pixel << 2U;

    std::array<I<V>, 4> verdicts, active, before;
    I<V> count = 0U;
    for (std::uint32_t i = 0; i < 4; ++i) {
      verdicts[i] = at.verdicts.load(first + i).word;
      active[i] = select(inside, active_bit<V>(verdicts[i]), I<V>(0U));
      before[i] = count;
      count = i == 0 ? active[i] : count + active[i];
    }
    const F<V> taken = to_float(count);
    const F<V> behind = at.list_end.get();
    const F<V> chunk_so_far = floor(behind * (1.0F / kChunk));
    const F<V> chunk =
        chunk_so_far + select(static_cast<float>(kChunk) < behind - chunk_so_far * static_cast<float>(kChunk) + taken,
                              F<V>(1.0F), F<V>(0.0F));
    const F<V> begin = max(behind, chunk * static_cast<float>(kChunk));
    const F<V> end = begin + taken;
    at.list_end.set(end);
    const I<V> begin_index = to_int(begin);
    for (std::uint32_t i = 0; i < 4; ++i) {
      const I<V> index = i == 0 ? begin_index : begin_index + before[i];
      const M<V> is_active = active[i] == 1U;
      at.active.store(index, {first + i});
      at.verdicts.store(first + i, {select(is_active, verdicts[i] | (index << kIndexShift), verdicts[i])});
    }
    const M<V> has_any = I<V>(0U) < count;
    const I<V> master = at.masters_count.next(has_any);
    at.masters.store(master, {pixel});
    const I<V> masters = master + select(has_any, I<V>(1U), I<V>(0U));
    at.fills.store(to_int(chunk), {to_int(end - chunk * static_cast<float>(kChunk)) | (masters << kFillBits)});
  }
};

/// Lists the active sub-pixels as if each had asked for its index by itself, with an atomic addition to the list's
/// length: one a word of the tile buffer is read, added to and written back. Who asks when is anybody's guess; here it
/// is every `stride`-th sub-pixel, round and round.
struct PackSubpixelsAtomic {
  static constexpr std::string_view kName = "pack_subpixels_atomic";
  static constexpr std::string_view kMeaning = "sub-pixel, in scattered order -> into the list if it is active";
  template <class V>
  struct Ports {
    Local<V, WordRecord> verdicts, active, length;
    Carried<V> subpixel;
    F<V> stride, subpixels;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.verdicts));
      port(NAMED(p.active));
      port(NAMED(p.length));
      port(NAMED(p.subpixel));
      port(NAMED(p.stride));
      port(NAMED(p.subpixels));
    }
  };
  template <class V>
  static void body(const I<V>&, Ports<V>& at) {
    const F<V> number = at.subpixel.get();
    const F<V> next = number + at.stride;
    at.subpixel.set(select(next < at.subpixels, next, next - at.subpixels));
    const I<V> subpixel = to_int(number);
    const I<V> verdict = at.verdicts.load(subpixel).word;
    const I<V> active = active_bit<V>(verdict);
    const I<V> index = at.length.load(I<V>(0U)).word;
    at.length.store(I<V>(0U), {index + active});
    at.active.store(index, {subpixel});
    at.verdicts.store(subpixel, {select(active == 1U, verdict | (index << kIndexShift), verdict)});
  }
};

}  // namespace kernels
