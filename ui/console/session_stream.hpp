#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "data/store/database.hpp"
#include "ui/console/page_server.hpp"
#include "ui/live/live_segment.hpp"

namespace palpate::ui {

/// What all pages of one session share: the session, and what its file and its disk say beside.
class WatchedSession {
public:
    /// @param acts  its pages may act
    WatchedSession(RunningSession session, bool acts);

    [[nodiscard]] const RunningSession& session() const noexcept { return session_; }
    /// The state as the page takes it; empty: none could be read. Any thread.
    /// @param shown  with what is felt, once that was revealed
    [[nodiscard]] std::string state(bool shown);
    /// The process is there. Any thread.
    [[nodiscard]] bool alive() const { return session_.alive(); }
    /// Hands a line of the page on to the session. @return its answer
    /// @param gone  whoever asked: no force is all that is still done then
    [[nodiscard]] std::string ask(const std::string& line, bool gone) const;

private:
    void look_beside();

    RunningSession session_;
    bool acts_;
    std::mutex mutex_;
    std::unique_ptr<data::Database> database_;
    std::int64_t looked_ns_ = 0;
    std::string seal_;
    double disk_free_mb_ = 0.0;
    std::int64_t written_ms_ = -1;  ///< since something was; < 0: not known
};

/// Events of a session for one page: "state" at each change and at least once a second, "live"
/// with the newest tick, but for a still one. A page that did not ask for it shows nothing of what
/// another one revealed. Ends with the session's process.
class SessionStream : public EventSource {
public:
    SessionStream(std::shared_ptr<WatchedSession> watched, bool shown, bool still)
        : watched_(std::move(watched)), shown_(shown), still_(still) {}
    [[nodiscard]] std::string next() override;
    [[nodiscard]] bool over() const override { return !alive_; }

private:
    [[nodiscard]] std::string live();

    std::shared_ptr<WatchedSession> watched_;
    bool shown_;
    bool still_;
    std::uint64_t version_ = 1;  ///< odd: of no state
    std::uint64_t ticks_ = 0;
    std::int64_t said_ns_ = 0;
    bool alive_ = true;
};

}  // namespace palpate::ui
