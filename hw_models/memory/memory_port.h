#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "hw_models/memory/observer.h"
#include "sim/link.h"
#include "sim/machine.h"

namespace hw {

/// A unit that requests lines, and how many of them can be outstanding.
struct MemoryClient {
  sim::UnitId unit;
  std::uint32_t lines = 1;
  RequesterKind requester = RequesterKind::kNodes;
};

/// A client's links to its port.
struct MemoryPort {
  sim::Link<MemRequest>& requests;
  sim::Link<MemResponse>& responses;
  std::uint16_t client = 0;  ///< its index at the port, which it writes into MemRequest::source
};

}  // namespace hw
