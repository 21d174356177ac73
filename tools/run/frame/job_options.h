#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tools {

inline constexpr std::uint32_t kMostReplicates = 1000;

/// Command-line options of `raywatt run` and `raywatt verify`.
struct JobOptions {
  std::string config = "sgrt-2016";
  std::string scene;   ///< built-in scene, workload or file; empty: as configured
  std::string camera;  ///< name or index of the camera; empty: as configured
  std::string frames;  ///< frames to simulate: "10:19" or "10"; empty: as configured
  std::string program = "full:1";
  std::string reference;   ///< program to compare with; empty: none
  std::string resolution;  ///< size of the picture: "1024x512"; empty: as configured
  std::vector<std::string> sets;
  std::vector<std::string> ideal;  ///< names of ideal resources
  std::uint32_t threads = 0;       ///< host threads; 0: all cores
  std::filesystem::path rays;      ///< file of rays in place of a camera; empty: none
  bool any_hit = false;            ///< rays of the file end at their first hit
  std::filesystem::path record;    ///< trace file to write; empty: none
  std::filesystem::path out;       ///< folder for results; empty: a dated folder below raywatt-out/
  bool force = false;
  bool quiet = false;
  std::string progress = "auto";  ///< form of the progress display (Progress)
  bool watch = false;             ///< show picture, utilisation and power during the run
  std::string tile_sampling;      ///< share of work to simulate: "5%" or "auto"; empty: all tiles are simulated
  std::string representative;     ///< number of clusters, each with simulated frames: "auto" or "12"; empty: all frames
  std::string slices;             ///< "8" or "auto" slices per frame, simulated concurrently; empty: none
  std::uint32_t replicates = 1;   ///< simulations of each frame (docs/noise.md)
  bool intervals = true;          ///< record cycle reasons and counters over time (docs/intervals.md)
  std::string image = "full";     ///< with tile_sampling: "none" skips tiles that the estimate does not need
  bool json = false;              ///< print totals as JSON instead of the table
  bool debug_images = false;      ///< write debug pictures
  std::string timeline;           ///< tiles of a timeline: "slowest:8"; empty: no timeline
  std::vector<std::string> argv;
};

/// Size of a picture in pixels. Text form "1024x512": two numbers from 1 to 16384; throws InputError otherwise.
struct Resolution {
  std::uint32_t width = 0, height = 0;
};
Resolution parse_resolution(const std::string& text);

/// Frames to simulate. Text form "10:19" (inclusive) or "10"; throws InputError otherwise.
struct FrameRange {
  std::uint32_t first = 0, last = 0;
};
FrameRange parse_frames(const std::string& text);

}  // namespace tools
