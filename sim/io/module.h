#pragma once
#include <filesystem>
#include <string_view>

namespace sim {

/// Loads a shared library that the program has in a file of its own, so that it starts without it, and returns a
/// symbol of it. It is looked for beside the program, where it is installed, and where it was `built`. `purpose` is for
/// the IoError if there is none: "for image files".
void* load_module(const std::filesystem::path& built, const char* symbol, std::string_view purpose);

}  // namespace sim
