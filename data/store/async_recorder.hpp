#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <queue>
#include <thread>

#include "protocols/running/recorder.hpp"

namespace palpate::data {

/// Writes on a thread of its own, so that a slow disk never holds up a screen or a key press.
///
/// append() only hands the ticks over. Every other call waits until all before it is stored, and then
/// for itself. What fails on the thread is thrown by the next call and by every one after it: from the
/// error on nothing is stored, so that nothing can stand behind a hole.
class AsyncRecorder : public protocols::Recorder {
public:
    /// @param recorder  outlives this one; used by its thread alone
    explicit AsyncRecorder(protocols::Recorder& recorder);
    /// Stores what was handed over; an error that nobody heard of is lost with this object.
    ~AsyncRecorder() override;

    [[nodiscard]] protocols::TrialId begin_trial(const protocols::PlannedTrial& planned,
                                                 const protocols::SceneConstants& scene) override;
    void append(protocols::TrialId trial, std::span<const engine::TickRecord> ticks) override;
    void end_trial(protocols::TrialId trial, const protocols::TrialResult& result) override;
    void event(std::string_view kind, std::string_view text) override;
    void mark(protocols::TrialId trial, std::string_view reason) override;
    void finish_session() override;

private:
    void hand_over(std::function<void()> work);
    void wait_for(std::function<void()> work);
    void run();

    protocols::Recorder& recorder_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::queue<std::function<void()>> work_;
    std::exception_ptr error_;
    bool busy_ = false;
    bool quit_ = false;
    std::thread thread_;
};

}  // namespace palpate::data
