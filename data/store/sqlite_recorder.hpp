#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/descriptor.hpp"
#include "engine/device/calibration.hpp"
#include "engine/realtime/scene_view.hpp"
#include "engine/realtime/tick_record.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/session/recorder.hpp"
#include "data/store/database.hpp"
#include "data/store/stored_progress.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/retrace.hpp"

namespace palpate::data {

/// Writes the trace of the running trial in chunks of kTraceCodec. A chunk that is not full yet is a
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
    [[nodiscard]] bool is_full() const noexcept { return ticks_.size() >= kChunkTicks; }

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

/// Room on a file's disk that nobody else can fill: a file without a name, so that nothing is left
/// of it however the program ends. When the disk turns out to be full it is given back piece by
/// piece: another program that goes on filling the disk gets little of it.
class Reserve {
public:
    /// @param file  whose disk it is; holds nothing yet
    explicit Reserve(std::string file) : file_(std::move(file)) {}

    /// Holds at least `bytes` from here on. On a disk that cannot set room aside (some network
    /// disks) it only looks whether they are free now.
    /// @throws StoreError if the disk does not have them; what was held is held still
    void hold(std::int64_t bytes);
    /// Frees 1 MB, more than one save() writes. @return false: there was none
    bool give_back();

private:
    [[nodiscard]] int take(std::int64_t bytes);

    std::string file_;
    Descriptor held_in_{};
    std::int64_t held_ = 0;
};

/// Writes a running session. Every commit is synced: what a call has stored survives a power cut.
///
/// append() collects ticks and commits each full chunk of kChunkTicks; save() commits also the one
/// that is not full yet, to be replaced by a longer one; end_trial() commits the rest with the
/// result. While another program holds a write lock append() and save() leave the ticks in memory;
/// the other calls wait for a minute.
///
/// After an error what was appended stays in memory for another try: a stored trace may end early
/// but never has a hole. Results need a trial that runs: an answer that went nowhere would go
/// unnoticed. begin_trial() sets room for a whole trial aside, and refuses where the disk has none:
/// where the disk is full, a trial that has begun is recorded to its end, and the session ends
/// after it.
/// @throws StoreError, and std::logic_error for a call that breaks the order begin, append, end
class SqliteRecorder : public protocols::Recorder {
public:
    /// @param database, protocol  outlive the recorder
    /// @param ticks  false: none are kept, of a simulated session whose provenance says so
    /// (kTracesKey)
    SqliteRecorder(Database& database,
                   const protocols::Protocol& protocol,
                   std::int64_t session,
                   bool ticks = true);

    [[nodiscard]] protocols::TrialId begin_trial(const protocols::PlannedTrial& planned) override;
    /// What was appended of the interval before is committed first.
    void begin_interval(protocols::TrialId trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene) override;
    void append(protocols::TrialId trial, std::span<const engine::TickRecord> ticks) override;
    bool save() override;
    void end_trial(protocols::TrialId trial, const protocols::TrialResult& result) override;
    void event(const protocols::Event& event) override;
    void finish_session() override;

private:
    /// What `work` returns, tried again with more room as long as there is any set aside.
    template <class Work>
    auto with_room(const Work& work);
    void write_end(protocols::TrialId trial, const protocols::TrialResult& result);
    void require_running(protocols::TrialId trial) const;
    void write_intervals(protocols::TrialId trial, const protocols::TrialResult& result);
    void write_result(protocols::TrialId trial, const protocols::TrialResult& result);

    Database& database_;
    const protocols::Protocol& protocol_;
    std::int64_t session_;
    TrialDevice device_;
    bool ticks_;
    protocols::TrialId running_ = 0;  ///< 0: none
    std::int64_t interval_ = 0;       ///< of the running trial, 0: none yet
    TraceWriter trace_;
    Reserve reserve_;
};

}  // namespace palpate::data
