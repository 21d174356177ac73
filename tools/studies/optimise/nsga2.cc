#include "tools/studies/optimise/nsga2.h"

#include "sim/io/module.h"

namespace tools::optimise {

const Nsga2& nsga2() {
  static const Nsga2* const loaded =
      reinterpret_cast<Nsga2Factory>(sim::load_module(RAYWATT_SEARCH_MODULE, kNsga2Symbol, "for searches"))();
  return *loaded;
}

}  // namespace tools::optimise
