#pragma once
#include <array>
#include <string_view>
#include <vector>

#include "shader_kernels/ports.h"

namespace kernels {

/// Ports of a fused kernel: the ports of all kernels in it. Ports with the same name are the same memory or uniform.
template <class V, class... Parts>
struct FusedPorts : Parts::template Ports<V>... {
  static constexpr void describe(auto& p, auto&& port) {
    (Parts::template Ports<V>::describe(static_cast<typename Parts::template Ports<V>&>(p), port), ...);
  }
};

/// A kernel that runs several kernels, its parts, on each item in turn:
///
///   item --> body of the first part --> ... --> body of the last
///
/// In the graph, values that one part passes to the next stay in registers (remove_repeated_accesses). A memory listed
/// in kRegisters is read by no other kernel, so its stores are dropped.
template <class... Parts>
struct Fused {
  /// Returns the names of the kernels that the fused kernel runs.
  static std::vector<std::string_view> part_names() {
    std::vector<std::string_view> names;
    (append_part_name<Parts>(names), ...);
    return names;
  }
  static constexpr std::array<std::string_view, 0> kRegisters{};
  /// Calls f<Part>() for each kernel in the fused kernel.
  static void for_each_part(auto&& f) { (f.template operator()<Parts>(), ...); }
  template <class V>
  using Ports = FusedPorts<V, Parts...>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    (Parts::template body<V>(item, io), ...);
  }

 private:
  template <class Part>
  static void append_part_name(std::vector<std::string_view>& names) {
    if constexpr (requires { typename Part::Of; }) {
      names.push_back(Part::Of::kName);
    } else if constexpr (requires { Part::kName; }) {
      names.push_back(Part::kName);
    }
  }
};

/// Returns the subset of a fused kernel's ports that belongs to kernel K, one of its parts.
template <class K>
typename K::template Ports<float>& ports_of(typename K::template Ports<float>& fused) {
  return fused;
}

template <class V, class... Parts>
inline constexpr bool kListsAccesses<FusedPorts<V, Parts...>> = (kListsAccesses<typename Parts::template Ports<V>> ||
                                                                 ...);

}  // namespace kernels
