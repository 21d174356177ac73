#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "hw_models/memory/observer.h"
#include "sim/link.h"
#include "sim/machine.h"

namespace hw {

/// A unit that requests memory lines, and the maximum number of its outstanding requests.
struct MemoryClient {
  sim::UnitId unit;
  std::uint32_t lines = 1;
  RequesterKind requester = RequesterKind::kNodes;
};

/// The links between a unit and its core's port to memory.
struct MemoryPort {
  sim::Link<MemRequest>& requests;
  sim::Link<MemResponse>& responses;
  std::uint16_t client = 0;  ///< the unit's client number at the port, for MemRequest::source
};

}  // namespace hw
