#pragma once

#include <utility>

namespace palpate::protocols {

/// What the experimenter asked for with the keys of the desk while a session runs, until the session
/// heeds it. Screen and session share it on one thread.
class OperatorDesk {
public:
    /// The running trial, or the last one where none is, shall not count.
    void mark() noexcept { mark_ = true; }
    /// Wait before the next trial; asked for again: go on, or do not wait after all.
    void pause() noexcept { pause_ = !pause_; }

    [[nodiscard]] bool wants() const noexcept { return mark_ || pause_; }
    [[nodiscard]] bool wants_pause() const noexcept { return pause_; }
    [[nodiscard]] bool take_mark() noexcept { return std::exchange(mark_, false); }
    [[nodiscard]] bool take_pause() noexcept { return std::exchange(pause_, false); }

private:
    bool mark_ = false;
    bool pause_ = false;
};

/// The reason that a mark at the desk leaves with a trial.
inline constexpr const char* kMarkedAtDesk = "marked by the experimenter while the session ran";

}  // namespace palpate::protocols
