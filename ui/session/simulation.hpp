#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "ui/session/simulated_session.hpp"

namespace palpate::ui {

/// Which of all participants: those whose index leaves `number` when divided by `of`.
struct Shard {
    std::size_t number = 0;
    std::size_t of = 1;
};

/// "K/N". @throws std::invalid_argument unless 0 <= K < N <= 100000
[[nodiscard]] Shard parse_shard(const std::string& text);
/// "shard-003-of-008.sqlite"
[[nodiscard]] std::string shard_name(const Shard& shard);

/// Which participants are simulated, and into which file.
struct SimulationSpec {
    SimulatedStudy people;
    std::size_t participants = 0;  ///< of the study, in all shards together
    Shard shard{};
    std::size_t threads = 1;
    std::filesystem::path file;     ///< is there only when it is whole
    std::filesystem::path scratch;  ///< folder of the growing file; empty: beside `file`
    /// Of a participant that is kept. @param kept  of this shard, so far
    std::function<void(const std::string& code, std::size_t kept)> progress{};
};

/// How a simulation ended.
enum class SimulationEnd {
    made,
    was_there,  ///< whole already, nothing was done
    stopped,    ///< interrupted(): the same call goes on
};

/// Simulates the participants of a shard into its file. Same specification, same bytes, whatever
/// the number of threads and however often it was stopped: sessions go in one by one, in the order
/// of their codes, and the whole file is written once more from its rows (VACUUM INTO).
///
/// While it grows it is called `file`.partial, and holds whole sessions alone. After a kill the
/// next call goes on with it. With `scratch` it grows there, and comes back when it is stopped by a
/// signal.
/// @throws std::invalid_argument if a file is there that holds something else; std::runtime_error
///         if another program makes it; data::StoreError
[[nodiscard]] SimulationEnd simulate(const SimulationSpec& spec);

/// Participants of this shard. @pre shard.number < shard.of
[[nodiscard]] std::size_t participants_of(const Shard& shard, std::size_t participants) noexcept;

}  // namespace palpate::ui
