#include "ui/live/live_board.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "engine/base/clock.hpp"
#include "engine/safety/trip.hpp"
#include "protocols/design/object_outline.hpp"
#include "data/store/database.hpp"
#include "ui/live/live_text.hpp"
#include "ui/rig/operator_log.hpp"

namespace palpate::ui {
namespace {

constexpr double kShownRate = 125;  ///< ticks a second
/// A running exploration is shown so often.
constexpr std::int64_t kShowEvery = 500 * kMillisecond;
constexpr std::size_t kNewest = 100;  ///< lines of a list, and notes; answers are all shown

template <class List>
void keep_newest(List& list) {
    if (list.size() > kNewest) {
        list.erase(list.begin());
    }
}

/// What cannot be shown is not shown, and the session goes on.
template <class Work>
void unless_no_memory(const Work& work) noexcept {
    try {
        work();
    } catch (const std::exception&) {  // no memory
    }
}

std::string_view word_of(LivePhase phase) noexcept {
    constexpr std::array<std::string_view, 10> kWords{"welcome",  "ready", "explore", "question",
                                                      "feedback", "gap",   "break",   "pause",
                                                      "trouble",  "ended"};
    return kWords.at(static_cast<std::size_t>(phase));
}

}  // namespace

LiveBoard::LiveBoard(LiveFacts facts,
                     const protocols::Protocol& protocol,
                     const protocols::Plan& plan,
                     const protocols::OperatorDesk& desk)
    : facts_(std::move(facts)),
      protocol_(protocol),
      plan_(plan),
      desk_(desk),
      phase_ns_(monotonic_ns()),
      per_shown_(static_cast<std::size_t>(
          std::max(1.0, std::round(protocol.apparatus.rate_hz / kShownRate)))) {
    show();
}

void LiveBoard::enter(LivePhase phase, const protocols::TrialView* trial) noexcept {
    const protocols::TrialNumber number =
        trial == nullptr ? trial_
                         : protocols::TrialNumber{trial->practice, trial->number, trial->total};
    const std::size_t interval = trial == nullptr ? interval_ : trial->interval;
    if (phase == phase_ && number == trial_ && interval == interval_) {
        return;
    }
    phase_ = phase;
    trial_ = number;
    interval_ = interval;
    phase_ns_ = monotonic_ns();
    if (phase == LivePhase::explore && interval == 1) {
        late_trial_ = {};
    }
    show();
}

void LiveBoard::enter(const protocols::TroubleView& trouble) noexcept {
    unless_no_memory([&] {
        if (phase_ != LivePhase::trouble || trouble.sentence != trouble_.sentence ||
            trouble.solved != trouble_.solved) {
            trouble_ = trouble;
            phase_ns_ = phase_ == LivePhase::trouble ? phase_ns_ : monotonic_ns();
            phase_ = LivePhase::trouble;
            show();
        }
    });
}

void LiveBoard::end(std::string_view how) noexcept {
    unless_no_memory([&] { ended_ = how; });
    phase_ = LivePhase::ended;
    phase_ns_ = monotonic_ns();
    show();
}

void LiveBoard::feels(const protocols::Presentation& felt) noexcept {
    unless_no_memory([&] {
        felt_ = felt;
        draw_outline();
    });
}

/// As it is felt: a rule may have changed its curvature.
void LiveBoard::draw_outline() {
    outline_.clear();
    const auto at = std::ranges::find(protocol_.objects, felt_ ? felt_->object.name : "",
                                      &protocols::ObjectSpec::name);
    if (revealed_ && at != protocol_.objects.end()) {
        const auto object = static_cast<std::size_t>(at - protocol_.objects.begin());
        protocols::Protocol felt = protocol_;
        felt.objects[object] = felt_->object;
        outline_ = protocols::silhouette_of(felt, object);
    }
}

void LiveBoard::feel(std::span<const engine::TickRecord> ticks) noexcept {
    for (const engine::TickRecord& tick : ticks) {
        const auto bin = static_cast<std::size_t>(
            std::ranges::upper_bound(kEdges, double{tick.lateness_us}) - kEdges.begin());
        ++late_trial_[bin];
        ++late_session_[bin];
        ++ticks_;
        stale_ += (tick.flags & engine::tick_stale) != 0 ? 1U : 0U;
        if (fed_++ % per_shown_ == 0) {
            show(tick);
        }
    }
    if (monotonic_ns() - shown_ns_ > kShowEvery) {
        show();
    }
}

void LiveBoard::show(const engine::TickRecord& tick) noexcept {
    const auto plane = [](const engine::Vec3& at) {
        return std::array{static_cast<float>(at.x), static_cast<float>(at.y)};
    };
    LiveTick shown{.t_s = static_cast<double>(tick.time_ns) * 1e-9,
                   .late_us = tick.lateness_us,
                   .force_on = facts_.gives_force && (tick.flags & engine::tick_fault) == 0};
    if (revealed_) {
        const double seconds = static_cast<double>(tick.time_ns - last_.time_ns) * 1e-9;
        shown.hip = plane(tick.hip);
        shown.go = plane(tick.go);
        shown.cp = plane(tick.cp);
        shown.force = plane(tick.force);
        shown.normal = static_cast<float>(tick.normal_force);
        shown.tangential = static_cast<float>(tick.tangential_force);
        shown.speed =
            seconds > 0.0 ? static_cast<float>(glm::length(tick.hip - last_.hip) / seconds) : 0.0F;
        shown.felt = true;
        shown.mode = static_cast<std::uint8_t>(tick.mode);
    }
    last_ = tick;
    writer_.show(shown);
}

void LiveBoard::attempted(const protocols::Progress& progress,
                          std::optional<double> minutes,
                          bool alarm) noexcept {
    unless_no_memory([&] {
        const protocols::TrialResult& result = progress.result;
        facts_.answered = progress.known.pending().answered();
        facts_.left = progress.left();
        minutes_ = minutes;
        alarm_ = alarm;
        const std::size_t number = progress.number.number;
        const std::string of = progress.number.practice ? "practice: " : "";
        if (result.fault) {
            faults_.push_back({number, of + std::string(to_string(result.fault->cause)),
                               result.fault->text.empty()
                                   ? std::string(explanation(result.fault->cause))
                                   : result.fault->text});
        } else if (!result.invalid.empty() || !result.response) {
            not_counting_.push_back(
                {number, of + (result.invalid.empty() ? std::string(to_string(result.outcome))
                                                      : result.invalid)});
        }
        if (result.response) {
            const auto& given = *result.response;
            const protocols::Condition& condition = progress.planned.condition;
            answers_.push_back({number, protocol_.objects.at(condition.object).name,
                                protocol_.frictions.at(condition.friction).name,
                                given.object ? protocol_.objects.at(*given.object).name
                                             : fmt::format("{}", given.place + 1),
                                given.correct});
        }
        keep_newest(faults_);
        keep_newest(not_counting_);
        show();
    });
}

void LiveBoard::marked(const protocols::MarkReply& reply, const std::string& reason) noexcept {
    unless_no_memory([&] {
        if (reply.found) {
            facts_.answered -= std::min<std::size_t>(1, facts_.answered);
            facts_.left += reply.runs_again ? 1U : 0U;
            not_counting_.push_back(
                {reply.number.number,
                 fmt::format("{}marked{}{}", reply.number.practice ? "practice: " : "",
                             reason.empty() ? "" : ": ", reason)});
            keep_newest(not_counting_);
            show();
        }
    });
}

void LiveBoard::noted(const std::string& text) noexcept {
    unless_no_memory([&] {
        const bool in_trial = phase_ == LivePhase::explore || phase_ == LivePhase::question;
        notes_.push_back(
            {data::utc_now(), in_trial ? std::optional(trial_.number) : std::nullopt, text});
        keep_newest(notes_);
        show();
    });
}

void LiveBoard::reveal() noexcept {
    revealed_ = true;
    unless_no_memory([&] { draw_outline(); });
    show();
}

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
                           {"round_trip_us", nullptr},
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

void LiveBoard::show() noexcept {
    shown_ns_ = monotonic_ns();
    unless_no_memory([&] { writer_.show(Text(*this).text(), phase_ns_); });
}

}  // namespace palpate::ui
