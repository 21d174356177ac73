#pragma once
#include <array>

#include "sim/config/field.h"

namespace hw {

/// Resources made ideal, one or several at a time: what the machine would do if they cost no time. Each run with one
/// of them gives a bound on what better hardware of that kind can bring.
struct IdealConfig {
  bool tni = false;
  bool l1 = false;
  bool l2 = false;
  bool dram = false;
  bool srp = false;
  bool tile_buffer = false;
  bool interconnect = false;

  struct Resource {
    const char* name;
    const char* words;  ///< in the plural, for sentences
    bool IdealConfig::*member;
    const char* meaning;
  };
  static const std::array<Resource, 7> kResources;

  static void describe(auto& c, auto&& field) {
    for (const Resource& r : kResources) {
      field(c.*r.member, r.name, "", r.meaning, sim::any(), sim::Affects::kTiming);
    }
  }
};

inline constexpr std::array<IdealConfig::Resource, 7> IdealConfig::kResources = {{
    {"tni", "T&I units", &IdealConfig::tni,
     "T&I units do any number of operations a cycle, each in one cycle, on 64 rays a traversal unit; their caches stay "
     "as they are"},
    {"l1", "first-level caches", &IdealConfig::l1, "every probe of a node, triangle or data cache hits"},
    {"l2", "L2 banks", &IdealConfig::l2, "every look-up hits, any number a cycle, each in one cycle"},
    {"dram", "memory channels", &IdealConfig::dram,
     "channels take any number of requests a cycle and answer each a cycle later"},
    {"srp", "shader cores", &IdealConfig::srp,
     "kernels cost no time: any number of items a cycle, no switches; they still wait for lines that their data cache "
     "does not have"},
    {"tile_buffer", "tile buffers", &IdealConfig::tile_buffer,
     "room for every ray slot, any number of accesses a cycle"},
    {"interconnect", "core ports and wires", &IdealConfig::interconnect,
     "any number of requests and lines a cycle, each in one cycle"},
}};

}  // namespace hw
