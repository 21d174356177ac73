#include "shader_kernels/catalogue.h"

#include <algorithm>
#include <utility>

#include "shader_kernels/recorder.h"

namespace kernels {
namespace {

template <class K>
KernelInfo record_one() {
  KernelInfo info{kKernelId<K>, K::kName, K::kMeaning, record_graph<K>()};
  if constexpr (requires { K::part_names(); }) info.parts = K::part_names();
  return info;
}

template <class... Ks>
std::vector<KernelInfo> record_all(std::type_identity<std::tuple<Ks...>>) {
  return {record_one<Ks>()...};
}

}  // namespace

const std::vector<KernelInfo>& kernel_catalogue() {
  static const std::vector<KernelInfo> all = record_all(std::type_identity<AllKernels>{});
  return all;
}

const KernelInfo* find_kernel(std::string_view name) {
  const auto at = std::ranges::find(kernel_catalogue(), name, &KernelInfo::name);
  return at == kernel_catalogue().end() ? nullptr : &*at;
}

}  // namespace kernels
