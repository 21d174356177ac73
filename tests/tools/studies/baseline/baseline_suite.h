#pragma once
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace test {

/// A regression suite of two runs on a machine that handles one ray at a time, so that a changed unit can be located.
class BaselineSuite {
 public:
  explicit BaselineSuite(
      const std::string& keep = "{cycles: exact, rays: exact, energy_mj: 0.000001 %, units: exact}") {
    machine("");
    write("keep: " + keep + R"(
defaults: {config: machine.yaml, set: {scene.triangles: 500}}
runs:
  pixel: {resolution: 1x1}
  square: {resolution: 4x4}
)");
  }
  void write(const std::string& text) { file_ = folder_.write("suite.yaml", text).string(); }
  /// Writes the machine's configuration with an additional line.
  void machine(const std::string& change) { folder_.write("machine.yaml", "extends: " + change_base_ + "\n" + change); }
  ProcessResult baseline(const std::string& step, const Words& more = {}) const {
    Words words = {"baseline", step, file_};
    words.insert(words.end(), more.begin(), more.end());
    return raywatt(words);
  }
  std::string values() const { return read_bytes(folder_.path() / "suite.baseline.yaml"); }
  void write_values(const std::string& text) const { folder_.write("suite.baseline.yaml", text); }
  const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_;
  std::string file_;
  const std::string change_base_ = folder_
                                       .write("serial.yaml", R"(
extends: sgrt-2016
cores: 1
tni: {trvs: 1, trv: {rays: 1, l1: {size: 1 KiB}}}
l2: {banks: 1}
tile_buffer: {tiles_in_flight: 1}
dram: {channels: 1, timing: {refi_pb: 0, refi_ab: 0}}
)")
                                       .filename()
                                       .string();
};

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

}  // namespace test
