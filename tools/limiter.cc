#include "tools/limiter.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <string_view>

namespace tools {

namespace {

/// Where the time of all units of one kind went, as shares.
class Shares {
 public:
  Shares(std::span<const sim::UnitReport> units, std::string_view kind) {
    for (const sim::UnitReport& unit : units) {
      if (unit.path.find(kind) == std::string::npos) continue;
      elapsed_ += static_cast<double>(unit.elapsed);
      for (const auto& [reason, cycles] : unit.why) cycles_[reason] += static_cast<double>(cycles);
    }
  }
  double of(std::initializer_list<const char*> reasons) const {
    double sum = 0;
    for (const char* reason : reasons) {
      const auto found = cycles_.find(reason);
      if (found != cycles_.end()) sum += found->second;
    }
    return elapsed_ > 0 ? sum / elapsed_ : 0;
  }

 private:
  std::map<std::string, double> cycles_;
  double elapsed_ = 0;
};

}  // namespace

Utilisation utilisation(std::span<const sim::UnitReport> units) {
  return {Shares(units, ".trv").of({"visiting"}), Shares(units, ".srp").of({"running"}),
          Shares(units, "dram.").of({"reading", "writing"})};
}

std::string limiter(std::span<const sim::UnitReport> units) {
  const Shares trv(units, ".trv"), ist(units, ".ist"), srp(units, ".srp"), dram(units, "dram.");
  struct Candidate {
    double share;
    std::string words;
  };
  const auto percent = [](double share) { return fmt::format("{:.0f} %", 100 * share); };
  const double transfers = dram.of({"reading", "writing"});
  const double arrays = srp.of({"running", "switching"});
  const double misses = srp.of({"cache_miss"});
  const double boxes = trv.of({"visiting"});
  const double tests = ist.of({"testing"});
  if (transfers >= 0.8) return fmt::format("DRAM bandwidth: data on the buses {} of the time", percent(transfers));
  if (boxes >= 0.8) return fmt::format("traversal throughput: box pipes busy {} of the time", percent(boxes));
  if (tests >= 0.8) return fmt::format("intersection throughput: triangle pipes busy {} of the time", percent(tests));
  const double waiting_for_lines = trv.of({"l1_miss", "mshr_full"});
  const std::vector<Candidate> candidates = {
      {boxes, fmt::format("traversal throughput: box pipes busy {} of the time", percent(boxes))},
      {waiting_for_lines,
       fmt::format("memory latency of traversal: TRVs wait for node lines {} of the time", percent(waiting_for_lines))},
      {trv.of({"ist"}), fmt::format("intersection units: TRVs wait for triangle tests {} of the time",
                                    percent(trv.of({"ist"})))},
      {trv.of({"pipe"}), fmt::format("traversal latency: too few rays for the box pipes {} of the time",
                                     percent(trv.of({"pipe"})))},
      {trv.of({"output_full"}), fmt::format("direct interface: finished rays cannot leave the TRVs {} of the time",
                                            percent(trv.of({"output_full"})))}};
  // Starved TRVs mean that the shader core holds the frame back; its own time says how.
  if (trv.of({"starved"}) < 0.4) return std::ranges::max_element(candidates, {}, &Candidate::share)->words;
  const double slots = srp.of({"no_slots"});
  const std::vector<Candidate> shading = {
      {arrays, fmt::format("shader core throughput: array running or switching kernels {} of the time", percent(arrays))},
      {misses, fmt::format("shader core's data cache: array stalled by misses {} of the time", percent(misses))},
      {slots, fmt::format("tile buffer: launches wait for ray slots {} of the time", percent(slots))},
      {srp.of({"waiting"}), fmt::format("latency between waves: shader cores wait for rays {} of the time",
                                        percent(srp.of({"waiting"})))},
      {srp.of({"starved"}), fmt::format("too few tiles: shader cores without one {} of the time",
                                        percent(srp.of({"starved"})))}};
  return std::ranges::max_element(shading, {}, &Candidate::share)->words;
}

}  // namespace tools
