#pragma once

#include <cstddef>
#include <optional>
#include <string>

/// `palpate stop` and the session that it stops: a socket in Linux's abstract names, which end with
/// their process, so that nothing is left of a crash. It is named for the database's file system
/// and inode; several sessions on one file have one each.
namespace palpate::ui {

/// The session's side.
class StopCall {
public:
    /// @param database  a file that is there; empty: of none yet, and whoever stops any session
    /// stops this @param label  what a caller hears that it stopped
    StopCall(const std::string& database, std::string label);
    StopCall(const StopCall&) = delete;
    StopCall& operator=(const StopCall&) = delete;
    ~StopCall();

    /// To be polled for reading; -1: all names are taken, nobody can call.
    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    /// Takes one caller. Whoever runs as the same user or as root may stop, and whoever can open
    /// the database for writing: its open file comes with the call. Waits 20 ms at most for one of
    /// another user.
    /// @param stop  called before the caller is answered
    template <class Stop>
    void take(const Stop& stop) {
        const int caller = allowed_caller();
        if (caller >= 0) {
            stop();
            answer(caller);
        }
    }

private:
    [[nodiscard]] int allowed_caller() const noexcept;
    void answer(int caller) const noexcept;

    int descriptor_ = -1;
    std::string label_;
    unsigned long long device_ = 0;
    unsigned long long inode_ = 0;
};

/// What became of those that were asked to stop.
struct StopResult {
    std::size_t sessions = 0;
    std::string labels{};  ///< a line each
    std::size_t refused = 0;
    std::size_t silent = 0;  ///< hang, and did not answer within 2 s
};

/// Stops the sessions that run on a database, or, without one, every session that this user may
/// stop.
[[nodiscard]] StopResult stop_sessions(const std::optional<std::string>& database);

}  // namespace palpate::ui
