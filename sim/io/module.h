#pragma once
#include <filesystem>
#include <string_view>

namespace sim {

/// Loads a shared library at its first use, so that the program can start without it. Returns one of its symbols.
/// Searches next to the program, in the installation, and at the path `built`. Throws IoError on failure. `purpose`:
/// end of the error text, such as "for image files".
void* load_module(const std::filesystem::path& built, const char* symbol, std::string_view purpose);

}  // namespace sim
