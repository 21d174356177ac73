#include <algorithm>

#include "hw_models/memory/dram_channel.h"

namespace hw {

void DramChannel::activate(DramQueue::Entry& entry, Cycle now) {
  const auto [index, row] = entry.place;
  Bank& bank = banks_[index];
  bank.open = true;
  bank.row = row;
  bank.column_at = now + t_.rcd;
  bank.precharge_at = now + t_.ras;
  bank.activate_at = now + t_.rc;
  activate_at_ = now + t_.rrd;
  four_activates_[oldest_activate_] = now + t_.faw;
  oldest_activate_ = (oldest_activate_ + 1) % 4;
  command_bus_.book(now, activate_slots_);
  reads_.row_opened(index, row);
  writes_.row_opened(index, row);
  entry.activated = true;
  stats_.activates += 1;
  if (open_banks_ == 0 && now > active_until_) {
    stats_.active_standby += active_until_ - active_since_;
    active_since_ = now;
  }
  open_banks_ += 1;
}

void DramChannel::close(std::uint32_t index, Cycle at) {
  Bank& bank = banks_[index];
  bank.open = false;
  bank.activate_at = std::max(bank.activate_at, at + t_.rp);
  bank.closed_why = Why::kRowConflict;
  reads_.row_closed(index);
  writes_.row_closed(index);
  active_until_ = std::max(active_until_, at);
  open_banks_ -= 1;
}

void DramChannel::read(const DramQueue::Entry& entry, Cycle now) {
  const Cycle last = now + train_length_;
  const Cycle data = now + t_.rl + t_.dqsck;
  const Cycle data_end = last + t_.rl + t_.dqsck + t_.burst;
  Bank& bank = banks_[entry.place.bank];
  bank.precharge_at = std::max(bank.precharge_at, last + t_.rtp);
  group_column_at_[group_of(entry.place.bank)] = last + t_.ccd_l;
  write_at_ = data_end + t_.rtw - t_.wl;
  book_train(now, data, false);
  returns_.slots[(returns_.head + returns_.size) % returns_.slots.size()] = {
      {entry.request.line, entry.request.source, entry.request.tag}, entry.port, data_end + fabric_};
  returns_.size += 1;
  stats_.reads += 1;
  stats_.read_bursts += bursts_;
  stats_.read_latency += data_end - entry.arrived;
  stats_.read_latency_max = std::max(stats_.read_latency_max, data_end - entry.arrived);
  count_line(entry);
}

void DramChannel::write(const DramQueue::Entry& entry, Cycle now) {
  const Cycle last = now + train_length_;
  const Cycle data = now + t_.wl + t_.dqss;
  const Cycle last_data = last + t_.wl + t_.dqss;
  const std::uint32_t group = group_of(entry.place.bank);
  Bank& bank = banks_[entry.place.bank];
  bank.precharge_at = std::max(bank.precharge_at, last_data + t_.burst + t_.wr);
  group_column_at_[group] = last + t_.ccd_l;
  group_read_at_[group] = last_data + t_.ccd_l + t_.wtr_l;
  read_at_ = last_data + t_.burst + t_.wtr_s;
  book_train(now, data, true);
  stats_.writes += 1;
  stats_.write_bursts += bursts_;
  count_line(entry);
}

/// Books the column commands of a line and their bursts, the first of which begins at `data`.
void DramChannel::book_train(Cycle now, Cycle data, bool write) {
  command_bus_.book(now, column_train_);
  column_slots_.book(now, data_train_);
  if (t_.ccd_l == t_.burst) {
    data_bus_.book({data, data + Cycle{bursts_} * t_.burst, write});
  } else {
    for (std::uint32_t i = 0; i < bursts_; ++i, data += t_.ccd_l) data_bus_.book({data, data + t_.burst, write});
  }
  stats_.turnarounds += write != last_was_write_;
  last_was_write_ = write;
}

void DramChannel::count_line(const DramQueue::Entry& entry) {
  stats_.bytes += line_bytes_;
  if (entry.precharged) {
    stats_.row_conflicts += 1;
  } else if (entry.activated) {
    stats_.row_misses += 1;
  } else {
    stats_.row_hits += 1;
  }
}

/// Runs every refresh due by now, each at its own time: the outcome is the same whenever this is called.
void DramChannel::refresh(Cycle now) {
  while (refresh_at_ <= now) {
    Bank& bank = banks_[refresh_bank_];
    if (bank.open) close(refresh_bank_, std::max(refresh_at_, bank.precharge_at));
    bank.activate_at = std::max(refresh_at_, bank.activate_at) + t_.rfc_pb;
    bank.closed_why = Why::kRefresh;
    stats_.refreshes += 1;
    refresh_at_ += t_.refi_pb;
    refresh_bank_ = refresh_bank_ + 1 == banks_in_use_ ? 0 : refresh_bank_ + 1;
    plan_is_stale_ = true;
  }
}

/// Charges the cycles before `until`: to the data bus while it moves data, else to what the next command waits for.
void DramChannel::settle(Cycle until) {
  while (settled_ < until) {
    Cycle end = until;
    Why why = waiting_;
    if (!data_bus_.empty()) {
      const DataBus::Burst burst = data_bus_.front();
      if (burst.begin > settled_) {
        end = std::min(until, burst.begin);
        if (why == Why::kIdle) why = Why::kLatency;
      } else {
        end = std::min(until, burst.end);
        why = burst.write ? Why::kWriting : Why::kReading;
        if (end == burst.end) data_bus_.pop();
      }
    }
    activity_.spend(settled_ * clock_.period(), clock_.period(), why, why);
    settled_ = end;
  }
}

void DramChannel::count_standby(Cycle until) {
  const Cycle end = open_banks_ > 0 ? until : std::min(until, active_until_);
  if (end > active_since_) {
    stats_.active_standby += end - active_since_;
    active_since_ = end;
  }
  stats_.precharge_standby = until - stats_.active_standby;
}

}  // namespace hw
