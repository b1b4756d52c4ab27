#include "ui/live/live_board.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "engine/base/clock.hpp"
#include "engine/device/device.hpp"
#include "engine/safety/trip.hpp"
#include "protocols/design/object_outline.hpp"
#include "data/store/database.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/operator_log.hpp"

namespace palpate::ui {
using protocols::SessionStep;

namespace {

constexpr double kShownRate = 125;  ///< ticks a second
/// A running exploration is shown so often.
constexpr std::int64_t kShowEvery = 1000 * kMillisecond;
constexpr std::size_t kNewest = 100;  ///< lines of a list, and notes; answers are all shown

void keep_newest(data::Json& list) {
    if (list.size() > kNewest) {
        list.erase(0);
    }
}

data::Json of_trial(const protocols::TrialNumber& trial) {
    return {{"trial", trial.number}, {"practice", trial.practice}};
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
    {"gap", "the screen is blank for a moment"},  // after a break the trial is the next one
    {"break", "a break before "},
    {"pause", "paused by the experimenter before "},
    {"trouble", ""},
    {"ended", "the session is over:"},
}};

}  // namespace

struct LiveBoard::Shown {
    data::Json session;
    data::Json device;
    data::Json not_counting = data::Json::array();
    data::Json faults = data::Json::array();
    data::Json notes = data::Json::array();
    data::Json answers = data::Json::array();  ///< for nobody before they are revealed
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
      all_(std::make_shared<Shown>(
          Shown{.session = object_in(facts_.session), .device = object_in(facts_.device)})) {
    show();
}

void LiveBoard::enter(SessionStep phase, const protocols::TrialView* trial) noexcept {
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
    masked_ = noise_at(phase, masked_);
    if (phase == SessionStep::explore && interval == 1) {
        late_trial_ = {};
    }
    show();
}

void LiveBoard::enter(const protocols::TroubleView& trouble) noexcept {
    unless_no_memory([&] {
        if (phase_ != SessionStep::trouble || trouble.sentence != trouble_.sentence ||
            trouble.solved != trouble_.solved) {
            trouble_ = trouble;
            phase_ns_ = phase_ == SessionStep::trouble ? phase_ns_ : monotonic_ns();
            phase_ = SessionStep::trouble;
            masked_ = false;
            show();
        }
    });
}

void LiveBoard::end(std::string_view how) noexcept {
    unless_no_memory([&] { ended_ = how; });
    phase_ = SessionStep::ended;
    masked_ = false;
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
        stale_ += (tick.flags & engine::tick_stale) != 0 ? 1U : 0U;
        if (ticks_++ % per_shown_ == 0) {
            show(tick);
        }
    }
    if (monotonic_ns() - shown_ns_ > kShowEvery) {
        show();
    }
}

void LiveBoard::show(const engine::TickRecord& tick) noexcept {
    LiveTick shown{.tick = {.time_ns = tick.time_ns, .lateness_us = tick.lateness_us},
                   .force_on = facts_.gives_force && (tick.flags & engine::tick_fault) == 0};
    if (revealed_) {
        const double seconds = static_cast<double>(tick.time_ns - last_.time_ns) * 1e-9;
        shown.tick = tick;
        shown.speed = seconds > 0.0 ? glm::length(tick.hip - last_.hip) / seconds : 0.0;
        shown.felt = true;
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
        data::Json entry = of_trial(progress.number);
        if (result.fault) {
            entry["cause"] = to_string(result.fault->cause);
            entry["advice"] = result.fault->text.empty() ? explanation(result.fault->cause)
                                                         : std::string_view(result.fault->text);
            all_->faults.push_back(entry);
        } else if (!result.invalid.empty() || !result.response) {
            add_not_counting(progress.number, result.invalid.empty()
                                                  ? std::string(to_string(result.outcome))
                                                  : result.invalid);
        }
        if (result.response) {
            const auto& given = *result.response;
            const protocols::Condition& condition = progress.planned.condition;
            entry["object"] = protocol_.objects.at(condition.object).name;
            entry["friction"] = protocol_.frictions.at(condition.friction).name;
            entry["answer"] = given.object ? protocol_.objects.at(*given.object).name
                                           : fmt::format("{}", given.place + 1);
            entry["correct"] = json_or_null(given.correct);
            all_->answers.push_back(std::move(entry));
        }
        keep_newest(all_->faults);
        show();
    });
}

void LiveBoard::add_not_counting(const protocols::TrialNumber& trial, const std::string& why) {
    data::Json& entry = all_->not_counting.emplace_back(of_trial(trial));
    entry["why"] = why;
    keep_newest(all_->not_counting);
}

void LiveBoard::marked(const protocols::MarkReply& reply, bool alarm) noexcept {
    unless_no_memory([&] {
        const std::string why = (reply.reason.empty() ? "" : ": ") + reply.reason;
        if (!reply.found) {  // whoever asked was answered before the trial's end
            noted("a mark found no answer that counts" + why);
        } else {
            alarm_ = alarm;
            const bool waits = phase_ == SessionStep::rest || phase_ == SessionStep::pause;
            trial_ = waits ? reply.next : trial_;
            facts_.answered -= std::min<std::size_t>(1, facts_.answered);
            facts_.left += reply.runs_again ? 1U : 0U;
            add_not_counting(reply.number, "marked" + why);
            show();
        }
    });
}

void LiveBoard::noted(const std::string& text,
                      const std::optional<protocols::TrialNumber>& trial) noexcept {
    unless_no_memory([&] {
        data::Json note = trial ? of_trial(*trial) : data::Json{{"trial", nullptr}};
        note["at"] = data::utc_now();
        note["text"] = text;
        all_->notes.push_back(std::move(note));
        keep_newest(all_->notes);
        show();
    });
}

void LiveBoard::checked(const std::string& found) noexcept {
    unless_no_memory([&] {
        all_->device["check"] = found;
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
    for (data::Json* list : {&all_->notes, &all_->not_counting, &all_->faults, &all_->answers}) {
        const auto half = static_cast<std::ptrdiff_t>((list->size() + 1) / 2);
        list->erase(list->begin(), list->begin() + half);
        any |= half > 0;
    }
    return any;
}

std::string LiveBoard::text() const {
    const bool on = phase_ == SessionStep::explore && facts_.gives_force && !desk_.wants_stop();
    data::Json state = all_->session;
    state.update(
        {{"phase", kPhases.at(static_cast<std::size_t>(phase_)).first},
         {"sentence", sentence()},
         {"trial", trial_.number},
         {"trials", trial_.total},
         {"practice", trial_.practice},
         {"remaining", facts_.left},
         {"remaining_min", json_or_null(minutes_)},
         {"next_break_in", json_or_null(next_break())},
         {"answered", facts_.answered},
         {"alarm", alarm_},
         {"pausing", wishes_[0]},
         {"markable", markable_ ? data::Json{{"trial_id", markable_->id},
                                             {"name", number_text(markable_->number)}}
                                : data::Json(nullptr)},
         {"solved", phase_ == SessionStep::trouble && trouble_.solved},
         {"force", {{"on", wishes_[2] ? data::Json(nullptr) : data::Json(on)}, {"why", why()}}},
         {"reveal", protocol_.reveal == protocols::Reveal::never ? "never"
                    : revealed_                                  ? "shown"
                                                                 : "ask"},
         {"ended", json_or_null(ended_)}});
    add_device(state);
    state.update(
        {{"not_counting", all_->not_counting}, {"faults", all_->faults}, {"notes", all_->notes}});
    add_hidden(state);
    return one_line(state);
}

void LiveBoard::add_device(data::Json& state) const {
    state["device"] = all_->device;
    state["device"]["dead_man"] =  // who lets go ends the exploration
        protocol_.safety.dead_man && facts_.gives_force && phase_ == SessionStep::explore;
    state["masking"] = facts_.masking_db
                         ? data::Json{{"on", masked_}, {"level_db", *facts_.masking_db}}
                         : data::Json(nullptr);
    state["late"] = {{"edges_us", kEdges},
                     {"trial", late_trial_},
                     {"session", late_session_},
                     {"stale_share", static_cast<double>(stale_) /
                                         static_cast<double>(std::max<std::uint64_t>(1, ticks_))}};
}

void LiveBoard::add_hidden(data::Json& state) const {
    if (!revealed_) {
        return;
    }
    data::Json& hidden = state["hidden"];
    if (felt_) {
        const protocols::Presentation& felt = *felt_;
        hidden = {{"object", felt.object.name},
                  {"friction", felt.friction.name},
                  {"level", json_or_null(felt.stimulus)},
                  {"outline", data::Json::array()}};
        for (const engine::Vec2& point : outline_) {
            hidden["outline"].push_back({point.x, point.y});
        }
    }
    hidden["answers"] = all_->answers;
}

std::string LiveBoard::sentence() const {
    const std::string_view begun = kPhases.at(static_cast<std::size_t>(phase_)).second;
    const bool second =
        interval_ == 2 && (phase_ == SessionStep::ready || phase_ == SessionStep::explore);
    return phase_ == SessionStep::trouble ? trouble_.sentence
         : phase_ == SessionStep::ended   ? fmt::format("{} {}", begun, ended_)
         : begun.ends_with(' ')
             ? fmt::format("{}{}{}", begun, number_text(trial_), second ? ", second interval" : "")
             : std::string(begun);
}

std::string LiveBoard::why() const {
    const char* barred = desk_.barred();
    return wishes_[2]                     ? engine::kForceUnproved
         : !facts_.gives_force            ? "this device gives no force"
         : barred != nullptr              ? barred
         : desk_.wants_stop()             ? "stopped"
         : phase_ == SessionStep::trouble ? trouble_.sentence
         : phase_ == SessionStep::explore ? "exploring"
                                          : "nothing is felt now";
}

std::optional<std::size_t> LiveBoard::next_break() const {
    for (std::size_t k = 1; facts_.answered + k < plan_.trials.size(); ++k) {
        if (plan_.trials[facts_.answered + k].break_before) {
            return k;
        }
    }
    return std::nullopt;
}

void LiveBoard::show() noexcept {
    shown_ns_ = monotonic_ns();
    wishes_ = wishes();
    unless_no_memory([&] {
        std::string json = text();
        while (json.size() > LiveWriter::kStateRoom && forget_half()) {
            json = text();
        }
        writer_.show(json, phase_ns_);
    });
}

}  // namespace palpate::ui
