#include "tools/sampling/slice_file.h"

#include <cmath>
#include <iterator>
#include <span>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace tools {
namespace {

using sim::Json;

/// Keys of counts of kernels, sampling and slices.
constexpr std::pair<const char*, std::uint64_t hw::KernelUse::*> kKernelCounts[] = {
    {"launches", &hw::KernelUse::launches},
    {"items", &hw::KernelUse::items},
    {"idle", &hw::KernelUse::idle},
    {"cycles", &hw::KernelUse::cycles},
    {"starved", &hw::KernelUse::starved}};
constexpr std::pair<const char*, std::uint64_t kernels::Sampling::*> kSamplingCounts[] = {
    {"wanted", &kernels::Sampling::wanted},
    {"traced", &kernels::Sampling::traced},
    {"background", &kernels::Sampling::background},
    {"traced_background", &kernels::Sampling::traced_background}};
constexpr std::pair<const char*, std::uint32_t Slice::*> kSliceTiles[] = {
    {"first", &Slice::first}, {"end", &Slice::end}, {"lead", &Slice::lead}, {"warming", &Slice::warming}};

/// Parses counts and lists of them.
std::uint64_t count_in(const Json& json) { return sim::whole_number<std::uint64_t>(json, "a count"); }
const Json& list_in(const Json& json, std::size_t size, const char* what) {
  if (json.is_array() && json.size() == size) return json;
  throw sim::InputError(fmt::format("{} are no list of {}", what, size));
}
double amount_in(const Json& json) {
  const double amount = json.is_number() ? json.get<double>() : -1;
  if (amount >= 0 && std::isfinite(amount)) return amount;
  throw sim::InputError("an amount is no number from 0 on");
}

template <class Members, class Counted>
Json counts_json(const Members& members, const Counted& counted) {
  Json out;
  for (const auto& [name, member] : members) out[name] = counted.*member;
  return out;
}
template <class Members, class Counted>
void read_counts(const Members& members, const Json& json, Counted& counted) {
  for (const auto& [name, member] : members) {
    using Count = std::remove_reference_t<decltype(counted.*member)>;
    counted.*member = sim::whole_number<Count>(json.at(name), name);
  }
}

Json unit_json(const sim::UnitReport& unit) {
  Json why = Json::array(), counters = Json::array();
  for (const auto& [reason, cycles] : unit.cycles_by_reason) why.push_back(cycles);
  for (const sim::CounterReport& counter : unit.counters) counters.push_back(counter.value);
  return {{"path", unit.path}, {"elapsed", unit.elapsed}, {"why", why}, {"counters", counters}};
}

void read_unit(const Json& json, sim::UnitReport& unit) {
  if (json.at("path") != unit.path) throw sim::InputError(fmt::format("there is no unit {}", unit.path));
  unit.elapsed = count_in(json.at("elapsed"));
  const Json& why = list_in(json.at("why"), unit.cycles_by_reason.size(), "a unit's reasons");
  for (std::size_t i = 0; i < unit.cycles_by_reason.size(); ++i) unit.cycles_by_reason[i].second = count_in(why[i]);
  const Json& counters = list_in(json.at("counters"), unit.counters.size(), "a unit's counters");
  for (std::size_t i = 0; i < unit.counters.size(); ++i) unit.counters[i].value = count_in(counters[i]);
}

void read_span(const Json& json, MachineSpan& own) {
  own.time = count_in(json.at("time"));
  const Json& units = list_in(json.at("units"), own.units.size(), "units");
  for (std::size_t u = 0; u < own.units.size(); ++u) read_unit(units[u], own.units[u]);
  const Json& kernels = list_in(json.at("kernels"), own.kernels.size(), "kernels");
  for (std::size_t k = 0; k < own.kernels.size(); ++k) read_counts(kKernelCounts, kernels[k], own.kernels[k]);
}

Json probe_json(const Probe& probe) { return {{"time", probe.time}, {"energy_pj", probe.energy_pj}}; }
Probe read_probe(const Json& json) { return {amount_in(json.at("time")), amount_in(json.at("energy_pj"))}; }

void read_function(const Json& json, RenderResult& function) {
  const Json& rays = list_in(json.at("rays"), std::size(function.rays), "rays");
  for (std::size_t k = 0; k < std::size(function.rays); ++k) function.rays[k] = count_in(rays[k]);
  function.continued = count_in(json.at("continued"));
  function.traversal_steps = count_in(json.at("traversal_steps"));
  read_counts(kSamplingCounts, json.at("sampling"), function.sampling);
}

}  // namespace

Json slice_json(const SlicePart& part) {
  const PlayedSlice& played = part.played;
  const RenderResult& function = part.rendered;
  Json units = Json::array(), kernels = Json::array();
  for (const sim::UnitReport& unit : played.own.units) units.push_back(unit_json(unit));
  for (const hw::KernelUse& use : played.own.kernels) kernels.push_back(counts_json(kKernelCounts, use));
  return {{"tiles", counts_json(kSliceTiles, played.slice)},
          {"time", played.own.time},
          {"units", units},
          {"kernels", kernels},
          {"before", probe_json(played.before)},
          {"after", probe_json(played.after)},
          {"function",
           {{"rays", std::span(function.rays)},
            {"continued", function.continued},
            {"traversal_steps", function.traversal_steps},
            {"sampling", counts_json(kSamplingCounts, function.sampling)}}},
          {"host",
           {{"slice_s", played.seconds},
            {"timing_s", played.timing_seconds},
            {"functional_s", function.seconds},
            {"waited_s", function.waited},
            {"wall_s", part.wall_seconds}}}};
}

SlicePart read_slice(const Json& json, MachineSpan nothing) {
  try {
    SlicePart part;
    PlayedSlice& played = part.played;
    read_counts(kSliceTiles, json.at("tiles"), played.slice);
    played.own = std::move(nothing);
    read_span(json, played.own);
    played.before = read_probe(json.at("before"));
    played.after = read_probe(json.at("after"));
    read_function(json.at("function"), part.rendered);
    const Json& host = json.at("host");
    played.seconds = amount_in(host.at("slice_s"));
    played.timing_seconds = amount_in(host.at("timing_s"));
    part.rendered.seconds = amount_in(host.at("functional_s"));
    part.rendered.waited = amount_in(host.at("waited_s"));
    part.wall_seconds = amount_in(host.at("wall_s"));
    return part;
  } catch (const sim::JsonError& error) {
    throw sim::InputError(sim::printable(error.what()));
  }
}

}  // namespace tools
