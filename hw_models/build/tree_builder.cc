#include "hw_models/build/tree_builder.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

namespace hw {

namespace {

constexpr std::size_t kOutputs = 3;
constexpr std::uint64_t kMostLag = kLineBytes;  // bytes of finished items that may wait to be passed to the write queue

}  // namespace

TreeBuilder::TreeBuilder(const TreeBuilderConfig& config, const BuildMemory& memory, Links links, std::uint16_t client,
                         sim::Clock clock, bool ideal_buffer)
    : config_(config),
      memory_(memory),
      clock_(clock),
      links_(links),
      fetch_(config, client, ideal_buffer),
      outputs_(kOutputs, Output(config.write_buffer, client)) {}

std::uint32_t TreeBuilder::intermediate_merges(const TreeBuilderConfig& config, std::uint32_t items) {
  std::uint32_t merges = 0;
  for (std::uint32_t runs = (items + config.run - 1) / config.run; runs > config.ways; ++merges) {
    runs = (runs + config.ways - 1) / config.ways;
  }
  return merges;
}

sim::Time TreeBuilder::tick(sim::Time now) {
  if (links_.memory_in.can_pop(now)) {
    fetch_.fill_line(links_.memory_in.pop(now).line);
    stats_.buffer_fills += 1;
  }
  bool moved = end_item(now);
  moved |= queue_outputs();
  moved |= end_pass(now);
  moved |= begin_item(now);
  const bool looked = fetch_.look_up_lines([&](bool hit) { (hit ? stats_.buffer_hits : stats_.buffer_misses) += 1; });
  moved |= looked;
  moved |= add_item();
  moved |= take_job(now);
  const bool sent = send_line(now);
  moved |= sent;
  activity_.spend(now, clock_.period(), cycle_reason(now, looked, sent),
                  cycle_reason(clock_.edge_after(now, 1), false, false));
  return next_wake(now, moved);
}

bool TreeBuilder::take_job(sim::Time now) {
  if (state_ != State::kIdle || !links_.jobs_in.can_pop(now)) return false;
  job_ = links_.jobs_in.pop(now);
  state_ = State::kPass;
  items_ = node().items;
  runs_ = (items_ + config_.run - 1) / config_.run;
  records_in_memory_ = runs_ > 1;
  source_ = 1;  // the sort pass writes the other array
  begin_pass(work().refit ? BuildPass::kRefit : BuildPass::kSort, now);
  return true;
}

/// Starts a pass over all items of the tree. For passes that read records, `runs_` is their number of runs.
void TreeBuilder::begin_pass(BuildPass pass, sim::Time now) {
  pass_ = pass;
  begun_at_ = now;
  entered_ = processed_ = 0;
  fetch_.clear_buffer();
  for (Output& output : outputs_) output.begin(0, 0);
  const Addr records = memory_.records[1 - source_];
  const std::uint64_t record_bytes = std::uint64_t{items_} * config_.record_bytes;
  switch (pass) {
    case BuildPass::kSort:
      interval_ = (config_.clocks + 1) / 2;
      if (records_in_memory_) outputs_[0].begin(records, record_bytes);
      break;
    case BuildPass::kMerge:
      interval_ = config_.merge_interval;
      outputs_[0].begin(records, record_bytes);
      break;
    case BuildPass::kHierarchy:
    case BuildPass::kRefit:
      interval_ = std::max(config_.clocks / 2, pass == BuildPass::kHierarchy ? comparison_cycles() : 0);
      for (std::size_t i = 0; i < kOutputs; ++i) {
        outputs_[i].begin(memory_.tree + work().output[i].offset, work().output[i].bytes);
      }
      break;
    case BuildPass::kInvalidate:
      break;
  }
}

/// Returns the cycles that comparing clusters takes per item.
std::uint32_t TreeBuilder::comparison_cycles() const {
  const std::uint64_t per_cycle = std::uint64_t{items_} * std::max(1U, config_.comparators);
  return static_cast<std::uint32_t>((work().comparisons + per_cycle - 1) / per_cycle);
}

TreeBuilder::RunRecord TreeBuilder::record_of(std::uint32_t item) const {
  // Runs have equal lengths, except that the first ones may have one record more. Groups of `ways` runs are merged.
  const std::uint64_t length = items_ / runs_, longer = items_ % runs_;
  const auto begin = [&](std::uint64_t run) { return run * length + std::min(run, longer); };
  const std::uint64_t with_one_more = longer * (length + 1);
  const std::uint64_t run = item < with_one_more ? item / (length + 1) : longer + (item - with_one_more) / length;
  const std::uint64_t group = run / config_.ways * config_.ways;
  const std::uint64_t in_group = std::min<std::uint64_t>(config_.ways, runs_ - group), at = item - begin(group);
  if (at < in_group * length) return {begin(group + at % in_group) + at / in_group, at < in_group};
  return {begin(group + at - in_group * length) + length, length == 0};
}

void TreeBuilder::add_record_lines(std::uint32_t item, BuildLines& lines) const {
  const RunRecord record = record_of(item);
  const Addr first = memory_.records[source_] + record.index * config_.record_bytes;
  // A line holds several records of its run and is read once, with the first of them.
  const Addr end = first + config_.record_bytes, unread = record.is_first ? first : round_up_to_lines(first);
  if (unread < end) lines.stage[0].add_bytes(unread, end - unread);
}

/// Adds the lines of a triangle or instance, given its number in input order.
void TreeBuilder::add_input_lines(std::uint32_t input, BuildLines& lines) const {
  const Addr number = Addr{work().first_item} + input;
  if (!has_triangles()) {
    lines.stage[1].add_bytes(memory_.instances + number * BuildMemory::kInstanceBytes, BuildMemory::kInstanceBytes);
    return;
  }
  lines.stage[0].add_bytes(memory_.indices + number * BuildMemory::kIndexBytes, BuildMemory::kIndexBytes);
  for (const std::uint32_t vertex : job_.work->build_triangles[work().first + input]) {
    lines.stage[1].add_bytes(memory_.positions + Addr{vertex} * BuildMemory::kPositionBytes,
                             BuildMemory::kPositionBytes);
  }
}

BuildLines TreeBuilder::lines_of(std::uint32_t item) const {
  BuildLines lines;
  if (pass_ == BuildPass::kSort) {
    add_input_lines(item, lines);
    return lines;
  }
  if (records_in_memory_ && pass_ != BuildPass::kRefit) add_record_lines(item, lines);
  if (pass_ == BuildPass::kMerge) return lines;
  add_input_lines(has_triangles() ? job_.work->build_order[work().first + item] : item, lines);
  if (pass_ == BuildPass::kRefit) {
    const Output& nodes = outputs_[0];
    const std::uint64_t first = nodes.bytes * item / items_, end = nodes.bytes * (std::uint64_t{item} + 1) / items_;
    lines.stage[1].add_bytes(nodes.base + first, end - first);
  }
  return lines;
}

bool TreeBuilder::add_item() {
  if (state_ != State::kPass || entered_ == items_ || !fetch_.has_room()) return false;
  fetch_.add_item(lines_of(entered_++), job_.tile);
  return true;
}

bool TreeBuilder::outputs_lag() const {
  return std::ranges::any_of(outputs_, [](const Output& o) { return o.target - o.cursor > kMostLag; });
}

bool TreeBuilder::begin_item(sim::Time now) {
  if (state_ != State::kPass || busy_ || outputs_lag() || !fetch_.is_ready()) return false;
  fetch_.remove_oldest();
  busy_ = true;
  busy_until_ = clock_.edge_after(now, interval_);
  count_item();
  return true;
}

/// Counts the events of one item of the current pass.
void TreeBuilder::count_item() {
  const std::uint64_t input =
      has_triangles() ? BuildMemory::kIndexBytes + 3 * BuildMemory::kPositionBytes : BuildMemory::kInstanceBytes;
  if (pass_ != BuildPass::kMerge) {
    stats_.boxes += 1;
    stats_.input_bytes += input;
  }
  if (pass_ == BuildPass::kSort) count_sorted_record();
  if (records_in_memory_ && (pass_ == BuildPass::kMerge || pass_ == BuildPass::kHierarchy)) count_merged_record();
  if (pass_ == BuildPass::kHierarchy || pass_ == BuildPass::kRefit) stats_.leaves_written += 1;
}

void TreeBuilder::count_sorted_record() {
  const std::uint32_t length = items_ / runs_, longer = items_ % runs_;  // as in record_of()
  const bool in_longer = processed_ < std::uint64_t{longer} * (length + 1);
  const auto levels = static_cast<std::uint32_t>(std::bit_width(length - (in_longer ? 0 : 1)));
  stats_.records_sorted += 1;
  stats_.sort_words += std::uint64_t{levels} * config_.record_words();
}

void TreeBuilder::count_merged_record() {
  stats_.records_merged += 1;
  stats_.record_bytes_read += config_.record_bytes;
  stats_.head_words += config_.record_words();
  stats_.merge_words += std::uint64_t{config_.merge_levels()} * config_.record_words();
}

bool TreeBuilder::end_item(sim::Time now) {
  if (state_ != State::kPass || !busy_ || now < busy_until_) return false;
  busy_ = false;
  processed_ += 1;
  for (Output& output : outputs_) output.target = output.bytes * processed_ / items_;
  return true;
}

/// Passes bytes of finished items to the write queues, up to one line of each output per cycle.
bool TreeBuilder::queue_outputs() {
  bool moved = false;
  for (Output& output : outputs_) {
    if (output.cursor == output.target || !output.lines.has_room(1)) continue;
    const Addr first = output.base + output.cursor;
    const std::uint64_t in_line = line_of(first) + kLineBytes - first;
    const std::uint64_t bytes = std::min(in_line, output.target - output.cursor);
    output.lines.add_bytes(first, static_cast<std::uint32_t>(bytes), job_.tile);
    output.cursor += bytes;
    if (output.cursor == output.bytes) output.lines.close_line();
    const bool is_tree = pass_ == BuildPass::kHierarchy || pass_ == BuildPass::kRefit;
    (is_tree ? stats_.tree_bytes_written : stats_.record_bytes_written) += bytes;
    if (pass_ == BuildPass::kRefit && &output == outputs_.data()) stats_.node_bytes_read += bytes;
    moved = true;
  }
  return moved;
}

bool TreeBuilder::outputs_are_sent() const {
  return std::ranges::all_of(outputs_, [](const Output& o) { return o.cursor == o.bytes && o.lines.empty(); });
}

/// Ends the current pass, the invalidation or the job, and begins the next.
bool TreeBuilder::end_pass(sim::Time now) {
  if (state_ == State::kPass) {
    if (processed_ < items_ || !outputs_are_sent()) return false;
    notify_pass_end(now, pass_);
    if (pass_ == BuildPass::kSort || pass_ == BuildPass::kMerge) {
      if (pass_ == BuildPass::kMerge) runs_ = (runs_ + config_.ways - 1) / config_.ways;
      source_ = 1 - source_;
      begin_pass(runs_ > config_.ways ? BuildPass::kMerge : BuildPass::kHierarchy, now);
      return true;
    }
    (pass_ == BuildPass::kRefit ? stats_.trees_refitted : stats_.trees_built) += 1;
    (has_triangles() ? stats_.triangles : stats_.instances) += items_;
    stats_.comparisons += work().comparisons;
    stats_.caches_invalidated += 1;
    state_ = State::kInvalidating;
    begun_at_ = now;
    busy_until_ = clock_.edge_after(now, config_.invalidate);
    return true;
  }
  if (state_ == State::kInvalidating && now >= busy_until_) {
    notify_pass_end(now, BuildPass::kInvalidate);
    state_ = State::kLeaving;
  }
  if (state_ != State::kLeaving || !links_.done_out.can_push(now)) return false;
  links_.done_out.push(now, TileDone{job_.work, traces::WorkNode::kNone, job_.tile});
  state_ = State::kIdle;
  return true;
}

void TreeBuilder::notify_pass_end(sim::Time now, BuildPass pass) const {
  if (links_.observer == nullptr) return;
  const bool has_runs = pass != BuildPass::kRefit && pass != BuildPass::kInvalidate;
  notify(*links_.observer, BuildPassEnded{pass, job_.tile, items_, has_runs ? runs_ : 0, begun_at_, now});
}

bool TreeBuilder::send_line(sim::Time now) {
  if (fetch_.next_send_time(now, links_.memory_out) <= now) {
    fetch_.send_request(now, links_.memory_out);
    return true;
  }
  for (Output& output : outputs_) {
    if (!output.lines.send_line(now, links_.memory_out)) continue;
    stats_.writes += 1;
    return true;
  }
  return false;
}

TreeBuilder::CycleReason TreeBuilder::cycle_reason(sim::Time at, bool looked, bool sent) const {
  switch (state_) {
    case State::kIdle:
      return CycleReason::kIdle;
    case State::kInvalidating:
      return CycleReason::kInvalidating;
    case State::kLeaving:
      return CycleReason::kPortFull;
    case State::kPass:
      break;
  }
  constexpr std::array kOfPass{CycleReason::kSorting, CycleReason::kMerging, CycleReason::kEmitting,
                               CycleReason::kRefitting};
  const bool is_writing = processed_ == items_ || outputs_lag();
  if ((busy_ && at < busy_until_) || (is_writing && sent)) return kOfPass[static_cast<std::size_t>(pass_)];
  if (is_writing) return CycleReason::kPortFull;
  return looked ? CycleReason::kFetching : CycleReason::kMemory;
}

sim::Time TreeBuilder::next_wake(sim::Time now, bool moved) const {
  const sim::Time next = clock_.edge_after(now, 1);
  if (moved) return next;
  sim::Time at = std::max(next, links_.memory_in.pop_at());
  if (state_ == State::kIdle) at = std::min(at, std::max(next, links_.jobs_in.pop_at()));
  if (busy_ || state_ == State::kInvalidating) at = std::min(at, std::max(next, busy_until_));
  if (state_ == State::kLeaving) at = std::min(at, std::max(next, links_.done_out.push_at()));
  at = std::min(at, fetch_.next_send_time(next, links_.memory_out));
  for (const Output& output : outputs_) {
    if (output.lines.has_closed_line()) at = std::min(at, std::max(next, links_.memory_out.push_at()));
  }
  return at;
}

std::string TreeBuilder::state() const {
  if (state_ == State::kIdle) return "idle";
  return fmt::format("{}: item {} of {}, items in the window {}, lines on their way {}",
                     names_of(pass_)[static_cast<std::size_t>(pass_)], processed_, items_, fetch_.items_in_window(),
                     fetch_.outstanding_lines());
}

}  // namespace hw
