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
#include "ui/rig/json_line.hpp"
#include "ui/rig/operator_log.hpp"

namespace palpate::ui {
namespace {

constexpr double kShownRate = 125;  ///< ticks a second
/// A running exploration is shown so often.
constexpr std::int64_t kShowEvery = 500 * kMillisecond;
constexpr std::size_t kNewest = 100;  ///< lines of a list, and notes; answers are all shown

void keep_newest(data::Json& list) {
    if (list.size() > kNewest) {
        list.erase(0);
    }
}

std::string practice_before(const protocols::TrialNumber& trial, std::string_view text) {
    return fmt::format("{}{}", trial.practice ? "practice: " : "", text);
}

/// What cannot be shown is not shown, and the session goes on.
template <class Work>
void unless_no_memory(const Work& work) noexcept {
    try {
        work();
    } catch (const std::exception&) {  // no memory
    }
}

/// Its word, and its sentence, which ends with the trial's number after a space.
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kPhases{{
    {"welcome", "the participant reads the instructions"},
    {"ready", "waiting for the participant to begin "},
    {"explore", "exploring, "},
    {"question", "asked, "},
    {"feedback", "hears whether it was right, "},
    {"gap", "between trials, after "},
    {"break", "a break before "},
    {"pause", "paused by the experimenter before "},
    {"trouble", ""},
    {"ended", "the session is over:"},
}};

}  // namespace

struct LiveBoard::Lists {
    data::Json not_counting = data::Json::array();
    data::Json faults = data::Json::array();
    data::Json notes = data::Json::array();
    data::Json answers = data::Json::array();  ///< for nobody before they are revealed
};

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
                         {"phase", kPhases.at(static_cast<std::size_t>(board_.phase_)).first},
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
        state["not_counting"] = board_.lists_->not_counting;
        state["faults"] = board_.lists_->faults;
        state["notes"] = board_.lists_->notes;
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
        hidden["answers"] = board_.lists_->answers;
        return hidden;
    }

    [[nodiscard]] std::string sentence() const {
        const std::string_view begun = kPhases.at(static_cast<std::size_t>(board_.phase_)).second;
        return board_.phase_ == LivePhase::trouble ? board_.trouble_.sentence
             : board_.phase_ == LivePhase::ended   ? fmt::format("{} {}", begun, board_.ended_)
             : begun.ends_with(' ') ? fmt::format("{}{}", begun, number_text(board_.trial_))
                                    : std::string(begun);
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
          std::max(1.0, std::round(protocol.apparatus.rate_hz / kShownRate)))),
      lists_(std::make_unique<Lists>()) {
    show();
}

LiveBoard::~LiveBoard() = default;

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
        if (result.fault) {
            const std::string_view cause = to_string(result.fault->cause);
            lists_->faults.push_back({{"trial", number},
                                      {"cause", practice_before(progress.number, cause)},
                                      {"advice", result.fault->text.empty()
                                                     ? std::string(explanation(result.fault->cause))
                                                     : result.fault->text}});
        } else if (!result.invalid.empty() || !result.response) {
            add_not_counting(progress.number, result.invalid.empty()
                                                  ? std::string(to_string(result.outcome))
                                                  : result.invalid);
        }
        if (result.response) {
            const auto& given = *result.response;
            const protocols::Condition& condition = progress.planned.condition;
            lists_->answers.push_back(
                {{"trial", number},
                 {"object", protocol_.objects.at(condition.object).name},
                 {"friction", protocol_.frictions.at(condition.friction).name},
                 {"answer", given.object ? protocol_.objects.at(*given.object).name
                                         : fmt::format("{}", given.place + 1)},
                 {"correct", json_or_null(given.correct)}});
        }
        keep_newest(lists_->faults);
        show();
    });
}

void LiveBoard::add_not_counting(const protocols::TrialNumber& trial, const std::string& why) {
    lists_->not_counting.push_back({{"trial", trial.number}, {"why", practice_before(trial, why)}});
    keep_newest(lists_->not_counting);
}

void LiveBoard::marked(const protocols::MarkReply& reply, const std::string& reason) noexcept {
    unless_no_memory([&] {
        if (reply.found) {
            facts_.answered -= std::min<std::size_t>(1, facts_.answered);
            facts_.left += reply.runs_again ? 1U : 0U;
            add_not_counting(reply.number, "marked" + (reason.empty() ? "" : ": " + reason));
            show();
        }
    });
}

void LiveBoard::noted(const std::string& text) noexcept {
    unless_no_memory([&] {
        const bool in_trial = phase_ == LivePhase::explore || phase_ == LivePhase::question;
        lists_->notes.push_back(
            {{"at", data::utc_now()},
             {"trial", in_trial ? data::Json(trial_.number) : data::Json(nullptr)},
             {"text", text}});
        keep_newest(lists_->notes);
        show();
    });
}

void LiveBoard::reveal() noexcept {
    revealed_ = true;
    unless_no_memory([&] { draw_outline(); });
    show();
}

/// The older half of all lists. @return there was something
bool LiveBoard::forget_half() {
    bool any = false;
    for (data::Json* list :
         {&lists_->notes, &lists_->not_counting, &lists_->faults, &lists_->answers}) {
        const auto half = static_cast<std::ptrdiff_t>((list->size() + 1) / 2);
        list->erase(list->begin(), list->begin() + half);
        any |= half > 0;
    }
    return any;
}

void LiveBoard::show() noexcept {
    shown_ns_ = monotonic_ns();
    wishes_ = wishes();
    unless_no_memory([&] {
        std::string json = Text(*this).text();
        while (json.size() > LiveWriter::kStateRoom && forget_half()) {
            json = Text(*this).text();
        }
        writer_.show(json, phase_ns_);
    });
}

}  // namespace palpate::ui
