#include "protocols/session/progress.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "engine/base/refuse.hpp"
#include "protocols/design/adaptive_plan.hpp"

namespace palpate::protocols {

AdaptiveRuns::AdaptiveRuns(const Protocol& protocol, const StreamKey& session) {
    if (!protocol.procedure) {
        return;
    }
    for (std::size_t run = 0; run < protocol.runs.size(); ++run) {
        begun_.emplace_back(*protocol.procedure->rule.spec, stream(run_key(session, run)));
    }
    procedures_ = begun_;
}

double AdaptiveRuns::next(std::size_t run) const {
    const Procedure& procedure = procedures_.at(run);
    refuse_if<std::logic_error>(procedure.finished(), "run {} has ended", run);
    return procedure.next().front();
}

void AdaptiveRuns::update(const RuleAnswer& answer) {
    procedures_.at(answer.run).update(std::span(&answer.stimulus, 1), answer.outcome, answer.track);
}

AdaptiveStep AdaptiveRuns::step_after(const RuleAnswer& answer) const {
    const Procedure& procedure = procedures_.at(answer.run);
    return {
        .answer = answer, .estimates = procedure.estimates(), .state_hash = procedure.state_hash()};
}

std::optional<double> stimulus_for(const Protocol& protocol,
                                   const PlannedTrial& planned,
                                   const AdaptiveRuns& runs) {
    if (!planned.adaptive) {
        return std::nullopt;
    }
    return planned.phase == Phase::practice ? protocol.procedure->practice_stimulus
                                            : runs.next(planned.adaptive->run);
}

std::size_t outcome_of(const Protocol& protocol,
                       const PlannedTrial& planned,
                       const Response& response) {
    switch (protocol.response.kind) {
        case ResponseKind::two_interval:
            return response.place + 1 == planned.adaptive->comparison ? 1 : 0;
        case ResponseKind::identification: {
            const std::vector<std::size_t> pictured = objects_of(protocol, true);
            const auto found = std::ranges::find(pictured, response.object);
            return static_cast<std::size_t>(found - pictured.begin());
        }
        case ResponseKind::yes_no:
        case ResponseKind::rating:
            break;
    }
    return response.place;
}

std::optional<bool> is_right(const Protocol& protocol,
                             const Plan& plan,
                             const PlannedTrial& planned,
                             std::span<const Presentation> felt,
                             std::size_t place) {
    if (protocol.response.kind == ResponseKind::identification && !planned.adaptive) {
        const auto& pictures = plan.picture_order;
        const bool pictured =
            std::ranges::find(pictures, planned.condition.object) != pictures.end();
        return pictured ? std::optional(pictures.at(place) == planned.condition.object)
                        : std::nullopt;
    }
    if (protocol.response.kind != ResponseKind::two_interval || felt.size() != 2) {
        return std::nullopt;
    }
    const double first = varied_value(*protocol.procedure, felt[0]);
    const double second = varied_value(*protocol.procedure, felt[1]);
    if (first == second) {
        return std::nullopt;
    }
    return (second > first) == (place == 1);
}

PendingTrials::PendingTrials(const Plan& plan, RequeueRule rule) : rule_(std::move(rule)) {
    for (const PlannedTrial& planned : plan.trials) {
        order_.push_back(planned.position);
        part_.push_back(planned.phase == Phase::practice ? 0 : 1 + planned.block);
    }
}

bool PendingTrials::has(std::size_t position) const noexcept {
    return std::ranges::find(order_, position) != order_.end();
}

std::size_t PendingTrials::left(bool practice) const noexcept {
    return static_cast<std::size_t>(std::ranges::count_if(
        order_, [&](std::size_t position) { return (part_[position] == 0) == practice; }));
}

TrialNumber PendingTrials::number() const noexcept {
    const bool practice = !order_.empty() && part_[order_.front()] == 0;
    const auto total = static_cast<std::size_t>(
        std::ranges::count_if(part_, [&](std::size_t part) { return (part == 0) == practice; }));
    return {practice, std::min(total - left(practice) + 1, total), total};
}

void PendingTrials::note(std::size_t position, Outcome outcome, bool counts) {
    const bool answered = is_answered(outcome);
    const auto found = std::ranges::find(order_, position);
    if (found == order_.end() || !(answered || is_lost(outcome))) {
        return;
    }
    order_.erase(found);
    unanswered_ += outcome == Outcome::unanswered ? 1 : 0;
    if (!(answered && counts)) {
        set_back(position);
    }
}

void PendingTrials::begin_again(std::size_t part) {
    std::erase_if(order_, [&](std::size_t position) { return part_[position] == part; });
    std::erase_if(again_, [&](const auto& again) { return part_[again.first] == part; });
    auto at =
        std::ranges::find_if(order_, [&](std::size_t position) { return part_[position] > part; });
    for (std::size_t position = 0; position < part_.size(); ++position) {
        if (part_[position] == part) {
            at = order_.insert(at, position) + 1;
        }
    }
}

void PendingTrials::set_back(std::size_t position) {
    const Pcg32 random = stream(rule_.key, purpose::requeue, position);
    Again& again = again_.try_emplace(position, Again{.random = random}).first->second;
    if (again.times++ == rule_.max) {
        return;
    }
    const auto part = part_[position];  // parts follow each other in the plan, and so they do here
    const auto first =
        std::ranges::find_if(order_, [&](std::size_t other) { return part_[other] >= part; });
    const auto last =
        std::find_if(first, order_.end(), [&](std::size_t other) { return part_[other] > part; });
    const auto others = static_cast<std::uint32_t>(last - first);
    order_.insert(others == 0 ? first : first + 1 + again.random.bounded(others), position);
}

SessionProgress::SessionProgress(const Protocol& protocol,
                                 const Plan& plan,
                                 const StreamKey& session)
    : begun_(plan, {.key = session, .max = protocol.invalid.max_requeues}),
      pending_(begun_),
      runs_(protocol, session) {}

bool SessionProgress::counts(TrialId trial) const noexcept {
    return std::ranges::any_of(steps_, [trial](const Step& step) {
        return step.attempt && step.attempt->trial == trial && step.attempt->counts;
    });
}

std::vector<TrialId> SessionProgress::counting(std::size_t part) const {
    std::vector<TrialId> trials;
    for (const Step& step : steps_) {
        if (step.attempt && step.attempt->counts &&
            pending_.part_of(step.attempt->position) == part) {
            trials.push_back(step.attempt->trial);
        }
    }
    return trials;
}

void SessionProgress::take(const Step& step) {
    if (step.attempt) {
        pending_.note(step.attempt->position, step.attempt->outcome, step.attempt->counts);
    } else {
        pending_.begin_again(step.part);
    }
}

/// An answer decides where all later ones of its part were set back to, and what its run showed
/// next: both are gone through again.
void SessionProgress::set_counts(const std::vector<TrialId>& trials, bool counts) {
    std::set<std::size_t> runs;
    pending_ = begun_;
    for (Step& step : steps_) {
        if (step.attempt && std::ranges::find(trials, step.attempt->trial) != trials.end()) {
            step.attempt->counts = counts;
            if (step.attempt->answer) {
                runs.insert(step.attempt->answer->run);
            }
        }
        take(step);
    }
    for (const std::size_t run : runs) {
        runs_.restart(run);
        for (const Step& step : steps_) {
            if (step.attempt && step.attempt->counts && step.attempt->answer &&
                step.attempt->answer->run == run) {
                runs_.update(*step.attempt->answer);
            }
        }
    }
}

void SessionProgress::mark(TrialId trial, bool marked) {
    const auto step = std::ranges::find_if(
        steps_, [trial](const Step& one) { return one.attempt && one.attempt->trial == trial; });
    if (step != steps_.end() && (marked ? step->attempt->counts : step->marked)) {
        step->marked = marked;
        set_counts({trial}, !marked);
    }
}

SessionProgress apply(SessionProgress progress, const Attempt& attempt) {
    if (attempt.answer) {
        progress.runs_.update(*attempt.answer);
    }
    ++progress.attempts_[attempt.position];
    progress.steps_.push_back({.attempt = attempt});
    progress.take(progress.steps_.back());
    return progress;
}

SessionProgress apply(SessionProgress progress, const Event& event) {
    if (event.kind == EventKind::mark && event.trial) {
        progress.mark(*event.trial, event.key != kUndone);
    }
    if (event.kind == EventKind::redo && event.part) {
        const std::vector<TrialId> trials = progress.counting(*event.part);
        progress.steps_.push_back({.attempt = {}, .part = *event.part});
        progress.set_counts(trials, false);
    }
    return progress;
}

}  // namespace palpate::protocols
