#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "protocols/session/trust.hpp"

namespace palpate::protocols {

/// s of a break until the handle is looked at, and until it is again after it was not right: a hand
/// has to bring it home and let go of it.
inline constexpr double kLetGo = 3.0;

/// While a participant rests, the free handle is proved on a thread of its own, until it is right
/// or the break is over: its place, where encoders that slipped show, then its motors by weak
/// pulses, since none that became stronger or weaker shows while somebody holds the handle. Nobody
/// else uses the apparatus until this is over().
class HandleCheck {
public:
    /// @param apparatus  outlives this; one that has nothing to prove is left alone
    HandleCheck(Apparatus& apparatus, const RigTrust& trust);
    HandleCheck(const HandleCheck&) = delete;
    HandleCheck& operator=(const HandleCheck&) = delete;
    /// Waits for pulses that are under way.
    ~HandleCheck();

    /// The break is over: what was not right is not tried again. It is tried once all the same.
    void finish() noexcept { resting_.store(false); }
    [[nodiscard]] bool over() const noexcept { return over_.load(); }
    /// After over(): what was proved; and what not at last, empty: nothing.
    [[nodiscard]] const std::vector<Event>& proved() const noexcept { return proved_; }
    [[nodiscard]] const std::string& refused() const noexcept { return refused_; }

private:
    void live();
    void prove();

    Apparatus& apparatus_;
    RigTrust trust_;
    std::atomic<bool> resting_{true};
    std::atomic<bool> over_{false};
    std::vector<Event> proved_;
    std::string refused_;
    std::thread thread_;
};

}  // namespace palpate::protocols
