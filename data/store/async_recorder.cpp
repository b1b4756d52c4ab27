#include "data/store/async_recorder.hpp"

#include <utility>

#include "engine/base/clock.hpp"

namespace palpate::data {

/// Ticks that may wait for the thread: minutes at any rate. Only a simulation faster than the disk
/// gets there.
constexpr std::size_t kMaxWaiting = std::size_t{1} << 18U;
/// Ticks that are worth waking the thread before they have to be saved.
constexpr std::size_t kBatch = 512;

AsyncRecorder::AsyncRecorder(protocols::Recorder& recorder, std::chrono::milliseconds save_every)
    : recorder_(recorder), save_every_(save_every), thread_([this] { run(); }) {}

AsyncRecorder::~AsyncRecorder() {
    {
        const std::scoped_lock lock(mutex_);
        quit_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

bool AsyncRecorder::wait_for_work(std::unique_lock<std::mutex>& lock) {
    const auto there = [this] {
        return quit_ || !work_.empty();
    };
    if (due_ && !error_) {
        changed_.wait_until(lock, *due_, there);
    } else {
        changed_.wait(lock, [this, &there] { return there() || (due_ && !error_); });
    }
    const bool save =
        due_ && !error_ && (std::chrono::steady_clock::now() >= *due_ || (quit_ && work_.empty()));
    if (save) {
        due_.reset();
        queue_ticks();
        work_.emplace([this] { save_now(); });
    }
    return !work_.empty();
}

void AsyncRecorder::save_now() {
    if (!recorder_.save()) {
        const std::scoped_lock lock(mutex_);
        if (!quit_) {
            due_ = std::chrono::steady_clock::now() + save_every_;
        }
    }
}

void AsyncRecorder::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        if (!wait_for_work(lock)) {
            if (quit_) {
                return;
            }
            continue;
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
            ticks_.clear();
            waiting_ticks_ = 0;
        }
        changed_.notify_all();
    }
}

void AsyncRecorder::queue_ticks() {
    if (ticks_.empty()) {
        return;
    }
    work_.emplace([this, trial = trial_, ticks = std::exchange(ticks_, {})] {
        recorder_.append(trial, ticks);
        const std::scoped_lock lock(mutex_);
        waiting_ticks_ -= ticks.size();
    });
}

void AsyncRecorder::wait_for(std::function<void()> work) {
    std::unique_lock lock(mutex_);
    if (!error_) {
        queue_ticks();
        work_.push(std::move(work));
        changed_.notify_all();
        changed_.wait(lock, [this] { return error_ || (work_.empty() && !busy_); });
    }
    if (error_) {
        std::rethrow_exception(error_);
    }
}

protocols::TrialId AsyncRecorder::begin_trial(const protocols::PlannedTrial& planned) {
    protocols::TrialId id = 0;
    wait_for([&] { id = recorder_.begin_trial(planned); });
    return id;
}

void AsyncRecorder::begin_interval(protocols::TrialId trial,
                                   const protocols::Presentation& felt,
                                   const protocols::SceneConstants& scene) {
    wait_for([&] { recorder_.begin_interval(trial, felt, scene); });
}

void AsyncRecorder::append(protocols::TrialId trial, std::span<const engine::TickRecord> ticks) {
    const auto now = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return error_ || waiting_ticks_ < kMaxWaiting; });
    if (error_) {
        std::rethrow_exception(error_);
    }
    if (trial != trial_) {
        queue_ticks();
        trial_ = trial;
    }
    ticks_.insert(ticks_.end(), ticks.begin(), ticks.end());
    waiting_ticks_ += ticks.size();
    const bool first = !due_;
    due_ = due_.value_or(now + save_every_);
    if (ticks_.size() >= kBatch) {
        queue_ticks();
    }
    if (first || !work_.empty()) {
        changed_.notify_all();
    }
}

bool AsyncRecorder::save() {
    bool saved = false;
    wait_for([&] { saved = recorder_.save(); });
    return saved;
}

protocols::Event AsyncRecorder::dated(protocols::Event event) {
    event.when_ns = event.when_ns == 0 ? monotonic_ns() : event.when_ns;
    return event;
}

void AsyncRecorder::event_soon(protocols::Event event, std::function<void()> stored) {
    const std::scoped_lock lock(mutex_);
    if (!error_) {
        queue_ticks();
        work_.emplace([this, event = dated(std::move(event)), stored = std::move(stored)] {
            recorder_.event(event);
            stored();
        });
        changed_.notify_all();
    }
}

}  // namespace palpate::data
