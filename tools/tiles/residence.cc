#include "tools/tiles/residence.h"

#include <algorithm>
#include <cstddef>

namespace tools {

Residence residence(std::span<const hw::TileAccount> tiles, sim::Time elapsed, std::optional<std::uint32_t> core) {
  struct Event {
    sim::Time at;
    std::size_t tile;
    bool comes;
  };
  std::vector<Event> events;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (core && tiles[i].core != *core) continue;
    events.push_back({tiles[i].dispatched, i, true});
    events.push_back({tiles[i].finished, i, false});
  }
  std::ranges::stable_sort(events, {}, &Event::at);
  Residence shares{std::vector<double>(tiles.size()), 0};
  const auto whole = static_cast<double>(elapsed);
  // Cumulative time of a tile that was present from the start; a tile's own time is the difference of two such values.
  double reached = 0;
  sim::Time now = 0;
  std::size_t present = 0;
  const auto advance = [&](sim::Time to) {
    const double share = static_cast<double>(to - now) / whole;
    if (present == 0) {
      shares.rest += share;
    } else {
      reached += share / static_cast<double>(present);
    }
    now = to;
  };
  for (const Event& event : events) {
    advance(event.at);
    present += event.comes ? 1 : std::size_t(-1);
    shares.tiles[event.tile] = event.comes ? reached : reached - shares.tiles[event.tile];
  }
  advance(elapsed);
  return shares;
}

}  // namespace tools
