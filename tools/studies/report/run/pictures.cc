#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "tools/studies/report/page/page_picture.h"
#include "tools/studies/report/run/overlays.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kAnyLength = std::numeric_limits<std::size_t>::max();
// Bytes of data: URLs that a page takes along, so that a frame of 2048x1024 makes at most 6 MB.
constexpr std::uint64_t kLargestPictures = 3'900'000;  ///< the picture, what pixels took, debug pictures
constexpr std::uint64_t kLargestDebug = 1'000'000;     ///< debug pictures

/// Meaning of a debug picture's colours (docs/adaptive.md), by how its name begins.
struct Meaning {
  std::string_view name, words;
};
constexpr std::array<Meaning, 11> kMeanings = {
    {{"similar", "yellow: interpolated; blue: traced; green: traced by post-correction; grey: references"},
     {"interpolated", "the picture where it is interpolated, black elsewhere"},
     {"check ", "white: samples that failed this check, over the darkened picture"},
     {"rates", "a tile's blocks, dark 2, bright 4; green for similar, red for not"},
     {"propagated", "white: pixels that rounds of propagation have corrected"},
     {"active", "active sub-pixels of a pixel: black, red, green, blue, white for 0 to 4"},
     {"differs ", "white: pixels with an active sub-pixel where the attribute disagreed"},
     {"weights", "weight that is left of the shaded samples at all samples of a pixel: white 1, black 0"},
     {"edges ", "white: pixels one of whose samples is parted from a shaded one around"},
     {"overdraw", "triangles that cover a pixel: black none, blue one, red eight or more"},
     {"quads", "quads of triangles that a pixel lies in: black none, blue one, red eight or more"}}};

std::string_view meaning_of(const std::string& name) {
  const auto found = std::ranges::find_if(kMeanings, [&](const Meaning& m) { return name.starts_with(m.name); });
  return found == kMeanings.end() ? std::string_view() : found->words;
}

/// "check shadow" in words.
std::string title_of(const std::string& name) {
  constexpr std::string_view kCheck = "check ";
  return name.starts_with(kCheck) ? "failed check: " + name.substr(kCheck.size()) : name;
}

/// Begin of the names of the first frame's debug pictures where there are several frames.
std::string first_frame_name(const Run& run) {
  const Json& frames = at(run.report.json, {"frames"});
  const double number = frames.is_array() && !frames.empty() ? number_at(frames[0], {"frame"}) : 0;
  return fmt::format("frame-{:04.0f}-debug-", number);
}

/// Pictures of --debug-images that have no values elsewhere, of the first frame, by name.
std::vector<std::pair<std::string, fs::path>> debug_pictures_in(const Run& run) {
  const std::string of_first = first_frame_name(run);
  std::vector<std::pair<std::string, fs::path>> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(run.folder, ignored)) {
    std::string name = entry.path().filename().string();
    const bool is_first_frame = name.starts_with("debug-") || name.starts_with(of_first);
    const fs::path values = fs::path(entry.path()).replace_extension(".exr");
    if (!is_first_frame || !name.ends_with(".png") || fs::exists(values, ignored)) continue;
    name = name.substr(name.find("debug-") + 6);
    name = name.substr(0, name.size() - 4);
    std::ranges::replace(name, '-', ' ');
    found.emplace_back(sim::printable(name), entry.path());
  }
  std::ranges::sort(found);
  return found;
}

struct DebugPictures {
  Json overlays = Json::array();
  std::uint64_t bytes = 0;
  std::size_t left_out = 0;
};

DebugPictures debug_pictures(const Run& run) {
  DebugPictures out;
  for (const auto& [name, file] : debug_pictures_in(run)) {
    const std::optional<std::string> overlay = page_picture(file, kMostPixels);
    if (!overlay || out.bytes + overlay->size() > kLargestDebug) {
      ++out.left_out;
      continue;
    }
    out.bytes += overlay->size();
    out.overlays.push_back(
        {{"id", "debug " + name}, {"name", title_of(name)}, {"note", meaning_of(name)}, {"picture", *overlay}});
  }
  return out;
}

}  // namespace

void add_pictures(const Run& run, View& view) {
  Section section("picture", "The picture");
  const fs::path file = run.report.picture("png");
  std::optional<std::string> picture = page_picture(file, kAnyLength);
  Overlays overlays = overlays_of(run);
  if (!picture) {
    section.text(fmt::format("There is no {} beside the report, so there is no picture here. {}",
                             file.filename().string(), overlays.missing));
    return view.add(section);
  }
  DebugPictures debug = run.report.is_reference() ? DebugPictures() : debug_pictures(run);
  std::string note = overlays.missing;
  if (debug.left_out > 0)
    note += fmt::format(" Too large for the page: {}.", counted(static_cast<double>(debug.left_out), "debug picture"));
  if (picture->size() + debug.bytes + overlays.pixel_bytes > kLargestPictures)
    picture = page_picture(file, kMostPixels);
  section.block("picture", "frame", "Picture and overlays",
                {{"about", "The rendered picture: " + text_at(run.report.json, {"scene", "name"})},
                 {"width", run.number("resolution[0]")},
                 {"height", run.number("resolution[1]")},
                 {"picture", *picture},
                 {"overlays", std::move(debug.overlays)},
                 {"grids", std::move(overlays.grids)},
                 {"times", std::move(overlays.times)},
                 {"note", note}});
  view.add(section);
}

}  // namespace tools::pages
