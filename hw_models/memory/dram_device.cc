#include "hw_models/memory/dram_device.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace hw {

using enum DramCommand;

DramDevice::DramDevice(const DramConfig& c)
    : t_(c.timing),
      group_mask_(c.organisation.bank_groups - 1),
      train_length_(Cycle{c.bursts_per_line() - 1} * c.timing.ccd_l),
      calendar_(c.timing, c.bursts_per_line()) {
  assert(c.organisation.banks <= kMaxBanks && c.organisation.bank_groups <= kMaxGroups);
}

DramDevice::Floors DramDevice::floors(bool write, Cycle now) const {
  return {std::max(now, write ? write_at_ : read_at_), std::max({now, activate_at_, four_activates_[oldest_activate_]}),
          now};
}

DramWhy DramDevice::reason(DramCommand command, std::uint32_t bank, bool write, Cycle at) const {
  const bool by_bank = at == this->at(command, bank);
  switch (command) {
    case kColumn:
      if (by_bank) return DramWhy::kActivate;
      if (at == (write ? write_at_ : read_at_)) return DramWhy::kTurnaround;
      if (at == group_at_[write ? kWriteTrain : kReadTrain][group_of(bank)])
        return last_was_write_ && !write ? DramWhy::kTurnaround : DramWhy::kColumn;
      return calendar_.data_free(at - 1) ? DramWhy::kCommandBus : DramWhy::kColumn;
    case kActivate:
      if (by_bank) return closed_why_[bank];
      return at == std::max(activate_at_, four_activates_[oldest_activate_]) ? DramWhy::kActivate
                                                                             : DramWhy::kCommandBus;
    case kPrecharge:
      return by_bank ? DramWhy::kRowConflict : DramWhy::kCommandBus;
  }
  return DramWhy::kIdle;
}

void DramDevice::activate(std::uint32_t bank, std::uint32_t row, Cycle now) {
  if (open_ == 0 && now > active_until_) {
    active_ += active_until_ - active_since_;
    active_since_ = now;
  }
  open_ |= 1U << bank;
  rows_[bank] = row;
  at(kColumn, bank) = now + t_.rcd;
  at(kPrecharge, bank) = now + t_.ras;
  at(kActivate, bank) = now + t_.rc;
  activate_at_ = now + t_.rrd;
  four_activates_[oldest_activate_] = now + t_.faw;
  oldest_activate_ = (oldest_activate_ + 1) % 4;
  calendar_.book(kActivate, now);
}

void DramDevice::precharge(std::uint32_t bank, Cycle now) {
  calendar_.book(kPrecharge, now);
  close(bank, now);
}

void DramDevice::close(std::uint32_t bank, Cycle now) {
  open_ &= ~(1U << bank);
  at(kActivate, bank) = std::max(at(kActivate, bank), now + t_.rp);
  closed_why_[bank] = DramWhy::kRowConflict;
  active_until_ = std::max(active_until_, now);
}

DramDevice::Cycle DramDevice::read(std::uint32_t bank, Cycle now) {
  const Cycle last = now + train_length_;
  const std::uint32_t group = group_of(bank);
  at(kPrecharge, bank) = std::max(at(kPrecharge, bank), last + t_.rtp);
  group_at_[kReadTrain][group] = group_at_[kWriteTrain][group] = last + t_.ccd_l;
  write_at_ = last + t_.rl + t_.dqsck + t_.burst + t_.rtw - t_.wl;
  book_train(false, now);
  return now + t_.rl + t_.dqsck;
}

DramDevice::Cycle DramDevice::write(std::uint32_t bank, Cycle now) {
  const Cycle last = now + train_length_;
  const Cycle last_data = last + t_.wl + t_.dqss;
  const std::uint32_t group = group_of(bank);
  at(kPrecharge, bank) = std::max(at(kPrecharge, bank), last_data + t_.burst + t_.wr);
  group_at_[kReadTrain][group] = last_data + t_.ccd_l + t_.wtr_l;
  group_at_[kWriteTrain][group] = last + t_.ccd_l;
  read_at_ = last_data + t_.burst + t_.wtr_s;
  book_train(true, now);
  return now + t_.wl + t_.dqss;
}

void DramDevice::book_train(bool write, Cycle now) {
  calendar_.book(kColumn, now);
  turnarounds_ += write != last_was_write_;
  last_was_write_ = write;
}

void DramDevice::refresh(std::uint32_t bank, Cycle due) {
  if (is_open(bank)) close(bank, std::max(due, at(kPrecharge, bank)));
  at(kActivate, bank) = std::max(due, at(kActivate, bank)) + t_.rfc_pb;
  closed_why_[bank] = DramWhy::kRefresh;
}

std::uint32_t DramDevice::open_banks() const { return static_cast<std::uint32_t>(std::popcount(open_)); }

DramDevice::Cycle DramDevice::active_cycles(Cycle until) {
  // A refresh may have set the end of the last open row some cycles ahead.
  const Cycle end = open_ != 0 ? until : std::min(until, active_until_);
  if (end > active_since_) {
    active_ += end - active_since_;
    active_since_ = end;
  }
  return active_;
}

}  // namespace hw
