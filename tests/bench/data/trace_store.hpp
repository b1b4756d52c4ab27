#pragma once

#include "engine/realtime/tick_record.hpp"
#include "tests/support/std.hpp"

namespace palpate::bench {

/// One way to keep the ticks of many trials in a file.
class TraceStore {
public:
    TraceStore() = default;
    TraceStore(const TraceStore&) = delete;
    TraceStore& operator=(const TraceStore&) = delete;
    virtual ~TraceStore() = default;

    [[nodiscard]] virtual std::string name() const = 0;
    /// A whole trial, durable as the store does it by itself. @param trial  1, 2, ... in order
    virtual void write(std::int64_t trial, std::span<const engine::TickRecord> ticks) = 0;
    /// Nothing more will be written: the file is whole on the disk.
    virtual void finish() = 0;
    /// Bytes of all its files.
    [[nodiscard]] virtual std::uintmax_t bytes() const = 0;
    /// Mean normal force of one trial, N: a column that must be read or computed again.
    [[nodiscard]] virtual double mean_normal_force(std::int64_t trial) = 0;
    /// Mean x of the commanded force over all trials, N: one stored column of everything.
    [[nodiscard]] virtual double mean_command_x() = 0;
    /// Proves all that it holds. @return samples proved; 0: such a store cannot
    [[nodiscard]] virtual std::size_t verify() { return 0; }
};

/// Row per sample in SQLite, PRIMARY KEY (trial, tick) WITHOUT ROWID, WAL, one transaction a trial.
[[nodiscard]] std::unique_ptr<TraceStore> row_store(const std::string& folder);
/// One CSV file a trial, shortest decimal numbers that read back to the same bits.
[[nodiscard]] std::unique_ptr<TraceStore> csv_store(const std::string& folder);
/// One HDF5 compound dataset a trial, chunks of 4096, shuffle and gzip 1. None without the peers.
[[nodiscard]] std::unique_ptr<TraceStore> hdf5_store(const std::string& folder);

}  // namespace palpate::bench
