#pragma once
#include <filesystem>
#include <string_view>

namespace sim {

/// Loads a shared library when it is first used and returns one of its symbols, so that the program starts without it.
/// Searches next to the program, in the installation, and at the path `built`. Throws IoError on failure. `purpose`
/// completes the error text: "for image files".
void* load_module(const std::filesystem::path& built, const char* symbol, std::string_view purpose);

}  // namespace sim
