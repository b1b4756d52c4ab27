#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ui/live/live_board.hpp"
#include "ui/live/live_text.hpp"
#include "ui/rig/operator_log.hpp"

namespace palpate::ui {
namespace {

std::string_view word_of(LivePhase phase) noexcept {
    constexpr std::array<std::string_view, 10> kWords{"welcome",  "ready", "explore", "question",
                                                      "feedback", "gap",   "break",   "pause",
                                                      "trouble",  "ended"};
    return kWords.at(static_cast<std::size_t>(phase));
}

}  // namespace

/// The board as JSON.
class LiveBoard::Text {
public:
    explicit Text(const LiveBoard& board) : board_(board) {}

    [[nodiscard]] std::string text() const {
        const LiveFacts& facts = board_.facts_;
        const protocols::Protocol& protocol = board_.protocol_;
        data::Json state{{"session", facts.uuid},
                         {"kind", facts.kind},
                         {"participant", facts.participant},
                         {"number", facts.number},
                         {"protocol", protocol.id},
                         {"title", protocol.title},
                         {"phase", word_of(board_.phase_)},
                         {"sentence", sentence()},
                         {"trial", board_.trial_.number},
                         {"trials", board_.trial_.total},
                         {"practice", board_.trial_.practice},
                         {"remaining", facts.left},
                         {"remaining_min", json_or_null(board_.minutes_)},
                         {"next_break_in", json_or_null(next_break())},
                         {"answered", facts.answered},
                         {"alarm", board_.alarm_},
                         {"pausing", board_.wishes_.first},
                         {"force", {{"on", force_on()}, {"why", why()}}},
                         {"reveal", protocol.reveal == protocols::Reveal::never ? "never"
                                    : board_.revealed_                          ? "shown"
                                                                                : "ask"},
                         {"ended", json_or_null(board_.ended_)}};
        add_device(state);
        add_lists(state);
        if (board_.revealed_) {
            state["hidden"] = hidden();
        }
        return one_line(state);
    }

private:
    void add_device(data::Json& state) const {
        const LiveFacts& facts = board_.facts_;
        // Whoever lets go ends the exploration.
        const auto dead_man = board_.protocol_.safety.dead_man && facts.gives_force
                                ? std::optional(board_.phase_ == LivePhase::explore)
                                : std::nullopt;
        state["device"] = {{"name", facts.device},
                           {"calibration", json_or_null(facts.calibration)},
                           {"round_trip_us", json_or_null(facts.round_trip_us)},
                           {"check", json_or_null(facts.check)},
                           {"guard", json_or_null(facts.guard)},
                           {"dead_man", json_or_null(dead_man)}};
        const bool noise = board_.phase_ == LivePhase::ready || board_.phase_ == LivePhase::explore;
        state["masking"] = facts.masking_db
                             ? data::Json{{"on", noise}, {"level_db", *facts.masking_db}}
                             : data::Json(nullptr);
        state["late"] = {
            {"edges_us", kEdges},
            {"trial", board_.late_trial_},
            {"session", board_.late_session_},
            {"stale_share", static_cast<double>(board_.stale_) /
                                static_cast<double>(std::max<std::uint64_t>(1, board_.ticks_))}};
    }

    void add_lists(data::Json& state) const {
        data::Json& lost = state["not_counting"] = data::Json::array();
        for (const Line& line : board_.not_counting_) {
            lost.push_back({{"trial", line.trial}, {"why", line.what}});
        }
        data::Json& faults = state["faults"] = data::Json::array();
        for (const Line& line : board_.faults_) {
            faults.push_back(
                {{"trial", line.trial}, {"cause", line.what}, {"advice", line.advice}});
        }
        data::Json& notes = state["notes"] = data::Json::array();
        for (const Note& note : board_.notes_) {
            notes.push_back(
                {{"at", note.at}, {"trial", json_or_null(note.trial)}, {"text", note.text}});
        }
    }

    [[nodiscard]] data::Json hidden() const {
        data::Json hidden;
        if (board_.felt_) {
            const protocols::Presentation& felt = *board_.felt_;
            hidden = {{"object", felt.object.name},
                      {"friction", felt.friction.name},
                      {"level", json_or_null(felt.stimulus)},
                      {"outline", data::Json::array()}};
            for (const engine::Vec2& point : board_.outline_) {
                hidden["outline"].push_back({point.x, point.y});
            }
        }
        data::Json& answers = hidden["answers"] = data::Json::array();
        for (const Answer& answer : board_.answers_) {
            answers.push_back({{"trial", answer.trial},
                               {"object", answer.object},
                               {"friction", answer.friction},
                               {"answer", answer.answer},
                               {"correct", json_or_null(answer.correct)}});
        }
        return hidden;
    }

    [[nodiscard]] std::string sentence() const {
        const std::string number = number_text(board_.trial_);
        switch (board_.phase_) {
            case LivePhase::welcome:
                return "the participant reads the instructions";
            case LivePhase::ready:
                return fmt::format("waiting for the participant to begin {}", number);
            case LivePhase::explore:
                return fmt::format("exploring, {}", number);
            case LivePhase::question:
                return fmt::format("asked, {}", number);
            case LivePhase::feedback:
                return fmt::format("hears whether it was right, {}", number);
            case LivePhase::gap:
                return fmt::format("between trials, after {}", number);
            case LivePhase::rest:
                return fmt::format("a break before {}", number);
            case LivePhase::pause:
                return fmt::format("paused by the experimenter before {}", number);
            case LivePhase::trouble:
                return board_.trouble_.sentence;
            case LivePhase::ended:
                return "the session is over: " + board_.ended_;
        }
        return {};
    }

    [[nodiscard]] bool force_on() const {
        return board_.phase_ == LivePhase::explore && board_.facts_.gives_force &&
               !board_.desk_.wants_stop();
    }
    [[nodiscard]] std::string why() const {
        const char* barred = board_.desk_.barred();
        return !board_.facts_.gives_force          ? "this device gives no force"
             : barred != nullptr                   ? barred
             : board_.desk_.wants_stop()           ? "stopped"
             : board_.phase_ == LivePhase::trouble ? board_.trouble_.sentence
             : board_.phase_ == LivePhase::explore ? "exploring"
                                                   : "nothing is felt now";
    }

    [[nodiscard]] std::optional<std::size_t> next_break() const {
        const auto& trials = board_.plan_.trials;
        for (std::size_t k = 1; board_.facts_.answered + k < trials.size(); ++k) {
            if (trials[board_.facts_.answered + k].break_before) {
                return k;
            }
        }
        return std::nullopt;
    }

    const LiveBoard& board_;
};

std::string LiveBoard::text() const {
    return Text(*this).text();
}

}  // namespace palpate::ui
