#pragma once
#include <array>
#include <string_view>

#include "sim/config/field.h"

namespace hw {

/// Resources made perfect, one or several at a time: what the machine would do if they cost no time. Each run with one
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
    std::string_view name;
    bool IdealConfig::*member;
  };
  static const std::array<Resource, 7> kResources;

  static void describe(auto& c, auto&& field) {
    const auto perfect = [&](auto& value, const char* name, const char* meaning) {
      field(value, name, "", meaning, sim::any(), sim::Affects::kTiming);
    };
    perfect(c.tni, "tni",
            "T&I units do any number of operations a cycle, each in one cycle, on 64 rays a traversal unit; their "
            "caches stay as they are");
    perfect(c.l1, "l1", "every probe of a node, triangle or data cache hits");
    perfect(c.l2, "l2", "every look-up hits, any number a cycle, each in one cycle");
    perfect(c.dram, "dram", "channels take any number of requests a cycle and answer each a cycle later");
    perfect(c.srp, "srp",
            "kernels cost no time: any number of items a cycle, no switches; they still wait for lines that their data "
            "cache "
            "does not have");
    perfect(c.tile_buffer, "tile_buffer", "room for every ray slot, any number of accesses a cycle");
    perfect(c.interconnect, "interconnect", "any number of requests and lines a cycle, each in one cycle");
  }
};

inline constexpr std::array<IdealConfig::Resource, 7> IdealConfig::kResources = {
    {{"tni", &IdealConfig::tni},
     {"l1", &IdealConfig::l1},
     {"l2", &IdealConfig::l2},
     {"dram", &IdealConfig::dram},
     {"srp", &IdealConfig::srp},
     {"tile_buffer", &IdealConfig::tile_buffer},
     {"interconnect", &IdealConfig::interconnect}}};

}  // namespace hw
