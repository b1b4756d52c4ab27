#include "data/store/async_recorder.hpp"

#include <utility>
#include <vector>

namespace palpate::data {

AsyncRecorder::AsyncRecorder(protocols::Recorder& recorder)
    : recorder_(recorder), thread_([this] { run(); }) {}

AsyncRecorder::~AsyncRecorder() {
    {
        const std::scoped_lock lock(mutex_);
        quit_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void AsyncRecorder::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return quit_ || !work_.empty(); });
        if (work_.empty()) {
            return;
        }
        const std::function<void()> work = std::move(work_.front());
        work_.pop();
        busy_ = true;
        lock.unlock();
        std::exception_ptr error;
        try {
            work();
        } catch (...) {
            error = std::current_exception();
        }
        lock.lock();
        busy_ = false;
        if (error) {  // a hole in a trace is worse than its end: nothing is stored from here on
            error_ = error;
            work_ = {};
        }
        changed_.notify_all();
    }
}

void AsyncRecorder::hand_over(std::function<void()> work) {
    const std::scoped_lock lock(mutex_);
    if (error_) {
        std::rethrow_exception(error_);
    }
    work_.push(std::move(work));
    changed_.notify_all();
}

void AsyncRecorder::wait_for(std::function<void()> work) {
    hand_over(std::move(work));
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return error_ || (work_.empty() && !busy_); });
    if (error_) {
        std::rethrow_exception(error_);
    }
}

protocols::TrialId AsyncRecorder::begin_trial(const protocols::PlannedTrial& planned,
                                              const protocols::SceneConstants& scene) {
    protocols::TrialId id = 0;
    wait_for([&] { id = recorder_.begin_trial(planned, scene); });
    return id;
}

void AsyncRecorder::append(protocols::TrialId trial, std::span<const engine::TickRecord> ticks) {
    hand_over([this, trial, copy = std::vector<engine::TickRecord>(ticks.begin(), ticks.end())] {
        recorder_.append(trial, copy);
    });
}

void AsyncRecorder::end_trial(protocols::TrialId trial, const protocols::TrialResult& result) {
    wait_for([&] { recorder_.end_trial(trial, result); });
}

void AsyncRecorder::event(std::string_view kind, std::string_view text) {
    wait_for([&] { recorder_.event(kind, text); });
}

void AsyncRecorder::mark(protocols::TrialId trial, std::string_view reason) {
    wait_for([&] { recorder_.mark(trial, reason); });
}

void AsyncRecorder::finish_session() {
    wait_for([&] { recorder_.finish_session(); });
}

}  // namespace palpate::data
