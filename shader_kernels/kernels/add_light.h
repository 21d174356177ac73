#pragma once
#include "shader_kernels/ports.h"

namespace kernels {

/// Adds to a sample's colour. Two items of one sample that are in the array at once would read a stale sum; streams
/// keep such items far apart (one launch per light, reflections before refractions), so no interlock is modelled.
template <class V>
void add_light(const Local<V, ColourRecord>& colours, const I<V>& sample, const Vec3<V>& light) {
  colours.store(sample, {colours.load(sample).rgb + light});
}

}  // namespace kernels
