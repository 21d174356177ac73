#pragma once
#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "shader_kernels/graph.h"
#include "shader_kernels/ports.h"

namespace kernels {

/// Ports of a fused kernel: those of all its parts. Ports that have one name are one memory or one uniform.
template <class V, class... Parts>
struct FusedPorts : Parts::template Ports<V>... {
  static constexpr void describe(auto& p, auto&& port) {
    (Parts::template Ports<V>::describe(static_cast<typename Parts::template Ports<V>&>(p), port), ...);
  }
};

/// A kernel made of others, its parts, which an item goes through one after the other:
///
///   item --> body of the first part --> ... --> body of the last
///
/// With floats that is all there is to it. In its graph what one part leaves for the next stays in registers
/// (keep_in_registers). Memories in kRegisters are read by nobody else, so nothing of them is stored.
template <class... Parts>
struct Fused {
  /// Kernels that do the same by launches of their own.
  static std::vector<std::string_view> parts() {
    std::vector<std::string_view> names;
    (add_name<Parts>(names), ...);
    return names;
  }
  static constexpr std::array<std::string_view, 0> kRegisters{};
  /// Calls f<Part>() for every part.
  static void for_each_part(auto&& f) { (f.template operator()<Parts>(), ...); }
  template <class V>
  using Ports = FusedPorts<V, Parts...>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    (Parts::template body<V>(item, at), ...);
  }

 private:
  template <class Part>
  static void add_name(std::vector<std::string_view>& names) {
    if constexpr (requires { typename Part::Of; }) {
      names.push_back(Part::Of::kName);
    } else if constexpr (requires { Part::kName; }) {
      names.push_back(Part::kName);
    }
  }
};

/// Ports of part K.
template <class K>
typename K::template Ports<float>& ports_of(typename K::template Ports<float>& fused) {
  return fused;
}

template <class V, class... Parts>
inline constexpr bool kListsAccesses<FusedPorts<V, Parts...>> = (kListsAccesses<typename Parts::template Ports<V>> ||
                                                                 ...);

/// Takes a fused kernel's graph from memory to registers where an item itself has loaded or stored a record before:
///
///   load, load of the same          -> one load              store, load of the same  -> the value stored
///   equal operations, equal values  -> one operation         store, store of the same -> the second
///   store to one of `registers`     -> nothing
///
/// Throws std::logic_error if a part loads what another may have stored under another index.
void keep_in_registers(Graph& graph, std::span<const std::string_view> registers);

}  // namespace kernels
