#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/l2_bank.h"
#include "sim/engine.h"
#include "sim/hash.h"
#include "sim/machine.h"
#include "sim/unit_report.h"

namespace hw::test {

inline const sim::Clock kClock(2'000'000);

/// Test client that sends a list of memory requests, each after the previous one and at its cycle or later. Records
/// when each is answered.
class Requester {
 public:
  struct Sent {
    MemRequest request;
    std::uint64_t cycle = 0;     ///< before the run the earliest cycle; afterwards the cycle of sending
    std::uint64_t answered = 0;  ///< cycle of the answer; 0: none yet
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
  std::size_t answers = 0;  ///< number of answers received and of writes sent
  int mistakes = 0;

 private:
  bool may_send() const { return next_ < script.size() && outstanding_ < most_outstanding; }

  sim::Clock clock_;
  sim::Link<MemRequest>& out_;
  sim::Link<MemResponse>& in_;
  std::size_t next_ = 0;
  std::uint32_t outstanding_ = 0;
};

/// Test memory that answers each read at once.
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
    return sim::next_transfer_time(now, clock_.period(), in_.pop_at(), out_.push_at());
  }
  const sim::Clock& clock() const { return clock_; }
  std::uint64_t requests = 0;
  std::uint64_t written = 0;  ///< total size of all writes in bytes

 private:
  sim::Clock clock_;
  sim::Link<MemRequest>& in_;
  sim::Link<MemResponse>& out_;
};

enum class Mode { kSkip, kEveryEdge, kShuffled };

/// Test harness for the memory system: any number of units of each kind, and the links between them.
class Harness {
 public:
  std::vector<Requester*> requesters;
  std::vector<CorePort*> ports;
  std::vector<L2Bank*> banks;
  std::vector<DramChannel*> channels;
  std::vector<Echo*> echoes;

  explicit Harness(std::uint64_t synchroniser = 1) : machine_(synchroniser) {}

  sim::UnitId unit(std::string name, sim::Clock clock = kClock) { return machine_.unit({std::move(name), clock}); }
  template <class T>
  sim::Link<T>& link(std::size_t capacity, std::uint64_t latency, sim::UnitId from, sim::UnitId to) {
    return machine_.link<T>(capacity, latency, from, to);
  }
  Requester& add_requester(sim::UnitId id, sim::Link<MemRequest>& out, sim::Link<MemResponse>& in,
                           std::uint16_t source = 0) {
    requesters.push_back(&machine_.build<Requester>(id, id.clock, out, in));
    requesters.back()->source = source;
    return *requesters.back();
  }
  void add_port(sim::UnitId id, auto&&... args) { ports.push_back(&machine_.build<CorePort>(id, args...)); }
  void add_bank(sim::UnitId id, auto&&... args) { banks.push_back(&machine_.build<L2Bank>(id, args...)); }
  void add_channel(sim::UnitId id, auto&&... args) { channels.push_back(&machine_.build<DramChannel>(id, args...)); }
  void add_echo(sim::UnitId id, sim::Link<MemRequest>& in, sim::Link<MemResponse>& out) {
    echoes.push_back(&machine_.build<Echo>(id, id.clock, in, out));
  }

  // Called by the engine.
  sim::Machine& machine() { return machine_; }
  bool done() const {
    return std::ranges::all_of(requesters, [](const Requester* r) { return r->done(); }) && machine_.is_drained();
  }

  sim::Time run(Mode mode = Mode::kSkip) {
    const sim::Time end = mode == Mode::kSkip        ? sim::run<sim::Skip::kOn>(*this)
                          : mode == Mode::kEveryEdge ? sim::run<sim::Skip::kOff>(*this)
                                                     : sim::run_shuffled(*this, 7);
    machine_.finish(end + 1);
    return end;
  }

  std::vector<sim::UnitReport> reports() const { return machine_.report(); }

  /// Returns all results of a run as text. Runs in different engine modes must return equal texts.
  std::string everything(sim::Time end) const {
    std::string all = "end " + std::to_string(end) + "\n";
    for (const sim::UnitReport& r : reports()) {
      all += r.path + " elapsed " + std::to_string(r.elapsed);
      for (const auto& [why, cycles] : r.cycles_by_reason) all += " " + why + " " + std::to_string(cycles);
      for (const auto& c : r.counters) all += " " + c.name + " " + std::to_string(c.value);
      all += "\n";
    }
    for (const Requester* r : requesters)
      for (const auto& s : r->script) all += std::to_string(s.cycle) + "+" + std::to_string(s.latency()) + " ";
    return all;
  }

 private:
  sim::Machine machine_;
};

}  // namespace hw::test
