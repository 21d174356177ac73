#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "hw_models/build/tree_builder.h"
#include "hw_models/dram/dram_channel.h"
#include "hw_models/frame/dma.h"
#include "hw_models/frame/memory_interface.h"
#include "hw_models/frame/tile_dispatcher.h"
#include "hw_models/memory/background_source.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/memory/system_cache.h"
#include "hw_models/raster/raster_unit.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/predictor_stage.h"
#include "hw_models/tni/ray_dispatcher.h"
#include "hw_models/tni/trv.h"

namespace hw {

/// Name and cycle reasons of one kind of unit, for code that works on unit reports instead of units.
struct UnitKind {
  std::string_view name;  ///< name of the kind: "core.tni.trv" for a unit "core0.tni.trv2"
  std::span<const sim::Reason> reasons;
};

/// All kinds of units, starting with memory: each kind precedes the kinds that wait for it.
inline constexpr std::array<UnitKind, 17> kUnitKinds = {{{DramChannel::kName, DramChannel::kReasons},
                                                         {BackgroundSource::kName, BackgroundSource::kReasons},
                                                         {SystemCacheSlice::kName, SystemCacheSlice::kReasons},
                                                         {L2Bank::kName, L2Bank::kReasons},
                                                         {CorePort::kCachePort, CorePort::kReasons},
                                                         {CorePort::kDmaPort, CorePort::kReasons},
                                                         {Dma::kName, Dma::kReasons},
                                                         {MemoryInterface::kName, MemoryInterface::kReasons},
                                                         {Ist::kName, Ist::kReasons},
                                                         {Trv::kName, Trv::kReasons},
                                                         {RayDispatcher::kName, RayDispatcher::kReasons},
                                                         {PredictorStage::kName, PredictorStage::kReasons},
                                                         {RasterUnit::kName, RasterUnit::kReasons},
                                                         {TreeBuilder::kName, TreeBuilder::kReasons},
                                                         {TileBuffer::kName, TileBuffer::kReasons},
                                                         {Srp::kName, Srp::kReasons},
                                                         {TileDispatcher::kName, TileDispatcher::kReasons}}};

/// Returns the category of a cycle reason, such as waiting or idle. `unit_kind`: a kind of unit ("core.tni.trv"). Empty
/// if the unit has no such reason.
inline std::optional<sim::ReasonKind> kind_of_reason(std::string_view unit_kind, std::string_view reason_name) {
  const auto kind = std::ranges::find(kUnitKinds, unit_kind, &UnitKind::name);
  if (kind == kUnitKinds.end()) return {};
  const auto declared = std::ranges::find(kind->reasons, reason_name, &sim::Reason::name);
  if (declared == kind->reasons.end()) return {};
  return declared->kind;
}

}  // namespace hw
