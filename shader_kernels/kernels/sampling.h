#pragma once
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Which mip levels a texture lookup reads.
enum class MipFilter : std::uint8_t {
  kNone,     ///< lookups read the full texture; there are no mip maps
  kNearest,  ///< lookups read the level whose texel size is nearest to the footprint
  kLinear,   ///< lookups blend the two nearest levels (trilinear)
};

/// Returns the name of a kernel variant: one of three names, selected by the mip filter kMips.
template <MipFilter kMips>
constexpr std::string_view variant_name_by_filter(std::string_view none, std::string_view nearest,
                                                  std::string_view linear) {
  return kMips == MipFilter::kNone ? none : kMips == MipFilter::kNearest ? nearest : linear;
}

/// The four texels around a texture position, and their bilinear weights.
template <class V>
struct TexelSample {
  FootprintRecord<V> texels;
  F<V> right, lower;  ///< bilinear weights of the two right texels and of the two lower texels
  /// Returns the bilinear blend of one value of the four texels. `channel` extracts the value from a texel's bits.
  F<V> blend_texels(auto&& channel) const {
    const F<V> upper_left = channel(texels.at00), lower_left = channel(texels.at01);
    const F<V> upper = upper_left + (channel(texels.at10) - upper_left) * right;
    const F<V> low = lower_left + (channel(texels.at11) - lower_left) * right;
    return upper + (low - upper) * lower;
  }
  /// Returns one bilinearly blended channel of a linear texture. `channel`: 0 is red, 3 is alpha.
  F<V> linear_channel(std::uint32_t channel) const {
    return blend_texels([&](const I<V>& rgba) { return to_float(extract_byte<V>(rgba, channel)) * (1.0F / 255.0F); });
  }
  /// Returns the blended colour of an sRGB texture. Texels are decoded before they are blended.
  Vec3<V> srgb_colour(const Table<V, SrgbCodeRecord>& codes) const {
    const auto decoded = [&](std::uint32_t channel) {
      return blend_texels([&](const I<V>& rgba) { return codes.load(extract_byte<V>(rgba, channel)).linear; });
    };
    const F<V> red = decoded(0), green = decoded(1), blue = decoded(2);
    return {red, green, blue};
  }
};

/// The two texels around a texture coordinate along one axis, and the weight of the second.
template <class V>
struct TexelPair {
  I<V> first, second;
  F<V> weight;
};
template <class V>
TexelPair<V> find_texel_pair(const F<V>& coordinate, const AxisRecord<V>& axis) {
  const F<V> bounded = min(max(coordinate, axis.low), axis.high);
  const F<V> folded = bounded - floor(bounded * axis.inverse_period) * axis.period;
  const F<V> texel = min(folded, 2.0F - folded) * axis.size - axis.offset;
  const F<V> first = floor(texel);
  const F<V> second = first + (axis.offset + axis.offset);
  return {to_int(select(first < 0.0F, axis.below, first)),
          to_int(select(axis.last < second, axis.last - axis.below, second)), texel - first};
}

/// Fetches the four texels around (u, v) from a texture. Texel (0, 0) is at the top left, where v is 0. A texture has
/// two entries in `axes`, for u and v.
template <class V>
TexelSample<V> sample_texture(const Table<V, AxisRecord>& axes, const Texels<V>& texels, const I<V>& texture,
                              const F<V>& u, const F<V>& v) {
  const I<V> axis = texture << 1U;
  const TexelPair<V> x = find_texel_pair<V>(u, axes.load(axis));
  const TexelPair<V> y = find_texel_pair<V>(v, axes.load(axis + 1U));
  return {texels.load(texture, (y.first << 16U) | x.first, (y.second << 16U) | x.second), x.weight, y.weight};
}

/// Texture samples of two neighbouring mip levels, and the weight of the second.
template <class V>
struct TrilinearSample {
  TexelSample<V> fine, coarse;
  F<V> weight;
  F<V> linear_channel(std::uint32_t channel) const {
    return blend_levels(fine.linear_channel(channel), coarse.linear_channel(channel));
  }
  Vec3<V> srgb_colour(const Table<V, SrgbCodeRecord>& codes) const {
    const Vec3<V> a = fine.srgb_colour(codes), b = coarse.srgb_colour(codes);
    return {blend_levels(a.x, b.x), blend_levels(a.y, b.y), blend_levels(a.z, b.z)};
  }

 private:
  F<V> blend_levels(const F<V>& a, const F<V>& b) const { return a + (b - a) * weight; }
};

/// Mask of the bits of TexcoordRecord::texture that hold the texture number. In scenes with mip maps the other bits
/// hold the footprint of the ray.
inline constexpr std::uint32_t kTextureMask = traces::kMostMipLevels - 1;
template <class V>
I<V> pack_footprint(const I<V>& texture, const F<V>& footprint) {
  return (texture & kTextureMask) | (bits_of(footprint) & ~kTextureMask);
}
template <class V>
F<V> unpack_footprint(const I<V>& word) {
  return from_bits(word & ~kTextureMask);
}

/// Ports through which a kernel looks up textures.
template <class V, MipFilter kMips>
struct TexturePorts {
  Table<V, AxisRecord> axes;     ///< addressing modes, two records (u, v) for each texture
  Table<V, LevelRecord> levels;  ///< parameters of the mip levels, one record for each texture; used only with mip maps
  Texels<V> texels;
  static constexpr void describe(auto& p, auto&& port) {
    port(NAMED(p.axes));
    if constexpr (kMips != MipFilter::kNone) port(NAMED(p.levels));
    port(NAMED(p.texels));
  }
  /// Looks up a mip-mapped texture with first level `texture` for a footprint in texture coordinates. The level is the
  /// logarithm of the footprint in texels, read from the bits of this float: its exponent is the number of the level,
  /// and its mantissa is the blending weight.
  auto sample_mip_level(const I<V>& texture, const F<V>& footprint, const F<V>& u, const F<V>& v) const {
    const LevelRecord<V> chain = levels.load(texture);
    const I<V> across = bits_of(min(max(footprint * chain.size, F<V>(1.0F)), chain.highest));
    const I<V> level = texture + ((across >> 23U) - 127U);
    const TexelSample<V> fine = sample_texture<V>(axes, texels, level, u, v);
    if constexpr (kMips == MipFilter::kNearest) {
      return fine;
    } else {
      const F<V> weight = from_bits((across & 0x7fffffU) | 0x3f800000U) - 1.0F;
      const I<V> next = level + select(F<V>(0.0F) < weight, I<V>(1U), I<V>(0U));
      const TexelSample<V> coarse = sample_texture<V>(axes, texels, next, u, v);
      return TrilinearSample<V>{fine, coarse, weight};
    }
  }
};

/// Returns the number of the surface's base texture.
template <class V, MipFilter kMips>
I<V> texture_number(const TexcoordRecord<V>& uv) {
  if constexpr (kMips == MipFilter::kNone) {
    return uv.texture;
  } else {
    return uv.texture & kTextureMask;
  }
}

/// Ports of kernels that apply a texture to the surfaces in a list, `stream`.
template <class V, MipFilter kMips>
struct DetailPorts : TexturePorts<V, kMips> {
  Local<V, WordRecord> stream;
  Local<V, DiffuseRecord> mattes;
  Local<V, TexcoordRecord> texcoords;
  Local<V, TangentRecord> tangents;
  static constexpr void describe(auto& p, auto&& port) {
    TexturePorts<V, kMips>::describe(p, port);
    name_all(port, NAMED_ALL(p.stream, p.mattes, p.texcoords, p.tangents));
  }
  /// Looks up a texture with the first set of texture coordinates, or with the second set if the surface's material
  /// classes have the flag `second`. Look-ups with the second set read mip level 0, because the ray's footprint is
  /// known in the first set only.
  auto look_up(const I<V>& texture, const I<V>& classes, traces::MaterialFlag second, const TexcoordRecord<V>& uv,
               const TangentRecord<V>& other) const {
    const M<V> use_second = has_flag<V>(classes, second);
    const F<V> u = select(use_second, other.u, uv.u), v = select(use_second, other.v, uv.v);
    if constexpr (kMips == MipFilter::kNone) {
      return sample_texture<V>(this->axes, this->texels, texture, u, v);
    } else {
      const F<V> footprint = select(use_second, F<V>(0.0F), unpack_footprint<V>(uv.texture));
      return this->sample_mip_level(texture, footprint, u, v);
    }
  }
};

}  // namespace kernels
