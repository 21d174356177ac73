#pragma once
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace tools::sweep {

/// A task of a job array that has not ended.
struct SlurmTask {
  std::string job;           ///< id of the array
  std::uint64_t index = 0;   ///< in it
  std::string state;         ///< Slurm's word: PENDING, RUNNING, COMPLETING, ...
  std::string reason, node;  ///< why it waits; where it runs
  std::filesystem::path script;
};

/// Slurm, as its own commands tell of it. Whatever a command complains of is in the error's text. InputError if there
/// is no such command on this host.
namespace slurm {

/// The user's tasks whose script is in this folder, in no order. IoError.
std::vector<SlurmTask> tasks_of(const std::filesystem::path& folder);
/// Tasks that an array may have: MaxArraySize. IoError.
std::uint64_t most_tasks();
/// Hands in a job; its id. InputError if Slurm refuses it.
std::string submit(const std::vector<std::string>& arguments);
/// Cancels the jobs. IoError if Slurm refuses.
void cancel(const std::set<std::string>& jobs);

}  // namespace slurm

}  // namespace tools::sweep
