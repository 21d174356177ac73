#include "tools/host/progress.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "sim/io/json.h"
#include "sim/report/table.h"
#include "tools/host/process.h"

namespace tools {
namespace {

constexpr std::chrono::milliseconds kBetween(200), kPatience(2000), kBetweenViews(500);
constexpr std::size_t kBar = 24;

void write_stderr(std::string_view text) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

std::size_t columns_of_terminal() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col != 0 ? size.ws_col : 80;
}

bool is_terminal() {
  const char* kind = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) == 1 && kind != nullptr && std::string_view(kind) != "dumb";
}

std::size_t rows_of_terminal() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row != 0 ? size.ws_row : 24;
}

/// Returns the time of day at which the job is expected to end, as text.
std::string end_text(double seconds_left) {
  const std::time_t end = std::time(nullptr) + static_cast<std::time_t>(seconds_left + 0.5);
  return fmt::format("ends at {:%H:%M:%S}", fmt::localtime(end));
}

/// Formats a duration: "48 s", "3 min 20 s" or "2 h 5 min".
std::string duration_text(double seconds) {
  const auto whole = static_cast<std::uint64_t>(std::max(seconds, 0.0) + 0.5);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

double ProgressState::finished_share() const {
  // Finished share of the current part. It is 0 once the part is complete, because `part` then counts it.
  const double of_part = tile == tiles ? 0 : static_cast<double>(tile) / tiles;
  return (part + of_part) / parts;
}

double ProgressState::rays_per_s() const { return traced_seconds > 0 ? static_cast<double>(rays) / traced_seconds : 0; }

double ProgressState::seconds_left() const {
  const double before = tiles == 0 ? 0 : static_cast<double>(tile_before) / tiles / parts;
  return finished_share() > before ? busy_seconds * (1 - finished_share()) / (finished_share() - before) : -1;
}

std::string progress_line(const ProgressState& s, std::size_t columns) {
  std::string line = s.label.empty() ? "" : s.label + ": ";
  line += s.phase;
  if (s.tiles != 0) {
    if (s.parts > 1) line += fmt::format(" frame {}", s.frame);
    const auto full = static_cast<std::size_t>(s.finished_share() * kBar);
    line += fmt::format(" [{}{}] {:.0f} %", std::string(full, '#'), std::string(kBar - full, '.'),
                        100 * s.finished_share());
    if (s.rays != 0) line += "  " + sim::si_text(s.rays_per_s(), "rays/s");
    if (s.ended) {
      line += "  after " + duration_text(s.seconds);
    } else if (s.seconds_left() >= 0) {
      line += "  " + duration_text(s.seconds_left()) + " left";
    }
  } else {
    line += " ...  " + duration_text(s.seconds);
  }
  if (line.size() >= columns) line.resize(columns - 1);  // a full line would wrap
  return line;
}

std::string progress_json(const ProgressState& s) {
  sim::Json json = {{"time", s.seconds}, {"phase", s.phase}};
  if (!s.label.empty()) json["label"] = s.label;
  json.update({{"frame", s.frame},
               {"part", s.part},
               {"parts", s.parts},
               {"tile", s.tile},
               {"tiles", s.tiles},
               {"rays", s.rays},
               {"cycles", s.cycles},
               {"rays_per_s", s.rays_per_s()}});
  json["seconds_left"] = s.seconds_left() >= 0 ? sim::Json(s.seconds_left()) : sim::Json(nullptr);
  return sim::json_line(json) + "\n";
}

Progress::Form Progress::form_of(const std::string& form, bool quiet) {
  if (form == "json") return Form::kJson;
  if (form == "watch") return is_terminal() && ::isatty(STDOUT_FILENO) == 1 ? Form::kView : Form::kLines;
  return form == "auto" && !quiet && is_terminal() ? Form::kBar : Form::kNone;
}

Progress::Progress(const std::string& form, bool quiet, View* view)
    : form_(form_of(form, quiet)), hints_(!quiet && form != "json" && form != "none"), view_(view) {
  shows_picture_ = form_ == Form::kView && view_ != nullptr && has_true_colour();
  if (form_ != Form::kNone) thread_ = std::thread([this] { run_display(); });
}

Progress::~Progress() {
  finish(is_interrupted() ? "interrupted" : std::uncaught_exceptions() != 0 ? "failed" : "done");
}

void Progress::set_phase(const std::string& what) {
  const std::lock_guard lock(mutex_);
  stop_clock();
  state_.phase = what;
}

void Progress::expect_parts(std::uint32_t parts, const std::string& label) {
  const std::lock_guard lock(mutex_);
  restart_parts(parts, label);
}

void Progress::restart_parts(std::uint32_t parts, const std::string& label) {
  state_ = {.phase = state_.phase, .label = label, .parts = std::max(parts, 1U)};
  rays_before_ = cycles_before_ = 0;
  busy_since_ = part_since_ = {};
}

void Progress::begin_part(const std::string& what, std::uint32_t frame, std::uint32_t tiles, std::uint32_t before) {
  const std::lock_guard lock(mutex_);
  if (state_.part == state_.parts) restart_parts(state_.parts, std::string(state_.label));
  stop_clock();
  part_since_ = sim::HostClock::now();
  if (busy_since_ == sim::HostClock::time_point{}) busy_since_ = part_since_;
  state_.phase = what;
  state_.frame = frame;
  state_.tile = state_.tile_before = before;
  state_.tiles = tiles;
}

void Progress::set_tiles_done(std::uint32_t tiles, std::uint64_t rays, std::uint64_t cycles) {
  const std::lock_guard lock(mutex_);
  state_.tile = tiles;
  state_.rays = rays_before_ + rays;
  state_.cycles = cycles_before_ + cycles;
  if (tiles < state_.tiles) return;
  stop_clock();
  state_.part += 1;
  rays_before_ = state_.rays;
  cycles_before_ = state_.cycles;
}

void Progress::print_line(const std::string& line) {
  const std::lock_guard lock(mutex_);
  erase_bar();
  write_stderr(line + "\n");
}

void Progress::finish(const std::string& how) {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = state_.ended = true;
    state_.phase = how;
  }
  news_.notify_all();
  thread_.join();
  if (form_ == Form::kJson) write_stderr(progress_json(current_state()));
  if (form_ == Form::kView && view_lines_ != 0) show_view();
  if (form_ == Form::kLines) print_progress_line();
  erase_bar();
}

void Progress::run_display() {
  std::unique_lock lock(mutex_);
  const auto ended = [this] { return ended_; };
  if (form_ == Form::kBar && news_.wait_for(lock, kPatience, ended)) return;
  const auto between = form_ == Form::kView ? kBetweenViews : form_ == Form::kLines ? kPatience : kBetween;
  for (bool at_once = form_ == Form::kView; at_once || !news_.wait_for(lock, between, ended); at_once = false) {
    try {
      draw_progress();
    } catch (const std::bad_alloc&) {
      // A failed update of the display is ignored: the job continues without it.
    }
  }
}

void Progress::draw_progress() {
  if (form_ == Form::kJson) {
    write_stderr(progress_json(current_state()));
    return;
  }
  if (form_ == Form::kView) return show_view();
  if (form_ == Form::kLines) return print_progress_line();
  bar_is_there_ = true;
  set_bar_visible(true);
  write_stderr(fmt::format("\r{}\x1b[K", progress_line(current_state(), columns_of_terminal())));
}

/// Redraws the live view of a job: picture, statistics and progress.
void Progress::show_view() {
  const std::size_t columns = columns_of_terminal(), rows = rows_of_terminal();
  const ProgressState state = current_state();
  std::vector<std::string> lines = {progress_line(state, columns)};
  if (state.seconds_left() >= 0 && !state.ended) lines.push_back(end_text(state.seconds_left()));
  if (view_ != nullptr) {
    for (std::string& line : view_->lines()) lines.push_back(std::move(line).substr(0, columns - 1));
  }
  std::string text = view_lines_ == 0 ? "" : fmt::format("\x1b[{}A", view_lines_);
  std::size_t taken = lines.size();
  const std::size_t left = rows > taken + 1 ? rows - taken - 1 : 0;
  if (shows_picture_) {
    const SmallPicture picture = view_->picture(columns - 1, 2 * left);
    text += draw_half_blocks(picture);
    taken += (picture.height + 1) / 2;
  }
  for (const std::string& line : lines) text += "\r" + line + "\x1b[K\n";
  write_stderr(text + "\x1b[J");
  view_lines_ = taken;
}

/// Prints the progress as a new line, for output that is not a terminal.
void Progress::print_progress_line() {
  constexpr std::size_t kAnyLength = 1 << 10;
  const ProgressState state = current_state();
  std::string line = progress_line(state, kAnyLength);
  if (state.seconds_left() >= 0 && !state.ended) line += ", " + end_text(state.seconds_left());
  if (view_ != nullptr) {
    for (const std::string& more : view_->lines()) line += "; " + more;
  }
  write_stderr(line + "\n");
}

void Progress::erase_bar() {
  view_lines_ = 0;
  if (!bar_is_there_) return;
  write_stderr("\r\x1b[K");
  bar_is_there_ = false;
  set_bar_visible(false);
}

double Progress::traced_seconds() const {
  const bool counts = part_since_ != sim::HostClock::time_point{} && state_.rays > rays_before_;
  return state_.traced_seconds + (counts ? sim::seconds_since(part_since_) : 0);
}

/// Ends the job's current part, if any: adds the time since its start to the job's tracing time.
void Progress::stop_clock() {
  state_.traced_seconds = traced_seconds();
  part_since_ = {};
}

ProgressState Progress::current_state() const {
  ProgressState state = state_;
  state.seconds = sim::seconds_since(begin_);
  state.traced_seconds = traced_seconds();
  if (busy_since_ != sim::HostClock::time_point{}) state.busy_seconds = sim::seconds_since(busy_since_);
  return state;
}

namespace {

using Colour = std::array<std::uint8_t, 3>;

Colour colour_at(const SmallPicture& picture, std::size_t x, std::size_t y) {
  const std::uint8_t* at = picture.rgb.data() + 3 * (y * picture.width + x);
  return {at[0], at[1], at[2]};
}

}  // namespace

bool has_true_colour() {
  const char* variable = std::getenv("COLORTERM");
  const std::string_view value = variable == nullptr ? "" : variable;
  return value == "truecolor" || value == "24bit";
}

std::string draw_half_blocks(const SmallPicture& picture) {
  std::string out;
  for (std::size_t y = 0; y < picture.height; y += 2) {
    out += '\r';
    for (std::size_t x = 0; x < picture.width; ++x) {
      const Colour up = colour_at(picture, x, y);
      const Colour down = y + 1 < picture.height ? colour_at(picture, x, y + 1) : Colour{};
      out += fmt::format("\x1b[38;2;{};{};{};48;2;{};{};{}m\u2580", up[0], up[1], up[2], down[0], down[1], down[2]);
    }
    out += "\x1b[0m\x1b[K\n";
  }
  return out;
}

}  // namespace tools
