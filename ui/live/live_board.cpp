#include "ui/live/live_board.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "engine/base/clock.hpp"
#include "engine/safety/trip.hpp"
#include "protocols/design/object_outline.hpp"
#include "data/store/database.hpp"

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

/// The older half of all lists. @return there was something
bool LiveBoard::forget_half() {
    const auto halve = [](auto& list) {
        const auto half = static_cast<std::ptrdiff_t>((list.size() + 1) / 2);
        list.erase(list.begin(), list.begin() + half);
        return half > 0;
    };
    const bool some = halve(notes_);
    const bool more = halve(not_counting_);
    const bool others = halve(faults_);
    return halve(answers_) || some || more || others;
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
