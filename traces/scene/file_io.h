#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace traces {

/// The bytes of a regular file. InputError if it cannot be opened or is larger than `most_bytes`, IoError if reading
/// fails.
std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes);

/// Writes beside `path` under a temporary name that keeps its extension, then renames: readers see all or nothing.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace traces
