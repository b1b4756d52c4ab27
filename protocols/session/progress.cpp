#include "protocols/session/progress.hpp"

#include <algorithm>
#include <set>

namespace palpate::protocols {

SessionProgress::SessionProgress(const Protocol& protocol,
                                 const Plan& plan,
                                 const StreamKey& session)
    : begun_(plan, {.key = session, .max = protocol.invalid.max_requeues}),
      pending_(begun_),
      runs_(protocol, session) {}

bool SessionProgress::counts(TrialId trial) const noexcept {
    return std::any_of(steps_.begin(), steps_.end(), [trial](const Step& step) {
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
