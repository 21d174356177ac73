#pragma once
#include <cstdint>

#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

template <class K>
Wavefront::Node Wavefront::launch(typename K::template Ports<float>& ports, std::uint32_t items, std::uint32_t lanes,
                                  std::uint32_t padding) {
  constexpr bool kReads = kListsAccesses<typename K::template Ports<float>>;
  constexpr bool kEmits = requires { ports.emitted; };
  const std::uint32_t idle = scene_.diverges && lanes > items ? lanes - items : padding;
  const Node node = stream_.launch(kKernelId<K>, items, kReads, idle);
  sources_.bind<K>(ports, accesses());
  typename K::template Ports<float> at = ports;  // a copy whose address nobody has stays in registers
  if (!stream_.is_on()) {
    for (std::uint32_t i = 0; i < items; ++i) K::template body<float>(i, at);
  } else {
    for (std::uint32_t i = 0; i < items; ++i) {
      if constexpr (kReads) stream_.begin_item();
      if constexpr (kEmits) {
        const std::uint32_t before = at.emitted.value;
        K::template body<float>(i, at);
        if (at.emitted.value != before) stream_.add_source(i);
      } else {
        K::template body<float>(i, at);
      }
    }
  }
  ports = at;
  return node;
}

}  // namespace kernels
