#pragma once
#include <array>
#include <cstdint>

#include "traces/tracer.h"

namespace traces {

/// Collects walk words in a small buffer, so that a step costs one store, and appends them to a sink.
class Recorder {
 public:
  explicit Recorder(WalkSink& sink) : sink_(sink) {}
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void begin_ray() { sink_.begin.push_back(static_cast<std::uint32_t>(sink_.words.size() + used_)); }
  /// Call before each step, which writes at most kStepWords words.
  void make_room() {
    if (used_ + kStepWords > buffer_.size()) flush();
  }
  void write(std::uint32_t word) { buffer_[used_++] = word; }
  /// Call after the last ray. Not a destructor, because running out of memory must throw.
  void finish() { flush(); }

  static constexpr std::size_t kStepWords = 4;

 private:
  void flush() {
    sink_.words.insert(sink_.words.end(), buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ = 0;
  }

  WalkSink& sink_;
  std::size_t used_ = 0;
  std::array<std::uint32_t, 4096> buffer_;
};

/// Recorder that drops the walks.
struct NoRecorder {
  void begin_ray() {}
  void make_room() {}
  void write(std::uint32_t) {}
  void finish() {}
};

}  // namespace traces
