#pragma once

#include <atomic>
#include <optional>
#include <thread>

#include "protocols/trial/apparatus.hpp"

namespace palpate::protocols {

/// s of a break until the first pulses, and until others after those that were not right: a hand has to let
/// go of the handle.
inline constexpr double kLetGo = 3.0;

/// While a participant rests, weak pulses try the handle that nobody holds, on a thread of their own, until
/// they are right or the break is over: a motor that became stronger since the session was opened cannot be
/// told from a hand while somebody holds the handle. Nobody else uses the apparatus until this is over().
class HandleCheck {
public:
    /// @param apparatus  outlives this; one that cannot prove its handle is left alone
    explicit HandleCheck(Apparatus& apparatus);
    HandleCheck(const HandleCheck&) = delete;
    HandleCheck& operator=(const HandleCheck&) = delete;
    /// Waits for pulses that are under way.
    ~HandleCheck();

    /// The break is over: pulses that were not right are not tried again. The first ones are given all the
    /// same.
    void finish() noexcept { resting_.store(false); }
    [[nodiscard]] bool over() const noexcept { return over_.load(); }
    /// After over(): what the last pulses said; none: nothing can be proved.
    [[nodiscard]] const std::optional<engine::ShortForm>& result() const noexcept {
        return result_;
    }

private:
    void live();

    Apparatus& apparatus_;
    std::atomic<bool> resting_{true};
    std::atomic<bool> over_{false};
    std::optional<engine::ShortForm> result_;
    std::thread thread_;
};

}  // namespace palpate::protocols
