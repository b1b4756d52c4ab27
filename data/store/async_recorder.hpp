#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <queue>
#include <thread>
#include <vector>

#include "protocols/session/recorder.hpp"

namespace palpate::data {

/// Writes on a thread of its own, so that a slow disk never holds up a screen or a key press.
///
/// append() only hands the ticks over; what was handed over is saved within `save_every` of the
/// oldest, and again as often while a lock of another program keeps it back. Every other call waits
/// until all before it is stored, and then for itself. What fails on the thread is thrown by the
/// next call and by every one after it: from the error on nothing is stored, so that nothing can
/// stand behind a hole.
class AsyncRecorder : public protocols::Recorder {
public:
    /// Ticks come to append() up to a frame of a screen after they were made, a commit takes some
    /// 15 ms: together this stays below 120 ms.
    static constexpr std::chrono::milliseconds kSaveEvery{75};
    /// Together below 45 ms.
    static constexpr std::chrono::milliseconds kSaveOften{10};

    /// @param recorder  outlives this one; used by its thread alone
    explicit AsyncRecorder(protocols::Recorder& recorder,
                           std::chrono::milliseconds save_every = kSaveEvery);
    /// Stores what was handed over; an error that nobody heard of is lost with this object.
    ~AsyncRecorder() override;

    [[nodiscard]] protocols::TrialId begin_trial(const protocols::PlannedTrial& planned) override;
    void begin_interval(protocols::TrialId trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene) override;
    void append(protocols::TrialId trial, std::span<const engine::TickRecord> ticks) override;
    bool save() override;
    void end_trial(protocols::TrialId trial, const protocols::TrialResult& result) override {
        wait_for([&] { recorder_.end_trial(trial, result); });
    }
    /// It happens now, however long a lock of another program keeps it back.
    void event(const protocols::Event& event) override {
        wait_for([&, now = dated(event)] { recorder_.event(now); });
    }
    void finish_session() override {
        wait_for([&] { recorder_.finish_session(); });
    }

    /// Waits for nothing, so that it may be called while something is felt.
    /// @param stored  on the recorder's thread, once it is durable; never, if it cannot be stored
    void event_soon(protocols::Event event, std::function<void()> stored);

private:
    [[nodiscard]] static protocols::Event dated(protocols::Event event);
    /// With the lock: the ticks that append() gathered become work.
    void queue_ticks();
    void wait_for(std::function<void()> work);
    void run();

    /// Until what has to be done next is known. @return false: nothing more comes
    bool wait_for_work(std::unique_lock<std::mutex>& lock);
    void save_now();

    protocols::Recorder& recorder_;
    std::chrono::milliseconds save_every_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::queue<std::function<void()>> work_;
    std::vector<engine::TickRecord> ticks_;  ///< of trial_, not yet among work_
    protocols::TrialId trial_ = 0;
    std::size_t waiting_ticks_ = 0;  ///< those among work_ too
    /// When what was appended has to be saved; nothing: all of it is.
    std::optional<std::chrono::steady_clock::time_point> due_;
    std::exception_ptr error_;
    bool busy_ = false;
    bool quit_ = false;
    std::thread thread_;
};

}  // namespace palpate::data
