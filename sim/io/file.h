#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace sim {

/// The bytes of a regular file. InputError if there is none, if it cannot be opened or if it is larger than
/// `most_bytes`; IoError if reading fails.
std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes);

/// The name under which a file is written before it takes the place of `path`: same folder, same extension
/// ("x.png" -> "x.tmp.png"), because image writers choose their format by it.
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// Replaces `path` by `bytes`: readers see the old file or the whole new one, also after a power failure. IoError, and
/// nothing left behind, if that fails.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// The second half of write_file_atomically, for a temporary file that somebody else has written.
void commit_file(const std::filesystem::path& temporary, const std::filesystem::path& path);

}  // namespace sim
