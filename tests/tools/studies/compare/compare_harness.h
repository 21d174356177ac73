#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace test {

/// Base of tests that compare runs. A run is simulated at its first use and kept for all tests of the process.
class Runs : public testing::Test {
 protected:
  void run(const std::string& name) const {
    static const std::map<std::string, Words> kMore = {{"base", {}},
                                                       {"same", {}},
                                                       {"ports", {"--set", "srp.switch_cycles=16"}},
                                                       {"slow-l2", {"--set", "l2.hit_cycles=40"}},
                                                       {"teapot", {"--scene", "teapot"}},
                                                       {"larger", {"--resolution", "48x32"}},
                                                       {"samples", {"--program", "full:4"}}};
    Words words = {
        "run", "--quiet", "--threads", "1", "-o", (folder.path() / name).string(), "--set", "scene.triangles=1000"};
    if (name != "larger") words.insert(words.end(), {"--resolution", "32x16"});
    words.insert(words.end(), kMore.at(name).begin(), kMore.at(name).end());
    const ProcessResult ending = raywatt(words);
    ASSERT_EQ(ending.exit, 0) << ending.err;
  }
  std::string path(const std::string& name) const {
    const std::filesystem::path path = folder.path() / name;
    if (!std::filesystem::exists(path)) run(name);
    return path.string();
  }
  nlohmann::json compared(const std::string& a, const std::string& b) const {
    const ProcessResult ending = raywatt({"compare", path(a), path(b), "--json"});
    EXPECT_EQ(ending.exit, 0) << ending.err;
    const nlohmann::json json = nlohmann::json::parse(ending.out);
    EXPECT_EQ(json["schema"], "raywatt-compare/1");
    return json["against"][0];
  }
  /// Writes a changed copy of the report of the run "base" and returns its path.
  std::string changed(const std::string& name, const std::function<void(nlohmann::json&)>& change) const {
    nlohmann::json report = read_json(path("base") + "/report.json");
    change(report);
    return folder.write(name, report.dump()).string();
  }

  static const TempFolder& made_runs() {
    static const TempFolder folder;
    return folder;
  }

  const TempFolder& folder = made_runs();
};

}  // namespace test
