#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "protocols/session/progress.hpp"
#include "protocols/trial/apparatus.hpp"

namespace palpate::protocols {

/// What is proved of a rig that gives force to a hand, at this moment. Each state has all before
/// it.
enum class Trust : std::uint8_t {
    unknown,  ///< nothing: it was not looked at yet, or it went away
    answers,  ///< it answers; where its handle is and what its motors do is not known
    at_home,  ///< its handle was where its encoders say
    proved,   ///< and weak pulses moved it as when it was commissioned: it may give force
};

/// Attempts after which a proof is too old, where no break renews it before.
inline constexpr std::size_t kMaxTrialsOfAProof = 30;

/// The keys of what was proved at an opening, in breaks and after faults, and what is said of the
/// pulses then.
inline constexpr std::string_view kStartPose = "start pose";
inline constexpr std::string_view kRigCheck = "rig check";
inline constexpr std::string_view kHandleMoves =
    "weak pulses moved the free handle as when it was commissioned";
/// The key of which board it is: Apparatus::identity().
inline constexpr std::string_view kBoard = "board";
/// The value of both proofs that proves nothing.
inline constexpr std::string_view kRefused = "refused";
/// The same of pulses in a trouble: they are tried again where the handle is.
inline constexpr std::string_view kRefusedInTrouble = "refused in trouble";
/// The value of a reconnection after which the rig may be another one.
inline constexpr std::string_view kAnew = "anew";
/// s of trouble after which somebody may have changed the rig, whatever the cause was.
inline constexpr double kLongTrouble = 10.0;

/// Trust as it follows from attempts and events alone, in their order. Opening, break, pause,
/// fault, reconnection and proof go through it. Whatever could have changed the rig takes trust
/// away: a device that went away all of it, one that began anew, a fault that a motor or an encoder
/// may have caused, a rest, a stop and a long trouble all but that it answers. Any other fault of
/// people, screen or program leaves it.
struct RigTrust {
    Trust state = Trust::unknown;
    std::size_t trials = 0;  ///< attempts since it was proved
    bool place_old = false;  ///< pulses were refused since: who mends a motor may move an encoder
    bool by_hand = false;    ///< it may be another one, and nobody has said to go on since

    /// A trial may give force: proved, and nobody has to say to go on first.
    [[nodiscard]] bool gives_force() const noexcept { return state == Trust::proved && !by_hand; }

    friend bool operator==(const RigTrust&, const RigTrust&) = default;
};
/// Trust after the next attempt or event.
[[nodiscard]] RigTrust apply(RigTrust trust, const Attempt& attempt) noexcept;
[[nodiscard]] RigTrust apply(RigTrust trust, const Event& event) noexcept;

/// What a step towards a proof came to: one of both is there.
struct ProofStep {
    std::optional<Event> event;  ///< what brings trust one state on
    std::string refused;         ///< why it is no further, a sentence with the remedy
};

/// Between trials: from `state`, which is not proved, tries to reach the next one. Takes some
/// seconds at most.
[[nodiscard]] ProofStep prove_step(Apparatus& apparatus, Trust state);

/// What is kept of a proof that was refused: why, and how many attempts nobody can vouch for.
[[nodiscard]] Event refused_proof(const RigTrust& trust,
                                  const std::string& why,
                                  std::string_view value = kRefused);

/// After a reconnection, which may be of another board. @param board  as it was; becomes what it is
[[nodiscard]] std::optional<Event> other_board(const Event& event,
                                               const Apparatus& apparatus,
                                               std::string& board);

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
