#pragma once

namespace sim {

/// Asked now and then by long work; once it says true the work gives up and throws Cancelled.
using Stop = bool (*)();

struct Cancelled {};

}  // namespace sim
