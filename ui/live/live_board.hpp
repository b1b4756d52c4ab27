#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/realtime/tick_record.hpp"
#include "protocols/session/operator_desk.hpp"
#include "protocols/session/ports.hpp"
#include "protocols/trial/observer_beside.hpp"
#include "protocols/trial/presentation.hpp"
#include "data/csv/json_text.hpp"
#include "ui/live/live_segment.hpp"

namespace palpate::ui {

/// What is known of a session before it runs.
struct LiveFacts {
    std::string uuid{};
    std::string file{};     ///< the database
    std::string session{};  ///< JSON as it is shown: "session", "participant", "title", ...
    std::string device{};   ///< the same: "name", "calibration", "check" of the rig, ...
    std::string operator_name{};
    bool gives_force = false;
    bool screen = false;                 ///< a person sits at one
    std::optional<double> masking_db{};  ///< none: no noise is played
    std::size_t answered = 0;
    std::size_t left = 0;
};

/// A session as it is shown: blind until reveal(), which means that nothing of what is felt or
/// answered is handed to another program before. One thread; throws nothing and waits for nobody.
class LiveBoard {
public:
    /// All outlive the board.
    LiveBoard(LiveFacts facts,
              const protocols::Protocol& protocol,
              const protocols::Plan& plan,
              const protocols::OperatorDesk& desk);

    [[nodiscard]] const LiveFacts& facts() const noexcept { return facts_; }
    [[nodiscard]] const protocols::Protocol& protocol() const noexcept { return protocol_; }
    [[nodiscard]] int descriptor() const noexcept { return writer_.descriptor(); }
    [[nodiscard]] protocols::SessionStep phase() const noexcept { return phase_; }
    [[nodiscard]] bool revealed() const noexcept { return revealed_; }
    /// As it is shown.
    [[nodiscard]] const protocols::TrialNumber& trial() const noexcept { return trial_; }

    /// Where the session is; shown if that is new.
    void enter(protocols::SessionStep phase, const protocols::TrialView* trial = nullptr) noexcept;
    void enter(const protocols::TroubleView& trouble) noexcept;
    void end(std::string_view how) noexcept;
    /// What the running interval lets one feel.
    void feels(const protocols::Presentation& felt) noexcept;
    void feel(std::span<const engine::TickRecord> ticks) noexcept;
    /// @param minutes  until the end at this person's pace; none: not known yet
    void attempted(const protocols::Progress& progress,
                   std::optional<double> minutes,
                   bool alarm) noexcept;
    void marked(const protocols::MarkReply& reply, bool alarm) noexcept;
    /// @param trial  that the note is kept with; none: with none
    void noted(const std::string& text,
               const std::optional<protocols::TrialNumber>& trial = {}) noexcept;
    /// What a mark is of from here on: the running trial, or the last one.
    struct Markable {
        protocols::TrialId id = 0;
        protocols::TrialNumber number{};
    };
    [[nodiscard]] const std::optional<Markable>& markable() const noexcept { return markable_; }
    /// trial() was begun, and is over.
    void began(protocols::TrialId trial) noexcept {
        markable_ = {.id = trial, .number = trial_};
        running_ = trial;
    }
    void over() noexcept { running_.reset(); }
    [[nodiscard]] std::optional<protocols::TrialId> running() const noexcept { return running_; }
    /// The rig was proved again, or was refused.
    void checked(const std::string& found) noexcept;
    void reveal() noexcept;
    /// Shows what became another wish at the desk, and that the session answers.
    void look() noexcept {
        writer_.answers();
        if (wishes() != wishes_) {
            show();
        }
    }

private:
    static constexpr std::array<double, 8> kEdges{5, 10, 20, 50, 100, 200, 500, 1000};
    using Bins = std::array<std::uint64_t, kEdges.size() + 1>;
    struct Shown;  ///< as it is shown

    /// All of it as JSON, in one line.
    [[nodiscard]] std::string text() const;
    void add_device(data::Json& state) const;
    void add_hidden(data::Json& state) const;
    [[nodiscard]] std::string sentence() const;
    [[nodiscard]] std::string why() const;
    [[nodiscard]] std::optional<std::size_t> next_break() const;
    [[nodiscard]] std::array<bool, 3> wishes() const noexcept {
        return {desk_.wants_pause(), desk_.wants_stop(), desk_.force_doubted()};
    }
    void show() noexcept;
    void draw_outline();
    [[nodiscard]] bool forget_half();
    void add_not_counting(const protocols::TrialNumber& trial, const std::string& why);
    void show(const engine::TickRecord& tick) noexcept;

    LiveFacts facts_;
    const protocols::Protocol& protocol_;
    const protocols::Plan& plan_;
    const protocols::OperatorDesk& desk_;
    LiveWriter writer_;
    protocols::SessionStep phase_ = protocols::SessionStep::welcome;
    std::int64_t phase_ns_ = 0;
    std::int64_t shown_ns_ = 0;
    std::array<bool, 3> wishes_{};  ///< a pause, a stop, doubt of the force: as they are shown
    protocols::TrialNumber trial_{};
    std::size_t interval_ = 1;
    bool masked_ = false;  ///< noise is to be heard, where there is any
    std::optional<Markable> markable_{};
    std::optional<protocols::TrialId> running_{};
    protocols::TroubleView trouble_{};
    std::optional<double> minutes_{};
    bool alarm_ = false;
    std::string ended_{};
    Bins late_trial_{};
    Bins late_session_{};
    std::uint64_t ticks_ = 0;
    std::uint64_t stale_ = 0;
    std::size_t per_shown_;      ///< ticks
    engine::TickRecord last_{};  ///< that was shown
    std::shared_ptr<Shown> all_;
    bool revealed_ = false;
    std::optional<protocols::Presentation> felt_{};
    std::vector<engine::Vec2> outline_;  ///< of what is felt, m; nothing before it is revealed
};

}  // namespace palpate::ui
