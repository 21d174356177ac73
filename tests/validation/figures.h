#pragma once
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/studies/reproduce/plan.h"
#include "tools/studies/reproduce/runner.h"

namespace tools {

inline void expect_between(const char* what, double value, double low, double high) {
  EXPECT_GE(value, low) << what;
  EXPECT_LE(value, high) << what;
}

namespace reproduce {

/// Returns the metrics of a test case of `raywatt reproduce`, given by scene, setting and picture width.
inline std::map<std::string, double> measure(const std::vector<Case>& cases, const std::string& scene,
                                             const std::string& setting, std::uint32_t width) {
  for (Case c : cases) {
    if (c.view.scene != scene || c.setting != setting) continue;
    c.width = width;
    c.height = width / 2;
    const Options options;
    const std::vector<Measured> values = Runner(options).measure_case(c);
    std::map<std::string, double> figures;
    for (std::size_t i = 0; i < values.size(); ++i) figures[c.metrics[i].metric] = values[i].value.value();
    return figures;
  }
  throw std::logic_error("there is no setting " + setting + " of " + scene);
}

}  // namespace reproduce
}  // namespace tools
