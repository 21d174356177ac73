#pragma once
#include <cstdlib>
#include <filesystem>

namespace test {

/// Where real scenes lie, for the tests that want some: $RAYWATT_SCENES, or a folder shared beside the checkout. It
/// need not exist.
inline std::filesystem::path scenes_folder() {
  const char* variable = std::getenv("RAYWATT_SCENES");
  if (variable != nullptr) return variable;
  return std::filesystem::path(RAYWATT_SOURCE_DIR).parent_path() / "shared" / "scenes";
}

}  // namespace test
