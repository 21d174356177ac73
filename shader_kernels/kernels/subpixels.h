#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/pixels.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Attributes that the program supersample compares between pixels. Each attribute has a contrast threshold; the
/// threshold of kColour applies if no other attribute differs.
enum class Attribute : std::uint8_t {
  kColour,
  kObject,
  kNormal,
  kShadow,
  kTexture,
  kSecondaryObject,
  kSecondaryNormal,
  kSecondaryShadow,
  kSecondaryTexture,
  kCount
};
inline constexpr std::size_t kAttributes = static_cast<std::size_t>(Attribute::kCount);
constexpr std::array<std::string_view, kAttributes> names_of(Attribute) {
  return {"colour",           "object",           "normal",           "shadow",           "texture",
          "secondary_object", "secondary_normal", "secondary_shadow", "secondary_texture"};
}
constexpr std::uint32_t attribute_bit(Attribute attribute) { return 1U << static_cast<std::uint32_t>(attribute); }

// Layout of a sub-pixel's verdict word; a pixel has four sub-pixels, row by row. The low bits are the differing
// attributes (kColour if none), then comes the active bit, then the index in the list of active sub-pixels. An active
// sub-pixel receives more samples. Entries of the list are pixel * 4 + sub-pixel.
inline constexpr std::uint32_t kActiveShift = kAttributes;
inline constexpr std::uint32_t kIndexShift = 12;

/// Factors by which the contrast threshold of red, green and blue is multiplied (Jin et al. 2009).
inline constexpr std::array<float, 3> kChannelFactors{1.36F, 1.02F, 2.04F};
/// A contrast threshold that no contrast reaches.
inline constexpr float kNever = 4.0F;

/// Number of active sub-pixels that are sampled together (a chunk).
inline constexpr std::uint32_t kChunk = 64;
/// Number of samples of an active sub-pixel; number of samples of a pixel whose four sub-pixels are all active; side of
/// the grid of the pixel's samples.
inline constexpr std::uint32_t kExtra = 4, kWhole = 16, kWholeGrid = 4;

/// The pixels whose final colours a tile computes (finished pixels), row by row. The samples at their centres begin at
/// `first`, with `pitch` per row. Columns and rows from `low` to `high` have a sample; they are counted from the first
/// finished pixel.
template <class V>
struct FinishedUniforms {
  F<V> width, inverse_width;
  F<V> first, pitch;
  F<V> low_x, high_x, low_y, high_y;
  static constexpr void describe(auto& f, auto&& port) {
    port(f.width, "finished.width");
    port(f.inverse_width, "finished.inverse_width");
    port(f.first, "finished.first");
    port(f.pitch, "finished.pitch");
    port(f.low_x, "finished.low_x");
    port(f.high_x, "finished.high_x");
    port(f.low_y, "finished.low_y");
    port(f.high_y, "finished.high_y");
  }
};

/// Index offsets from a pixel's centre sample to those of its neighbours at one corner, in x and y; 0 outside the
/// picture.
template <class V>
struct CornerSteps {
  F<V> x, y;
  M<V> has_both;
};
/// Returns the index offsets to the neighbours at a corner of `pixel`. `right` is 1 for a right corner, otherwise -1;
/// `below` is 1 for a lower corner, otherwise -1.
template <class V>
CornerSteps<V> corner_steps(const DivMod<V>& pixel, const F<V>& right, const F<V>& below,
                            const FinishedUniforms<V>& tile) {
  const F<V> x = pixel.remainder + right;
  const F<V> y = pixel.quotient + below;
  const M<V> has_x = logical_and(tile.low_x <= x, x <= tile.high_x);
  const M<V> has_y = logical_and(tile.low_y <= y, y <= tile.high_y);
  return {select(has_x, right, F<V>(0.0F)), select(has_y, below * tile.pitch, F<V>(0.0F)), logical_and(has_x, has_y)};
}

/// Returns the row (quotient) and column (remainder) of a pixel number.
template <class V>
DivMod<V> row_and_column(const F<V>& pixel, const FinishedUniforms<V>& tile) {
  return div_mod<V>(pixel, tile.width, tile.inverse_width);
}
template <class V>
F<V> centre_sample(const DivMod<V>& pixel, const FinishedUniforms<V>& tile) {
  return tile.first + pixel.quotient * tile.pitch + pixel.remainder;
}

template <class V>
I<V> active_bit(const I<V>& verdict) {
  return (verdict >> kActiveShift) & 1U;
}

template <class V>
Vec3<V> clamped_colour(const Vec3<V>& colour) {
  return {clamp_to_unit<V>(colour.x), clamp_to_unit<V>(colour.y), clamp_to_unit<V>(colour.z)};
}

/// Returns the attributes that differ between two hits, as bits for object, normal and shadows. Differences count only
/// if one of the two objects has the flag `focus` (0: always). Normals are equal if their dot product is at least
/// `same_normal`.
template <class V>
I<V> disagreeing_attributes(const TraitsRecord<V>& own, const TraitsRecord<V>& other, const F<V>& same_normal,
                            const I<V>& focus) {
  constexpr std::uint32_t kObject = 1, kNormal = 2, kShadow = 4;
  const I<V> differ = select(own.object == other.object, I<V>(0U), I<V>(kObject)) |
                      select(dot(own.normal, other.normal) < same_normal, I<V>(kNormal), I<V>(0U)) |
                      select(own.shadows == other.shadows, I<V>(0U), I<V>(kShadow));
  return select(((own.object | other.object) & focus) == focus, differ, I<V>(0U));
}

/// Returns the contrast of one channel among four linear colours (Mitchell 1987), clamped and sRGB-encoded, from 0 to
/// 1.
template <class V>
F<V> channel_contrast(const F<V>& a, const F<V>& b, const F<V>& c, const F<V>& d) {
  const F<V> most = encode_srgb<V>(clamp_to_unit<V>(max(max(a, b), max(c, d))));
  const F<V> least = encode_srgb<V>(clamp_to_unit<V>(min(min(a, b), min(c, d))));
  return (most - least) / max(most + least, F<V>(1e-30F));
}

/// Selects the sub-pixels in which the program supersample takes more samples (Jin et al. 2009). A pixel is compared
/// with the three neighbours at the sub-pixel's corner. The contrast of the four colours must reach the smallest
/// threshold of the differing attributes.
struct TestSubpixels {
  static constexpr std::string_view kName = "test_subpixels";
  static constexpr std::string_view kMeaning =
      "sub-pixel and three neighbours -> whether it needs more samples, and why";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    Local<V, TraitsRecord> traits, secondary;
    Local<V, ColourRecord> colours;
    Local<V, WordRecord> verdicts;
    std::array<F<V>, kAttributes> thresholds;  ///< contrast thresholds of attributes; above 1: never reached
    F<V> same_normal;
    I<V> compared;         ///< attributes to compare, as bits
    I<V> focus, textured;  ///< bits of object ids: of objects in focus, of textured objects
    static constexpr void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      name_all(port, NAMED_ALL(p.traits, p.secondary, p.colours, p.verdicts));
      for (std::size_t i = 0; i < kAttributes; ++i) port(p.thresholds[i], names_of(Attribute{})[i]);
      name_all(port, NAMED_ALL(p.same_normal, p.compared, p.focus, p.textured));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = row_and_column<V>(to_float(item >> 2U), io.finished);
    const CornerSteps<V> step =
        corner_steps<V>(pixel, to_float((item << 1U) & 2U) - 1.0F, to_float(item & 2U) - 1.0F, io.finished);
    const F<V> own = centre_sample<V>(pixel, io.finished);
    // Outside the picture the pixel is compared with itself, so that nothing differs.
    const I<V> centre = to_int(own);
    const I<V> beside = to_int(own + step.x);
    const I<V> above = to_int(own + step.y);
    const I<V> corner = to_int(select(step.has_both, own + step.x + step.y, own));

    const I<V> primary = differing_bits<V>(io.traits, centre, beside, above, corner, io);
    const I<V> secondary = differing_bits<V>(io.secondary, centre, beside, above, corner, io);
    const I<V> counting = ((primary << 1U) | (secondary << 5U)) & io.compared;
    F<V> threshold = kNever;
    for (std::uint32_t i = 1; i < kAttributes; ++i) {
      threshold = min(threshold, select((counting & (1U << i)) == 0U, F<V>(kNever), io.thresholds[i]));
    }
    const M<V> none = counting == 0U;
    threshold = select(none, io.thresholds[0], threshold);

    const Vec3<V> a = io.colours.load(centre).rgb;
    const Vec3<V> b = io.colours.load(beside).rgb;
    const Vec3<V> c = io.colours.load(above).rgb;
    const Vec3<V> d = io.colours.load(corner).rgb;
    const M<V> active =
        logical_or(logical_or(threshold * kChannelFactors[0] <= channel_contrast<V>(a.x, b.x, c.x, d.x),
                              threshold * kChannelFactors[1] <= channel_contrast<V>(a.y, b.y, c.y, d.y)),
                   threshold * kChannelFactors[2] <= channel_contrast<V>(a.z, b.z, c.z, d.z));
    io.verdicts.store(item, {select(none, I<V>(attribute_bit(Attribute::kColour)), counting) |
                             select(active, I<V>(1U << kActiveShift), I<V>(0U))});
  }

 private:
  /// Returns the attributes that differ between the pixel `centre` and its three neighbours, as bits. The texture bit
  /// is set whenever the pixel's own object is textured.
  template <class V>
  static I<V> differing_bits(const Local<V, TraitsRecord>& set, const I<V>& centre, const I<V>& beside,
                             const I<V>& above, const I<V>& corner, const Ports<V>& io) {
    constexpr std::uint32_t kTexture = 8;
    const TraitsRecord<V> own = set.load(centre);
    const TraitsRecord<V> one = set.load(beside);
    const TraitsRecord<V> two = set.load(above);
    const TraitsRecord<V> three = set.load(corner);
    return disagreeing_attributes<V>(own, one, io.same_normal, io.focus) |
           disagreeing_attributes<V>(own, two, io.same_normal, io.focus) |
           disagreeing_attributes<V>(own, three, io.same_normal, io.focus) |
           select((own.object & io.textured) == io.textured, I<V>(kTexture), I<V>(0U));
  }
};

/// Sums the colours of a pixel's inactive sub-pixels, with weight 1/4 each. Their colour is that of the pixel's centre
/// or, with kBilinear, the one interpolated at the sub-pixel's centre.
template <bool kBilinear>
struct WeighCentres {
  static constexpr std::string_view kName = kBilinear ? "weigh_centres_bilinear" : "weigh_centres";
  static constexpr std::string_view kMeaning = "pixel -> share of its sub-pixels that need no more samples";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    Local<V, WordRecord> verdicts;
    Local<V, ColourRecord> colours, pixels;
    static constexpr void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      name_all(port, NAMED_ALL(p.verdicts, p.colours, p.pixels));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = row_and_column<V>(to_float(item), io.finished);
    const F<V> own = centre_sample<V>(pixel, io.finished);
    const Vec3<V> centre = clamped_colour<V>(io.colours.load(to_int(own)).rgb);
    const I<V> first = item << 2U;
    if constexpr (kBilinear) {
      Vec3<V> sum{0.0F, 0.0F, 0.0F};
      for (std::uint32_t i = 0; i < 4; ++i) {
        const CornerSteps<V> step =
            corner_steps<V>(pixel, F<V>((i & 1U) != 0 ? 1.0F : -1.0F), F<V>((i & 2U) != 0 ? 1.0F : -1.0F), io.finished);
        const Vec3<V> beside = clamped_colour<V>(io.colours.load(to_int(own + step.x)).rgb);
        const Vec3<V> above = clamped_colour<V>(io.colours.load(to_int(own + step.y)).rgb);
        const Vec3<V> corner = clamped_colour<V>(io.colours.load(to_int(own + step.x + step.y)).rgb);
        const F<V> weight =
            0.015625F - to_float(active_bit<V>(io.verdicts.load(first + i).word)) * 0.015625F;  // a quarter of 1/16
        sum = sum + (centre * F<V>(9.0F) + (beside + above) * F<V>(3.0F) + corner) * weight;
      }
      io.pixels.store(item, {sum});
    } else {
      I<V> active = active_bit<V>(io.verdicts.load(first).word);
      for (std::uint32_t i = 1; i < 4; ++i) active = active + active_bit<V>(io.verdicts.load(first + i).word);
      io.pixels.store(item, {centre * (1.0F - to_float(active) * 0.25F)});
    }
  }
};

// Size in pixels of a block of pixels whose sub-pixels are listed together. Blocks may extend beyond the tile's edges.
inline constexpr std::uint32_t kBlockWidth = 8, kBlockHeight = 4;

/// Lists the active sub-pixels of a tile in chunks of 64, in the order of blocks of pixels (Jin et al. 2009).
///
/// 1. The sub-pixels of a pixel stay in one chunk; entries at a chunk's end may be left empty for that.
/// 2. Pixels with active sub-pixels (masters) are also listed, in the same order. Each chunk completes the masters that
/// belong to its sub-pixels.
struct PackSubpixels {
  static constexpr std::string_view kName = "pack_subpixels";
  static constexpr std::string_view kMeaning = "pixel -> its active sub-pixels into the list, within one chunk";
  template <class V>
  struct Ports {
    F<V> across, inverse_across;  ///< number of blocks in a row of the tile
    F<V> width, height;           ///< size of the tile in pixels
    Local<V, WordRecord> verdicts, active, masters;
    Local<V, WordRecord> fills;  ///< per chunk: used entries and, above bit kFillBits, masters up to the chunk's end
    LoopCarried<V> list_end;
    Counter<V> masters_count;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port,
               NAMED_ALL(p.across, p.inverse_across, p.width, p.height, p.verdicts, p.active, p.masters, p.fills));
      port(p.list_end, "places");
      port(NAMED(p.masters_count));
    }
  };
  static constexpr std::uint32_t kFillBits = 8;

  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    constexpr std::uint32_t kColumnBits = 3, kItemBits = 5;
    static_assert(1U << kColumnBits == kBlockWidth && 1U << kItemBits == kBlockWidth * kBlockHeight);
    const DivMod<V> block = div_mod<V>(to_float(item >> kItemBits), io.across, io.inverse_across);
    const F<V> column = block.remainder * static_cast<float>(kBlockWidth) + to_float(item & (kBlockWidth - 1));
    const F<V> row =
        block.quotient * static_cast<float>(kBlockHeight) + to_float((item >> kColumnBits) & (kBlockHeight - 1));
    const M<V> inside = logical_and(column < io.width, row < io.height);
    const I<V> pixel = to_int(row * io.width + column);
    const I<V> first = pixel << 2U;

    std::array<I<V>, 4> verdicts, active, before;
    I<V> count = 0U;
    for (std::uint32_t i = 0; i < 4; ++i) {
      verdicts[i] = io.verdicts.load(first + i).word;
      active[i] = select(inside, active_bit<V>(verdicts[i]), I<V>(0U));
      before[i] = count;
      count = i == 0 ? active[i] : count + active[i];
    }
    const F<V> taken = to_float(count);
    const F<V> behind = io.list_end.get();
    const F<V> chunk_so_far = floor(behind * (1.0F / kChunk));
    const F<V> chunk =
        chunk_so_far + select(static_cast<float>(kChunk) < behind - chunk_so_far * static_cast<float>(kChunk) + taken,
                              F<V>(1.0F), F<V>(0.0F));
    const F<V> begin = max(behind, chunk * static_cast<float>(kChunk));
    const F<V> end = begin + taken;
    io.list_end.set(end);
    const I<V> begin_index = to_int(begin);
    for (std::uint32_t i = 0; i < 4; ++i) {
      const I<V> index = i == 0 ? begin_index : begin_index + before[i];
      const M<V> is_active = active[i] == 1U;
      io.active.store(index, {first + i});
      io.verdicts.store(first + i, {select(is_active, verdicts[i] | (index << kIndexShift), verdicts[i])});
    }
    const M<V> has_any = I<V>(0U) < count;
    const I<V> master = io.masters_count.next_index(has_any);
    io.masters.store(master, {pixel});
    const I<V> masters = master + select(has_any, I<V>(1U), I<V>(0U));
    io.fills.store(to_int(chunk), {to_int(end - chunk * static_cast<float>(kChunk)) | (masters << kFillBits)});
  }
};

/// Lists the active sub-pixels with one atomic addition per sub-pixel: a word of the tile buffer, the list's length, is
/// read, incremented and written back. Hardware leaves the order undefined; the modelled order takes every `stride`-th
/// sub-pixel.
struct PackSubpixelsAtomic {
  static constexpr std::string_view kName = "pack_subpixels_atomic";
  static constexpr std::string_view kMeaning = "sub-pixel, in scattered order -> into the list if it is active";
  template <class V>
  struct Ports {
    Local<V, WordRecord> verdicts, active, length;
    LoopCarried<V> subpixel;
    F<V> stride, subpixels;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.verdicts, p.active, p.length, p.subpixel, p.stride, p.subpixels));
    }
  };
  template <class V>
  static void body(const I<V>&, Ports<V>& io) {
    const F<V> number = io.subpixel.get();
    const F<V> next = number + io.stride;
    io.subpixel.set(select(next < io.subpixels, next, next - io.subpixels));
    const I<V> subpixel = to_int(number);
    const I<V> verdict = io.verdicts.load(subpixel).word;
    const I<V> active = active_bit<V>(verdict);
    const I<V> index = io.length.load(I<V>(0U)).word;
    io.length.store(I<V>(0U), {index + active});
    io.active.store(index, {subpixel});
    io.verdicts.store(subpixel, {select(active == 1U, verdict | (index << kIndexShift), verdict)});
  }
};

/// Adds the samples of a listed pixel's active sub-pixels to the sum that the kernel weigh_centres has stored, in the
/// order in which the program full:16 adds them. A pixel has 16 items, its 4 x 4 cells row by row; the last completes
/// the sum.
struct SumSubpixels {
  static constexpr std::string_view kName = "sum_subpixels";
  static constexpr std::string_view kMeaning = "cell of a pixel -> its sample's share of the pixel";
  template <class V>
  struct Ports {
    Local<V, WordRecord> listed, verdicts;
    Local<V, ColourRecord> colours, pixels;
    LoopCarried<V> red, green, blue, base_red, base_green, base_blue;
    F<V> first_sample;  ///< index in `colours` of the first sample of entry 0 in the list of active sub-pixels
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.listed, p.verdicts, p.colours, p.pixels, p.red, p.green, p.blue, p.base_red,
                               p.base_green, p.base_blue, p.first_sample));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> pixel = io.listed.load(item >> 4U).word;
    const I<V> subpixel = ((item >> 2U) & 2U) | ((item >> 1U) & 1U);
    const I<V> sample = ((item >> 1U) & 2U) | (item & 1U);
    const I<V> verdict = io.verdicts.load((pixel << 2U) | subpixel).word;
    const M<V> is_active = active_bit<V>(verdict) == 1U;
    const I<V> index = ((verdict >> kIndexShift) << 2U) | sample;
    const Vec3<V> colour = io.colours.load(to_int(io.first_sample + to_float(index))).rgb;
    const Vec3<V> centre = io.pixels.load(pixel).rgb;
    const M<V> first = (item & 15U) == 0U;
    const auto sum = [&](LoopCarried<V>& so_far, LoopCarried<V>& base, const F<V>& more, const F<V>& begin) {
      const F<V> next = select(first, F<V>(0.0F), so_far.get()) + select(is_active, clamp_to_unit<V>(more), F<V>(0.0F));
      so_far.set(next);
      const F<V> kept = select(first, begin, base.get());
      base.set(kept);
      return next * 0.0625F + kept;
    };
    io.pixels.store(pixel,
                    {{sum(io.red, io.base_red, colour.x, centre.x), sum(io.green, io.base_green, colour.y, centre.y),
                      sum(io.blue, io.base_blue, colour.z, centre.z)}});
  }
};

// Layout of a sub-pixel's state (SubpixelRecord) between rounds of propagation: three sRGB-encoded channels of 16 bits,
// then the attributes that made the sub-pixel active, then the round in which it became active (1 for the first test, 0
// if inactive).
inline constexpr std::uint32_t kReasonsShift = 16, kRoundShift = kReasonsShift + kAttributes;
inline constexpr std::uint32_t kReasonsMask = (1U << kAttributes) - 1;
inline constexpr std::uint32_t kChannelMask = (1U << kReasonsShift) - 1;

/// Layout of the array of sub-pixel states, row by row. The array begins at index `first`; rows are `pitch` apart and
/// have `width` pixels.
template <class V>
struct StateUniforms {
  F<V> width, inverse_width;
  F<V> first, pitch;
  static constexpr void describe(auto& s, auto&& port) {
    port(s.width, "states.width");
    port(s.inverse_width, "states.inverse_width");
    port(s.first, "states.first");
    port(s.pitch, "states.pitch");
  }
};
/// Returns the index of a sub-pixel's state in the array of states. Sub-pixels are numbered pixel * 4 + sub-pixel.
template <class V>
F<V> state_index(const I<V>& subpixel, const StateUniforms<V>& states) {
  const DivMod<V> pixel = div_mod<V>(to_float(subpixel >> 2U), states.width, states.inverse_width);
  const F<V> column = pixel.remainder + pixel.remainder + to_float(subpixel & 1U);
  const F<V> row = pixel.quotient + pixel.quotient + to_float((subpixel >> 1U) & 1U);
  return states.first + row * states.pitch + column;
}

/// Packs a sub-pixel's colour and state into two words. `cause`: attributes that differed and round that made the
/// sub-pixel active, already shifted to their bits.
template <class V>
SubpixelRecord<V> pack_state(const Vec3<V>& colour, const I<V>& cause) {
  const auto channel = [](const F<V>& x) { return to_int(encode_srgb<V>(x) * 65535.0F + 0.5F); };
  return {channel(colour.x) | (channel(colour.y) << 16U), channel(colour.z) | cause};
}

/// Stores the mean colour of an active sub-pixel's four samples in the sub-pixel's state, for later rounds of
/// propagation.
struct SettleSubpixels {
  static constexpr std::string_view kName = "settle_subpixels";
  static constexpr std::string_view kMeaning = "listed sub-pixel, its four samples -> its colour and state";
  template <class V>
  struct Ports {
    StateUniforms<V> grid;
    Local<V, WordRecord> active, verdicts;
    Local<V, ColourRecord> colours, shown;
    Local<V, SubpixelRecord> states;
    F<V> first_sample;
    I<V> round;  ///< number of this round of propagation, shifted to its bits in a state word
    static constexpr void describe(auto& p, auto&& port) {
      StateUniforms<V>::describe(p.grid, port);
      name_all(port, NAMED_ALL(p.active, p.verdicts, p.colours, p.shown, p.states, p.first_sample, p.round));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> subpixel = io.active.load(item).word;
    const I<V> sample = to_int(io.first_sample + to_float(item << 2U));
    const auto colour = [&](std::uint32_t i) { return clamped_colour<V>(io.colours.load(sample + i).rgb); };
    const Vec3<V> a = colour(0);
    const Vec3<V> b = colour(1);
    const Vec3<V> c = colour(2);
    const Vec3<V> d = colour(3);
    const Vec3<V> mean = ((a + b) + (c + d)) * F<V>(0.25F);
    const I<V> reasons = io.verdicts.load(subpixel).word & kReasonsMask;
    io.shown.store(subpixel, {mean});
    io.states.store(to_int(state_index<V>(subpixel, io.grid)),
                    pack_state<V>(mean, (reasons << kReasonsShift) | io.round));
  }
};

/// Stores the state of every sub-pixel of a pixel as if none were active. Their colour is that of the pixel's centre
/// or, with kBilinear, the one interpolated at the sub-pixel's centre.
template <bool kBilinear>
struct ShowSubpixels {
  static constexpr std::string_view kName = kBilinear ? "show_subpixels_bilinear" : "show_subpixels";
  static constexpr std::string_view kMeaning = "sub-pixel -> its colour and state if it needs no more samples";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    StateUniforms<V> grid;
    Local<V, ColourRecord> colours, shown;
    Local<V, SubpixelRecord> states;
    static constexpr void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      StateUniforms<V>::describe(p.grid, port);
      name_all(port, NAMED_ALL(p.colours, p.shown, p.states));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = row_and_column<V>(to_float(item >> 2U), io.finished);
    const F<V> own = centre_sample<V>(pixel, io.finished);
    Vec3<V> colour = clamped_colour<V>(io.colours.load(to_int(own)).rgb);
    if constexpr (kBilinear) {
      const CornerSteps<V> step =
          corner_steps<V>(pixel, to_float((item << 1U) & 2U) - 1.0F, to_float(item & 2U) - 1.0F, io.finished);
      const Vec3<V> beside = clamped_colour<V>(io.colours.load(to_int(own + step.x)).rgb);
      const Vec3<V> above = clamped_colour<V>(io.colours.load(to_int(own + step.y)).rgb);
      const Vec3<V> corner = clamped_colour<V>(io.colours.load(to_int(own + step.x + step.y)).rgb);
      colour = (colour * F<V>(9.0F) + (beside + above) * F<V>(3.0F) + corner) * F<V>(0.0625F);
    }
    io.shown.store(item, {colour});
    io.states.store(to_int(state_index<V>(item, io.grid)), pack_state<V>(colour, I<V>(0U)));
  }
};

/// Decides, in a propagation round of the program supersample, which inactive sub-pixels become active. A sub-pixel is
/// compared with those of its four neighbours that the previous round made active. It becomes active if the contrast
/// among all of them reaches the smallest threshold of the attributes that made these neighbours active.
struct PropagateSubpixels {
  static constexpr std::string_view kName = "propagate_subpixels";
  static constexpr std::string_view kMeaning =
      "sub-pixel, neighbours made active last -> stream active if it differs from these, its pixel a master";
  template <class V>
  struct Ports {
    StateUniforms<V> grid;
    Local<V, SubpixelRecord> states;
    Local<V, WordRecord> verdicts, active, masters;
    Counter<V> active_count, masters_count;
    LoopCarried<V> last_master;                ///< the pixel that the kernel listed last
    std::array<F<V>, kAttributes> thresholds;  ///< contrast thresholds of attributes; above 1: never reached
    I<V> round;  ///< number of the previous round of propagation, shifted to its bits in a state word
    static constexpr void describe(auto& p, auto&& port) {
      StateUniforms<V>::describe(p.grid, port);
      name_all(port,
               NAMED_ALL(p.states, p.verdicts, p.active, p.masters, p.active_count, p.masters_count, p.last_master));
      for (std::size_t i = 0; i < kAttributes; ++i) port(p.thresholds[i], names_of(Attribute{})[i]);
      port(NAMED(p.round));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const F<V> centre = state_index<V>(item, io.grid);
    const SubpixelRecord<V> own = io.states.load(to_int(centre));
    const Vec3<V> colour = unpack_channels<V>(own);
    Range<V> range{colour, colour, 0U};
    extend_range<V>(range, io.states.load(to_int(centre - 1.0F)), io.round);
    extend_range<V>(range, io.states.load(to_int(centre + 1.0F)), io.round);
    extend_range<V>(range, io.states.load(to_int(centre - io.grid.pitch)), io.round);
    extend_range<V>(range, io.states.load(to_int(centre + io.grid.pitch)), io.round);

    F<V> threshold = kNever;
    for (std::uint32_t i = 0; i < kAttributes; ++i) {
      threshold = min(threshold, select((range.reasons & (1U << i)) == 0U, F<V>(kNever), io.thresholds[i]));
    }
    const auto differs = [&](float factor, const F<V>& least, const F<V>& most) {
      return threshold * factor * max(most + least, F<V>(1.0F)) < most - least;
    };
    const M<V> contrasts = logical_or(logical_or(differs(kChannelFactors[0], range.least.x, range.most.x),
                                                 differs(kChannelFactors[1], range.least.y, range.most.y)),
                                      differs(kChannelFactors[2], range.least.z, range.most.z));
    const M<V> found = logical_and(contrasts, own.blue_why >> kRoundShift == 0U);

    io.verdicts.store(item, {range.reasons});
    io.active.store(io.active_count.next_index(found), {item});
    const I<V> pixel = item >> 2U;
    const F<V> number = to_float(pixel);
    const F<V> last = io.last_master.get();
    const M<V> is_first = logical_and(found, last < number);
    io.last_master.set(select(is_first, number, last));
    io.masters.store(io.masters_count.next_index(is_first), {pixel});
  }

 private:
  /// Minimum and maximum of each colour channel over the neighbours that are compared, and the attributes for which
  /// these neighbours became active.
  template <class V>
  struct Range {
    Vec3<V> least, most;
    I<V> reasons;
  };
  template <class V>
  static Vec3<V> unpack_channels(const SubpixelRecord<V>& state) {
    return {to_float(state.red_green & kChannelMask), to_float(state.red_green >> 16U),
            to_float(state.blue_why & kChannelMask)};
  }
  template <class V>
  static void extend_range(Range<V>& range, const SubpixelRecord<V>& neighbour, const I<V>& round) {
    const M<V> is_fresh = (neighbour.blue_why >> kRoundShift) << kRoundShift == round;
    const Vec3<V> colour = unpack_channels<V>(neighbour);
    const Vec3<V> low = select(is_fresh, colour, range.least);
    const Vec3<V> high = select(is_fresh, colour, range.most);
    range.least = {min(range.least.x, low.x), min(range.least.y, low.y), min(range.least.z, low.z)};
    range.most = {max(range.most.x, high.x), max(range.most.y, high.y), max(range.most.z, high.z)};
    range.reasons = range.reasons | select(is_fresh, (neighbour.blue_why >> kReasonsShift) & kReasonsMask, I<V>(0U));
  }
};

/// Averages the colours of a listed pixel's sub-pixels, in four items per pixel.
struct AverageSubpixels {
  static constexpr std::string_view kName = "average_subpixels";
  static constexpr std::string_view kMeaning = "sub-pixel of a listed pixel -> mean of the pixel's sub-pixels";
  template <class V>
  struct Ports : AverageColour::Ports<V> {
    Local<V, WordRecord> masters;
    Local<V, ColourRecord> shown;
    static constexpr void describe(auto& p, auto&& port) {
      AverageColour::Ports<V>::describe(p, port);
      name_all(port, NAMED_ALL(p.masters, p.shown));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = div_mod<V>(to_float(item), io.samples, io.inverse_samples);
    const I<V> listed = io.masters.load(to_int(pixel.quotient)).word;
    AverageColour::add_sample<V>(io, pixel, io.shown.load((listed << 2U) | (item & 3U)).rgb);
  }
};

}  // namespace kernels
