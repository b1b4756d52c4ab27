#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/device/calibration.hpp"
#include "engine/realtime/scene_view.hpp"
#include "engine/realtime/tick_record.hpp"
#include "data/store/database.hpp"
#include "data/trace/retrace.hpp"

namespace palpate::data {

/// Writes the trace of the running trial in chunks of codec 2. A chunk that is not full yet is a
/// row too, replaced by a longer one at every save(): whatever ends the program, the last save()
/// stands.
///
/// What follows from the rest of a chunk is not written: the writer computes it again from what it
/// writes and compares. Where one bit differs (another device, lost ticks) the chunk holds that
/// part in full.
class TraceWriter {
public:
    /// @param machine    with which the session began; nothing: no device with encoders
    /// @param period_ns  of the servo
    TraceWriter(Database& database,
                std::optional<engine::PantographSpec> machine,
                std::int64_t period_ns);
    ~TraceWriter();

    /// From here on ticks are those of this interval, what is not saved of another is dropped.
    /// @param scene  as the servo has it, with the same decays
    void begin(std::int64_t trial, std::int64_t interval, std::unique_ptr<engine::FeltScene> scene);

    /// Into memory, nothing else.
    void add(std::span<const engine::TickRecord> ticks);

    /// Writes what was added, in the caller's transaction. What is said to be saved stays in memory
    /// until saved() says that the transaction was committed.
    void write();
    void saved();

    /// Something added is not in a committed chunk yet.
    [[nodiscard]] bool has_unsaved() const noexcept { return unsaved_ > 0; }
    /// There is a full chunk in memory.
    [[nodiscard]] bool is_full() const noexcept;

private:
    Database& database_;
    std::optional<engine::PantographSpec> machine_;
    std::int64_t period_ns_;
    std::int64_t trial_ = 0;
    std::int64_t interval_ = 1;
    std::unique_ptr<engine::FeltScene> scene_;
    std::unique_ptr<Retrace> retrace_;
    std::vector<engine::TickRecord> ticks_;  ///< from the first of the chunk that is not full
    std::vector<std::uint8_t> parts_;        ///< of each tick that write() has seen
    std::size_t unsaved_ = 0;
    bool row_there_ = false;  ///< of the first of them, shorter
};

}  // namespace palpate::data
