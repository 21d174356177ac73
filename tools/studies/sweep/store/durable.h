#pragma once
#include <filesystem>
#include <string_view>

namespace tools::sweep {

// Writes that survive a power failure. IoError if it cannot be done.

/// Writes a new file.
void write_durably(const std::filesystem::path& path, std::string_view bytes);
/// Syncs a file or folder that somebody else has written.
void make_durable(const std::filesystem::path& path);
/// Makes the folders that are missing.
void make_folders(const std::filesystem::path& path);
/// The same where a user has asked for that folder: InputError if it cannot be done.
void begin_folder(const std::filesystem::path& path);

}  // namespace tools::sweep
