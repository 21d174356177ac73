#pragma once
#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/records.h"

namespace kernels {

template <class V>
struct VertexColour {
  Vec3<V> rgb;
  F<V> alpha;
};

template <class V>
VertexColour<V> vertex_colour(const Weights<V>& corners, const VertexFields<V>& at) {
  const auto low = [&](const I<V>& a, const I<V>& b, const I<V>& c) {
    return corners.interpolate_int(a & 0xffffU, b & 0xffffU, c & 0xffffU) * (1.0F / 65535.0F);
  };
  const auto high = [&](const I<V>& a, const I<V>& b, const I<V>& c) {
    return corners.interpolate_int(a >> 16U, b >> 16U, c >> 16U) * (1.0F / 65535.0F);
  };
  return {{low(at.red_green0, at.red_green1, at.red_green2), high(at.red_green0, at.red_green1, at.red_green2),
           low(at.blue_alpha0, at.blue_alpha1, at.blue_alpha2)},
          high(at.blue_alpha0, at.blue_alpha1, at.blue_alpha2)};
}

}  // namespace kernels
