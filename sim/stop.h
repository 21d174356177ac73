#pragma once

namespace sim {

/// Polled by long computations, which throw Cancelled once it returns true.
using Stop = bool (*)();

struct Cancelled {};

}  // namespace sim
