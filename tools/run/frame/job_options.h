#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tools {

inline constexpr std::uint32_t kMostReplicates = 1000;

/// Options of `raywatt run` and `raywatt verify`.
struct JobOptions {
  std::string config = "sgrt-2016";
  std::string scene;   ///< built-in scene, workload or file; empty: the configuration's
  std::string camera;  ///< name or index; empty: the configuration's
  std::string frames;  ///< "10:19" or "10"; empty: the configuration's
  std::string program = "full:1";
  std::string reference;   ///< program to compare with; empty: none
  std::string resolution;  ///< "1024x512"; empty: the configuration's
  std::vector<std::string> sets;
  std::vector<std::string> ideal;  ///< resources made ideal
  std::uint32_t threads = 0;       ///< 0: all cores
  std::filesystem::path rays;      ///< list of rays in place of a camera; empty: none
  std::filesystem::path record;    ///< trace to be written; empty: none
  std::filesystem::path out;       ///< empty: a dated folder below raywatt-out/
  bool force = false;
  bool quiet = false;
  std::string progress = "auto";  ///< form of Progress
  bool watch = false;             ///< the terminal shows picture, utilisation and power so far
  std::string tile_sampling;      ///< "5%" or "auto"; empty: all tiles are timed
  std::string slices;             ///< "8" or "auto": of each frame, played side by side; empty: none
  std::uint32_t replicates = 1;   ///< plays of each frame's work (docs/noise.md)
  bool intervals = true;          ///< units' reasons and counters over time are kept (docs/intervals.md)
  std::string image = "full";     ///< with tile_sampling: "none" leaves out tiles that nothing is learnt from
  bool json = false;              ///< totals as JSON on standard output in the table's stead
  bool debug_images = false;      ///< also pictures of where work went, and of how adaptive frames came about
  std::string timeline;           ///< tiles that a timeline shows: "slowest:8"; empty: none is written
  std::vector<std::string> argv;
};

/// "1024x512" as two numbers from 1 to 16384; InputError otherwise.
struct Resolution {
  std::uint32_t width = 0, height = 0;
};
Resolution parse_resolution(const std::string& text);

/// "10:19" (both rendered) or "10"; InputError otherwise.
struct FrameRange {
  std::uint32_t first = 0, last = 0;
};
FrameRange parse_frames(const std::string& text);

}  // namespace tools
