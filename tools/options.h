#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tools {

/// What `raywatt run` and `raywatt verify` can be told.
struct JobOptions {
  std::string config = "sgrt-2016";
  std::string scene;   ///< built-in scene, workload or file; empty: the configuration's
  std::string camera;  ///< name or index; empty: the configuration's
  std::string frames;  ///< "10:19" or "10"; empty: the configuration's
  std::string program = "full:1";
  std::string reference;   ///< program to compare with; empty: none
  std::string resolution;  ///< "1024x512"; empty: the configuration's
  std::vector<std::string> sets;
  std::vector<std::string> ideal;  ///< resources made perfect
  std::uint32_t threads = 0;       ///< 0: all cores
  std::filesystem::path rays;      ///< list of rays in place of a camera; empty: none
  std::filesystem::path record;    ///< trace to be written; empty: none
  std::filesystem::path out;       ///< empty: a dated folder below raywatt-out/
  bool force = false;
  bool quiet = false;
  std::string progress = "auto";  ///< form of Progress
  std::string tile_sampling;      ///< "5%" or "auto"; empty: all tiles are timed
  std::string image = "full";     ///< with tile_sampling: "none" leaves out tiles that nothing is learnt from
  bool debug_images = false;      ///< also pictures of how adaptive frames came about
  std::vector<std::string> argv;
};

/// Adds to a verb of the command line what says what is rendered, and on what.
/// `positional`: the configuration is an argument of its own.
void add_work_options(CLI::App& verb, JobOptions& options, bool positional = true);
/// Adds a list of rays, which takes the place of what says what is rendered; call it last.
void add_rays_option(CLI::App& verb, JobOptions& options);
/// Adds the program that others are compared with.
void add_reference_option(CLI::App& verb, JobOptions& options);
/// Adds perfect resources.
void add_ideal_option(CLI::App& verb, JobOptions& options);
/// Adds what becomes of the results.
void add_output_options(CLI::App& verb, JobOptions& options);
/// Adds frames of an animation.
void add_frames_option(CLI::App& verb, JobOptions& options);
/// These, frames, and what becomes of the results.
void add_job_options(CLI::App& verb, JobOptions& options);
void add_config_options(CLI::App& verb, std::string& config, std::vector<std::string>& sets);
void add_set_option(CLI::App& verb, std::vector<std::string>& sets);

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
