#include <string>

#include <gtest/gtest.h>

#include "sim/report/energy.h"
#include "tests/validation/figures.h"
#include "tools/run/frame/run_job.h"

// Compares energy per ray and rays per area of scaled tables with published chips (docs/processes.md).

namespace tools {
namespace {

/// Results of the Cornell box on the default machine in one process, with bands from the tables.
struct PerRay {
  sim::Band chip_nj;  ///< without the memory
  sim::Band tni_nj;
  sim::Band mrays_per_s_per_mm2;
};

PerRay measure_in(const std::string& process) {
  JobOptions options;
  options.resolution = "512x256";
  options.sets = {"process=" + process};
  const Inputs inputs = load_inputs(options);
  const FrameResult run = simulate_frame(inputs, kernels::parse_program("full:1"), 0);
  const auto rays = static_cast<double>(run.rays());
  const double mrays_per_s = rays / (static_cast<double>(run.elapsed) * 1e-15) / 1e6;
  const sim::Band area = sim::compute_area(run.units, inputs.config.energy, inputs.config.area).total;
  const sim::Band memory = run.energy.blocks.at("dram").total();
  const double nj_per_pj = 1e-3 / rays;
  return {(run.energy.total_pj + memory * -1) * nj_per_pj,
          run.energy.blocks.at("tni").total() * nj_per_pj,
          {mrays_per_s / area.high, mrays_per_s / area.nominal, mrays_per_s / area.low}};
}

// Source: RayCore (embedded.com, "1W core"): 239 Mrays/s, 1 W and 18 mm2 at 28 nm.
TEST(ProcessAnchors, RayCoreIsInsideTheBandsOf28Nm) {
  const PerRay at = measure_in("28nm");
  const double nj = 1 / 239e6 * 1e9, per_mm2 = 239.0 / 18;
  expect_between("nJ per ray of the chip", nj, at.chip_nj.low, at.chip_nj.high);
  expect_between("nJ per ray of the T&I units", nj, at.tni_nj.low, at.tni_nj.high);
  expect_between("Mrays/s/mm2 of the chip", per_mm2, at.mrays_per_s_per_mm2.low, at.mrays_per_s_per_mm2.high);
}

// RayCore MC's maker expects 5 Mrays/s/mW (0.2 nJ) and 300 Mrays/s/mm2 at 5 nm. Both are outside: DEVIATIONS.md, D4.
TEST(ProcessAnchors, TheClaimFor5NmIsBeyondTheBands) {
  const PerRay at = measure_in("5nm");
  expect_between("low edge of nJ per ray of the T&I units", at.tni_nj.low, 0.2, 0.3);
  EXPECT_LT(at.mrays_per_s_per_mm2.high, 300);
}

}  // namespace
}  // namespace tools
