#pragma once
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "sim/host_clock.h"
#include "tools/host/view.h"

namespace tools {

/// How far a job is.
struct ProgressState {
  std::string phase = "loading";       ///< what is being done: "loading", "building the tree", "simulating", ...
  std::string label;                   ///< name of the part under way, if parts have names
  std::uint32_t frame = 0;             ///< its number
  std::uint32_t part = 0, parts = 1;   ///< parts are runs of a frame program over one frame; those finished, and all
  std::uint32_t tile = 0, tiles = 0;   ///< tiles of the part under way: finished, and all
  std::uint64_t rays = 0, cycles = 0;  ///< sums over all parts so far; cycles of the T&I clock
  std::uint32_t tile_before = 0;       ///< tiles that were finished when the only part began
  bool ended = false;
  double seconds = 0;         ///< since the job began
  double busy_seconds = 0;    ///< since the first part began
  double traced_seconds = 0;  ///< those of parts that count rays, without what is done between

  double share() const;  ///< done, 0 to 1
  double rays_per_s() const;
  double seconds_left() const;  ///< negative: nothing can be said yet
};

/// One line for a terminal of that many columns.
std::string progress_line(const ProgressState& state, std::size_t columns);
/// One line of JSON.
std::string progress_json(const ProgressState& state);

/// Tells on stderr how far a job is. A thread of its own does the telling and looks at the clock; whoever works only
/// notes down what is done, tile by tile.
class Progress {
 public:
  /// "auto": a line that is redrawn, if stderr is a terminal and the job takes more than two seconds; erased in the
  /// end. "json": lines of JSON, at most five a second, and a last one. "none": nothing. `quiet` makes auto none.
  /// "watch": on a terminal the view with all that it has, twice a second, which stays there in the end; elsewhere a
  /// line every two seconds. `view` outlives this.
  Progress(const std::string& form, bool quiet, View* view = nullptr);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// A word for what is done now, which makes no rays: no part under way counts any behind it.
  void phase(const std::string& what);
  /// From now on so many parts, counted anew; and anew when they are over and another begins.
  void expect(std::uint32_t parts, const std::string& label = {});
  /// `before`: tiles of it that others have done, for the only part.
  void begin_part(const std::string& what, std::uint32_t frame, std::uint32_t tiles, std::uint32_t before = 0);
  /// So much of the part under way is done; with all its tiles the part is over.
  void tiles_done(std::uint32_t tiles, std::uint64_t rays, std::uint64_t cycles);
  /// Writes a line on stderr without disturbing the bar.
  void say(const std::string& line);
  /// The same for people, who want neither JSON nor silence.
  bool shows_hints() const { return hints_; }
  void hint(const std::string& line) {
    if (hints_) say(line);
  }
  /// The last line: how it ended, "done", "interrupted" or "failed". Tells nothing more after that.
  void end(const std::string& how);

 private:
  enum class Form : std::uint8_t { kBar, kJson, kView, kLines, kNone };
  static Form form_of(const std::string& form, bool quiet);
  void restart(std::uint32_t parts, const std::string& label);
  void run();
  void show();
  void show_view();
  void show_line();
  void erase();
  ProgressState now() const;
  double traced_seconds() const;
  void stop_clock();

  const Form form_;
  const bool hints_;
  View* const view_;
  bool shows_picture_ = false;
  std::size_t view_lines_ = 0;  ///< lines that the view takes on the terminal
  const sim::HostClock::time_point begin_ = sim::HostClock::now();
  sim::HostClock::time_point busy_since_, part_since_;  ///< none yet; none under way
  std::mutex mutex_;
  std::condition_variable news_;
  ProgressState state_;
  std::uint64_t rays_before_ = 0, cycles_before_ = 0;  ///< sums over finished parts
  bool bar_is_there_ = false, ended_ = false;
  std::thread thread_;
};

}  // namespace tools
