#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "sim/io/json.h"
#include "tools/studies/sweep/launch/slurm_launcher.h"

namespace tools {

/// Says what has been handed in, and how to go on.
void tell_submitted(const sweep::SlurmLauncher::Submitted& submitted, std::span<const sweep::Point> points,
                    const std::filesystem::path& out);
/// Says that tasks have ended without results, and the last that one of them said.
void tell_missing(const sweep::SweepFolder& folder, std::uint64_t missing);

/// State of a sweep that has been handed in: {"running", "waiting", "jobs", "reasons"}, or {"error"} if Slurm does not
/// tell.
std::optional<sim::Json> slurm_status(const sweep::SweepFolder& folder);
/// "in Slurm's queue: ..."
void print_slurm_status(const sim::Json& status);

/// Cancels the sweep's jobs; false if none was in the queue.
bool cancel_on_slurm(const sweep::SweepFolder& folder);

}  // namespace tools
