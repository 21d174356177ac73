#include "tools/run/frame/front_end.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <numeric>
#include <utility>

#include "hw_models/machines/gpu.h"
#include "sim/host_clock.h"
#include "tools/host/process.h"
#include "tools/run/frame/replay_program.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {
namespace {

/// Calls f for each array of variable length in a tile's recorded work and result.
void for_each_array(auto& tile, auto&& f) {
  auto& work = tile.work;
  f(work.nodes), f(work.walk), f(work.ray_begin), f(work.ray_keys), f(work.accesses), f(work.access_begin),
      f(work.sources);
  f(work.raster), f(work.raster_triangles), f(work.list_runs);
  f(tile.background), f(tile.shown), f(tile.marks), f(tile.pixel_work);
}

}  // namespace

FrontEnd::FrontEnd(kernels::FrameProgram& program, const traces::Tracer& tracer, std::uint32_t workers, bool record,
                   std::vector<std::uint32_t> tile_indices, bool itemised)
    : program_(program),
      tracer_(tracer),
      record_(record),
      itemised_(itemised),
      tile_indices_(std::move(tile_indices)),
      max_ahead_(std::max<std::size_t>(1, 8 * std::size_t{workers})) {
  if (record && tracer.ray_predictor() != nullptr) predictions_.emplace(*tracer.ray_predictor());
  if (itemised) {
    result_.summaries.tiles.reserve(tile_count());
    result_.pixels.resize(program.picture().size() / 3);
  }
  threads_.reserve(workers);
  try {
    while (threads_.size() < workers) threads_.emplace_back([this] { run_ahead(); });
  } catch (const std::exception&) {
    // Those threads that could be started execute all tiles; without any, next() executes them.
  }
}

FrontEnd::~FrontEnd() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  room_.notify_all();
  for (std::thread& t : threads_) t.join();
}

std::unique_ptr<FrontEnd::Slot> FrontEnd::take_slot() {
  if (spare_.empty()) {
    slots_ += 1;
    for (auto* slots : {&ahead_, &handed_, &spare_}) slots->reserve(slots_);
    spare_.push_back(std::make_unique<Slot>());
  }
  std::unique_ptr<Slot> slot = std::move(spare_.back());
  spare_.pop_back();
  for_each_array(slot->tile, [length = longest_.begin()](auto& array) mutable { array.reserve(*length++); });
  if (predictions_) {
    slot->predictions.emplace(*tracer_.ray_predictor(), predictions_->table_of(next_tile_));
    slot->tile.predictions = &*slot->predictions;
  }
  return slot;
}

void FrontEnd::execute_tile(Slot& slot, std::uint32_t tile, kernels::TileBuffer& buffer) const {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  std::swap(slot.tile.buffer, buffer);
  slot.tile.wants_pixel_work = itemised_;
  program_.run_tile(tile, tracer_, record_, slot.tile);
  std::swap(slot.tile.buffer, buffer);
  slot.seconds = sim::seconds_since(begin);
}

void FrontEnd::run_ahead() {
  kernels::TileBuffer buffer;
  std::unique_lock lock(mutex_);
  for (;;) {
    room_.wait(lock, [&] { return stop_ || failure_ || next_tile_ == tile_count() || can_execute_ahead(); });
    if (stop_ || failure_ || next_tile_ == tile_count()) return;
    try {
      ahead_.push_back(take_slot());
    } catch (...) {
      failure_ = std::current_exception();
      room_.notify_all();
      news_.notify_one();
      return;
    }
    Slot& slot = *ahead_.back();
    slot.ready = false;
    const std::uint32_t tile = tile_index(next_tile_++);
    lock.unlock();
    try {
      execute_tile(slot, tile, buffer);
    } catch (...) {
      slot.failure = std::current_exception();
    }
    std::uint64_t bytes = 0;
    for_each_array(slot.tile, [&](const auto& array) { bytes += array.size() * sizeof(*array.data()); });
    lock.lock();
    slot.bytes = bytes;
    ahead_bytes_ += bytes;
    slot.ready = true;
    news_.notify_one();
  }
}

const traces::TileWork* FrontEnd::next() {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  const double cpu_begin = sim::thread_seconds();
  const traces::TileWork* work = take_tile();
  result_.next_cpu_seconds += sim::thread_seconds() - cpu_begin;
  result_.waited += sim::seconds_since(begin);
  return work;
}

const traces::TileWork* FrontEnd::take_tile() {
  std::unique_lock lock(mutex_);
  if (taken_ == tile_count()) return nullptr;
  if (taken_ == pass_end_) {
    program_.begin_pass(taken_, tracer_);
    pass_end_ = program_.pass_end(taken_);
    room_.notify_all();
  }
  if (threads_.empty()) {
    ahead_.push_back(take_slot());
    execute_tile(*ahead_.back(), tile_index(next_tile_++), buffer_);
  } else {
    // Failures are reported in tile order, whichever thread fails first.
    news_.wait(lock, [&] { return ahead_.empty() ? failure_ != nullptr : ahead_.front()->ready; });
    if (ahead_.empty()) std::rethrow_exception(failure_);
    if (ahead_.front()->failure) std::rethrow_exception(ahead_.front()->failure);
    ahead_bytes_ -= ahead_.front()->bytes;
  }
  handed_.push_back(std::move(ahead_.front()));
  ahead_.erase(ahead_.begin());
  room_.notify_one();
  taken_ += 1;
  commit_slot(*handed_.back());
  return &handed_.back()->tile.work;
}

void FrontEnd::release_work(const traces::TileWork* work) {
  const std::lock_guard lock(mutex_);
  const auto slot = std::ranges::find_if(handed_, [&](const auto& s) { return &s->tile.work == work; });
  spare_.push_back(std::move(*slot));
  handed_.erase(slot);
}

void FrontEnd::commit_slot(const Slot& slot) {
  for_each_array(slot.tile, [longest = longest_.begin()](const auto& array) mutable {
    *longest = std::max(*longest, array.size());
    ++longest;
  });
  program_.commit_tile(slot.tile);
  if (predictions_) {
    predictions_->commit_tile(slot.predictions->updates());
    room_.notify_all();
  }
  if (itemised_) add_tile_costs(slot.tile);
  if (taken_ == tile_count()) finish_picture();
  for (std::size_t k = 0; k < std::size(result_.rays); ++k) result_.rays[k] += slot.tile.rays[k];
  result_.continued += slot.tile.continued;
  result_.traversal_steps += slot.tile.traversal_steps;
  result_.seconds += slot.seconds;
}

void FrontEnd::add_tile_costs(const kernels::TileResult& tile) {
  result_.summaries.add(tile);
  for (const kernels::PixelWork& work : tile.pixel_work) {
    kernels::PixelWork& pixel = result_.pixels[work.pixel];
    pixel.rays += work.rays;
    pixel.steps += work.steps;
    pixel.tests += work.tests;
  }
}

void FrontEnd::finish_picture() {
  if (result_.rgb.empty()) result_.rgb = program_.move_picture_out();
  result_.sampling = program_.sampling();
  result_.marks = program_.sample_marks();
}

std::uint64_t RenderResult::all_rays() const {
  return std::accumulate(std::begin(rays), std::end(rays), std::uint64_t{0});
}

void RenderResult::add(const RenderResult& other) {
  for (std::size_t k = 0; k < std::size(rays); ++k) rays[k] += other.rays[k];
  sampling.add(other.sampling);
  continued += other.continued;
  traversal_steps += other.traversal_steps;
  seconds += other.seconds;
  waited += other.waited;
  next_cpu_seconds += other.next_cpu_seconds;
}

void RunTiles::begin_part(const char* phase, std::uint32_t frame) const {
  if (progress_ != nullptr) progress_->begin_part(phase, frame, tiles_ + (former_ != nullptr ? former_->tiles : 0));
}

const traces::TileWork* RunTiles::next() {
  if (is_interrupted()) {
    if (!keep_part_ || finished_ == 0) throw Interrupted{};
    front_end_.finish_picture();
    return nullptr;
  }
  const traces::TileWork* work = front_end_.next();
  if (trace_ != nullptr && work != nullptr) trace_->add_tile(*work);
  if (kept_ != nullptr && work != nullptr) kept_->add(*work);
  return work;
}

void RunTiles::release_work(const traces::TileWork* work) {
  front_end_.release_work(work);
  finished_ += 1;
  ProgressBase all = former_ != nullptr ? *former_ : ProgressBase{};
  all.tiles += finished_;
  all.rays += front_end_.result().all_rays();
  all.cycles += gpu_ != nullptr ? gpu_->cycles_so_far() : 0;
  if (former_ != nullptr && finished_ == tiles_) {
    *former_ = all;
  } else {
    all.report_to(progress_);
  }
}

}  // namespace tools
