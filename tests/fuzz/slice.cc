#include "sim/io/json.h"
#include "tests/fuzz/common.h"
#include "tools/sampling/slices.h"

// Fuzz target: results of a slice of a frame, as the store keeps them. They are read, written and read again.

namespace {

/// Returns a machine of one unit and one kernel before its first cycle.
tools::MachineSpan initial_state() {
  tools::MachineSpan machine;
  sim::UnitReport& unit = machine.units.emplace_back();
  unit.path = "core0";
  unit.cycles_by_reason = {{"busy", 0}, {"idle", 0}};
  unit.counters.emplace_back();
  machine.kernels.emplace_back();
  return machine;
}

void round_trip_text(std::string_view text) {
  try {
    const sim::Json written = tools::slice_json(tools::read_slice(sim::parse_json(text), initial_state()));
    if (tools::slice_json(tools::read_slice(written, initial_state())) != written) std::abort();
  } catch (const sim::JsonError&) {  // text that is not JSON; the store's checksum rejects it
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  return fuzz::mutate_json(data, size, most, seed);
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::ignore_input_errors([&] { round_trip_text(fuzz::text_of(data, size)); });
  return 0;
}
