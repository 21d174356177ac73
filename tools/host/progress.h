#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "sim/host_clock.h"

namespace tools {

/// A picture for a terminal: 8 bits per channel, row by row; empty if there is no picture yet.
struct SmallPicture {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  bool empty() const { return rgb.empty(); }
};

/// Source of live statistics and a picture of a running job. The thread that displays progress calls it.
class View {
 public:
  virtual ~View() = default;
  /// Returns live statistics of the running job, one line of text each.
  virtual std::vector<std::string> lines() = 0;
  /// Returns the picture rendered so far, scaled down to at most `width` x `height` pixels.
  virtual SmallPicture picture(std::size_t width, std::size_t height) = 0;
};

/// True if COLORTERM is `truecolor` or `24bit`: the terminal shows 24-bit colour.
bool has_true_colour();

/// Draws a picture in half blocks: two pixels per character, one above the other, in 24-bit colour.
std::string draw_half_blocks(const SmallPicture& picture);

/// State of a job's progress, as displayed to the user.
struct ProgressState {
  std::string phase = "loading";       ///< current activity: "loading", "building the tree", "simulating", ...
  std::string label;                   ///< label of the job's current part, if its parts have labels
  std::uint32_t frame = 0;             ///< number of the current frame
  std::uint32_t part = 0, parts = 1;   ///< finished and total parts; a part is one frame of one frame program
  std::uint32_t tile = 0, tiles = 0;   ///< finished and total tiles of the current part
  std::uint64_t rays = 0, cycles = 0;  ///< rays and T&I cycles of all parts so far
  std::uint32_t tile_before = 0;       ///< tiles finished before this process began; only in a job of one part
  bool ended = false;
  double seconds = 0;         ///< seconds since the start of the job
  double busy_seconds = 0;    ///< seconds since the start of the first part
  double traced_seconds = 0;  ///< seconds within parts that trace rays, without the time between parts

  double finished_share() const;  ///< finished share of the job, 0 to 1
  double rays_per_s() const;
  double seconds_left() const;  ///< estimated seconds until the end of the job; negative if unknown
};

/// Returns the progress as one line for a terminal with this many columns.
std::string progress_line(const ProgressState& state, std::size_t columns);
/// Returns the progress as one line of JSON.
std::string progress_json(const ProgressState& state);

/// Reports progress on stderr from a thread of its own. Working threads only update the state once per tile.
class Progress {
 public:
  /// `form`: how progress is displayed:
  /// - "auto": a line that is redrawn, if stderr is a terminal and the job takes more than two seconds; erased at the
  ///   end. `quiet` turns it off.
  /// - "json": lines of JSON, at most five per second, and a final one.
  /// - "none": nothing.
  /// - "watch": on a terminal `view`, redrawn twice per second and left there at the end; otherwise a line every two
  ///   seconds.
  /// `view` must outlive this object.
  Progress(const std::string& form, bool quiet, View* view = nullptr);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Displays an activity that traces no rays, such as loading, and ends the job's current part.
  void set_phase(const std::string& what);
  /// Sets the number of parts into which the job is divided for the progress display. A later call starts to count
  /// parts at zero.
  void expect_parts(std::uint32_t parts, const std::string& label = {});
  /// Begins a part of the job: one frame of one frame program. `before`: number of its tiles that were finished before
  /// this process began; must be 0 if the job has several parts.
  void begin_part(const std::string& what, std::uint32_t frame, std::uint32_t tiles, std::uint32_t before = 0);
  /// Sets the finished tiles, rays and cycles of the current part; the last tile ends the part.
  void set_tiles_done(std::uint32_t tiles, std::uint64_t rays, std::uint64_t cycles);
  /// Prints a line to stderr above the progress bar.
  void print_line(const std::string& line);
  /// True if print_hint() prints: progress is not quiet, and its form is neither "json" nor "none".
  bool shows_hints() const { return hints_; }
  void print_hint(const std::string& line) {
    if (hints_) print_line(line);
  }
  /// Ends the progress display with the state `how`: "done", "interrupted" or "failed". Nothing is printed afterwards.
  void finish(const std::string& how);

 private:
  enum class Form : std::uint8_t { kBar, kJson, kView, kLines, kNone };
  static Form form_of(const std::string& form, bool quiet);
  void restart_parts(std::uint32_t parts, const std::string& label);
  void run_display();
  void draw_progress();
  void show_view();
  void print_progress_line();
  void erase_bar();
  ProgressState current_state() const;
  double traced_seconds() const;
  void stop_clock();

  const Form form_;
  const bool hints_;
  View* const view_;
  bool shows_picture_ = false;
  std::size_t view_lines_ = 0;  ///< number of terminal lines of the view
  const sim::HostClock::time_point begin_ = sim::HostClock::now();
  /// Start times of the job's first part (zero before it) and of the current part (zero between parts).
  sim::HostClock::time_point busy_since_, part_since_;
  std::mutex mutex_;
  std::condition_variable news_;
  ProgressState state_;
  std::uint64_t rays_before_ = 0, cycles_before_ = 0;  ///< rays and cycles of finished parts
  bool bar_is_there_ = false, ended_ = false;
  std::thread thread_;
};

}  // namespace tools
