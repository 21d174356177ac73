#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "sim/error.h"
#include "tools/build_info.h"
#include "tools/verbs/verbs.h"

namespace {

int complain(const std::exception& error, int exit) {
  fmt::print(stderr, "raywatt: {}\n", error.what());
  return exit;
}

int run(int argc, char** argv) {
  int exit = tools::kGood;
  CLI::App app{"Raywatt simulates a mobile ray-tracing GPU: cycles, rays, energy and performance per watt.", "raywatt"};
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("raywatt {} ({}{})", tools::build_info().version,
                                                tools::build_info().git.substr(0, 12),
                                                tools::build_info().dirty ? ", with changes" : ""));
  const std::vector<std::string> words(argv, argv + argc);
  tools::add_run(app, words, exit);
  tools::add_verify(app, words, exit);
  tools::add_scenes(app);
  tools::add_config(app);
  tools::add_kernels(app);
  tools::add_bench(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked = error.get_exit_code() == 0;  // --help, --version
    if (asked) return app.exit(error);
    fmt::print(stderr, "raywatt: {}; see raywatt --help\n", error.what());
    return tools::kBadInput;
  }
  return exit;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const sim::InputError& error) {
    return complain(error, tools::kBadInput);
  } catch (const sim::IoError& error) {
    return complain(error, tools::kIoFailed);
  } catch (const sim::Deadlock& error) {
    fmt::print(stderr, "raywatt: {}\n{}", error.what(), error.state);
    return tools::kStuckMachine;
  } catch (const std::exception& error) {
    fmt::print(stderr, "raywatt: internal error: {}\n", error.what());
    return tools::kOurBug;
  }
}
