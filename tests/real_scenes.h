#pragma once
#include <cstdlib>
#include <filesystem>

namespace test {

/// Returns the folder of large scene files: $RAYWATT_SCENES, or shared/scenes next to the checkout. It may not exist.
inline std::filesystem::path scenes_folder() {
  const char* variable = std::getenv("RAYWATT_SCENES");
  if (variable != nullptr) return variable;
  return std::filesystem::path(RAYWATT_SOURCE_DIR).parent_path() / "shared" / "scenes";
}

}  // namespace test
