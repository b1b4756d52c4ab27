#pragma once

#include <vector>

#include "protocols/design/protocol.hpp"
#include "protocols/running/recorder.hpp"
#include "data/store/database.hpp"
#include "data/trace/codec.hpp"

namespace palpate::data {

/// Writes a running session. Every commit is synced: what a call has stored survives a power cut.
///
/// append() collects ticks into chunks of kChunkTicks and commits each full one, so that chunk k holds
/// ticks 256 k to 256 k + 255 whatever the pace; end_trial() commits the rest with the result.
///
/// After an error in append() the trial takes no more ticks, so that a stored trace may end early but
/// never has a hole. Results need a trial that runs: an answer that went nowhere would go unnoticed.
/// @throws StoreError, and std::logic_error for a call that breaks the order begin, append, end
class SqliteRecorder : public protocols::Recorder {
public:
    /// @param database, protocol  outlive the recorder
    SqliteRecorder(Database& database, const protocols::Protocol& protocol, std::int64_t session);

    [[nodiscard]] protocols::TrialId begin_trial(const protocols::PlannedTrial& planned,
                                                 const protocols::SceneConstants& scene) override;
    void append(protocols::TrialId trial, std::span<const engine::TickRecord> ticks) override;
    void end_trial(protocols::TrialId trial, const protocols::TrialResult& result) override;
    void event(std::string_view kind, std::string_view text) override;
    void mark(protocols::TrialId trial, std::string_view reason) override;
    void finish_session() override;

private:
    void require_running(protocols::TrialId trial) const;
    void write_chunk(protocols::TrialId trial);
    void write_result(protocols::TrialId trial, const protocols::TrialResult& result);
    void write_response(protocols::TrialId trial, const protocols::Response& response);
    void write_fault(protocols::TrialId trial, const protocols::Fault& fault);

    Database& database_;
    const protocols::Protocol& protocol_;
    std::int64_t session_;
    protocols::TrialId running_ = 0;  ///< 0: none
    bool cut_ = false;                ///< ticks of the running trial were lost
    std::vector<engine::TickRecord> pending_;
};

}  // namespace palpate::data
