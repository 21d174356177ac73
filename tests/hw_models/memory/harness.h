#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "hw_models/memory/core_port.h"
#include "hw_models/memory/dram_channel.h"
#include "hw_models/memory/l2_bank.h"
#include "sim/engine.h"
#include "sim/hash.h"
#include "sim/report/unit_report.h"

namespace hw::test {

inline const sim::Clock kClock(2'000'000);

/// Sends a list of requests, each not before its cycle, and notes when each answer came.
class Requester {
 public:
  struct Sent {
    MemRequest request;
    std::uint64_t cycle = 0;     ///< in: not before; out: when it left
    std::uint64_t answered = 0;  ///< 0: not yet
    std::uint64_t latency() const { return answered - cycle; }
  };

  Requester(sim::Clock clock, sim::Link<MemRequest>& out, sim::Link<MemResponse>& in)
      : clock_(clock), out_(out), in_(in) {}

  void send(Addr line, std::uint64_t not_before = 0, bool write = false, SectorMask sectors = kWholeLine) {
    const auto tag = static_cast<std::uint16_t>(script.size());
    script.push_back({{line, source, tag, write, sectors}, not_before, 0});
  }

  sim::Time tick(sim::Time now) {
    const std::uint64_t cycle = clock_.cycles(now);
    if (cycle % pop_every == 0 && in_.can_pop(now)) {
      const MemResponse r = in_.pop(now);
      mistakes += r.line != script[r.tag].request.line || script[r.tag].answered != 0;
      script[r.tag].answered = cycle;
      answers += 1;
      outstanding_ -= 1;
    }
    if (may_send() && script[next_].cycle <= cycle && out_.can_push(now)) {
      script[next_].cycle = cycle;
      out_.push(now, script[next_].request);
      outstanding_ += !script[next_].request.write;
      answers += script[next_].request.write;
      next_ += 1;
    }
    const sim::Time later = now + clock_.period();
    sim::Time wake = sim::kNever;
    if (in_.pop_at() != sim::kNever) {
      const sim::Time turn = clock_.period() * pop_every;
      wake = (std::max(later, in_.pop_at()) + turn - 1) / turn * turn;
    }
    if (may_send() && out_.push_at() != sim::kNever)
      wake = std::min(wake, std::max({later, out_.push_at(), script[next_].cycle * clock_.period()}));
    return wake;
  }

  const sim::Clock& clock() const { return clock_; }
  bool done() const { return answers == script.size(); }

  std::vector<Sent> script;
  std::uint16_t source = 0;
  std::uint32_t most_outstanding = 1000;
  std::uint64_t pop_every = 1;
  std::size_t answers = 0;  ///< and writes sent
  int mistakes = 0;

 private:
  bool may_send() const { return next_ < script.size() && outstanding_ < most_outstanding; }

  sim::Clock clock_;
  sim::Link<MemRequest>& out_;
  sim::Link<MemResponse>& in_;
  std::size_t next_ = 0;
  std::uint32_t outstanding_ = 0;
};

/// A memory that answers each read as soon as its links allow.
class Echo {
 public:
  Echo(sim::Clock clock, sim::Link<MemRequest>& in, sim::Link<MemResponse>& out) : clock_(clock), in_(in), out_(out) {}
  sim::Time tick(sim::Time now) {
    if (in_.can_pop(now) && out_.can_push(now)) {
      const MemRequest r = in_.pop(now);
      if (!r.write) out_.push(now, {r.line, r.source, r.tag});
      if (r.write) written += 8 * static_cast<std::uint32_t>(std::popcount(r.sectors));
      requests += 1;
    }
    return sim::opens(now, clock_.period(), in_.pop_at(), out_.push_at());
  }
  const sim::Clock& clock() const { return clock_; }
  std::uint64_t requests = 0;
  std::uint64_t written = 0;  ///< bytes

 private:
  sim::Clock clock_;
  sim::Link<MemRequest>& in_;
  sim::Link<MemResponse>& out_;
};

enum class Mode { kSkip, kEveryEdge, kShuffled };

/// Any number of units of each kind and the links between them.
class Harness {
 public:
  std::list<Requester> requesters;
  std::list<CorePort> ports;
  std::list<L2Bank> banks;
  std::list<DramChannel> channels;
  std::list<Echo> echoes;

  template <class T>
  sim::Link<T>& link(std::size_t capacity, std::uint64_t latency, sim::Clock from, sim::Clock to) {
    auto& links = links_of<T>();
    const std::uint64_t synchroniser = from == to ? 0 : 1;
    return links.emplace_back(capacity, latency, from, to, synchroniser);
  }

  /// Tells the links who wakes whom: indices count units in the order of each_unit.
  template <class T>
  void connect(sim::Link<T>& link, std::size_t producer, std::size_t consumer) {
    hookups_.push_back([&link, producer, consumer, this] { link.wakes(wakes_.of(producer), wakes_.of(consumer)); });
  }

  void each_unit(auto&& f) {
    std::size_t i = 0;
    for (auto& u : requesters) f(u, i++);
    for (auto& u : ports) f(u, i++);
    for (auto& u : banks) f(u, i++);
    for (auto& u : channels) f(u, i++);
    for (auto& u : echoes) f(u, i++);
  }
  sim::Wakes& wakes() { return wakes_; }
  bool done() const {
    for (const Requester& r : requesters)
      if (!r.done()) return false;
    for (const L2Bank& b : banks)
      if (!b.idle()) return false;
    for (const DramChannel& c : channels)
      if (!c.idle()) return false;
    return std::ranges::all_of(request_links_, [](const auto& link) { return link.empty(); });
  }
  std::string state() const {
    std::string all;
    for (const auto& u : ports) all += u.state() + "\n";
    for (const auto& u : banks) all += u.state() + "\n";
    for (const auto& u : channels) all += u.state() + "\n";
    return all;
  }

  sim::Time run(Mode mode = Mode::kSkip) {
    std::size_t units = 0;
    each_unit([&](auto&, std::size_t) { units += 1; });
    wakes_.reset(units);
    for (const auto& hookup : hookups_) hookup();
    const sim::Time end = mode == Mode::kSkip        ? sim::run<sim::Skip::kOn>(*this)
                          : mode == Mode::kEveryEdge ? sim::run<sim::Skip::kOff>(*this)
                                                     : sim::run_shuffled(*this, 7);
    finish(end);
    return end;
  }

  std::vector<sim::UnitReport> reports() const {
    std::vector<sim::UnitReport> all;
    for (const auto& u : ports) all.push_back(sim::report_of(u, "port", "interconnect"));
    for (const auto& u : banks) all.push_back(sim::report_of(u, "l2", "l2"));
    for (const auto& u : channels) all.push_back(sim::report_of(u, "dram", "dram"));
    return all;
  }

  /// Everything that must not depend on the way the engine visits the units.
  std::string everything(sim::Time end) const {
    std::string all = "end " + std::to_string(end) + "\n";
    for (const sim::UnitReport& r : reports()) {
      all += r.path + " elapsed " + std::to_string(r.elapsed);
      for (const auto& [why, cycles] : r.why) all += " " + why + " " + std::to_string(cycles);
      for (const auto& c : r.counters) all += " " + c.name + " " + std::to_string(c.value);
      all += "\n";
    }
    for (const Requester& r : requesters)
      for (const auto& s : r.script) all += std::to_string(s.cycle) + "+" + std::to_string(s.latency()) + " ";
    return all;
  }

 private:
  /// The cycle of the last visited edge belongs to every unit, whether or not the unit was visited in it.
  void finish(sim::Time last) {
    const auto end = [&](auto& unit) { unit.finish(unit.clock().edge_at_or_after(last + 1)); };
    std::ranges::for_each(ports, end);
    std::ranges::for_each(banks, end);
    std::ranges::for_each(channels, end);
  }
  template <class T>
  auto& links_of() {
    if constexpr (std::is_same_v<T, MemRequest>) {
      return request_links_;
    } else {
      return response_links_;
    }
  }

  sim::Wakes wakes_;
  std::vector<std::function<void()>> hookups_;
  std::list<sim::Link<MemRequest>> request_links_;
  std::list<sim::Link<MemResponse>> response_links_;
};

}  // namespace hw::test
