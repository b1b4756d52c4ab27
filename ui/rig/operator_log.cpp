#include "ui/rig/operator_log.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <fmt/format.h>

#include "engine/base/text.hpp"

namespace palpate::ui {
namespace {

using protocols::Progress;

/// By the reasons as why_invalid() words them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kRemedies{{
    {"late ", "late ticks: close other programs; palpate doctor says what else"},
    {"stale ", "answers too late: use a port of the computer itself, without a hub"},
    {"contact ",
     "too little contact: explain again that the object is to be felt, not only touched"},
    {"path ", "too short a way: explain again to go along both sides"},
}};

/// What to do about an attempt that does not count.
std::vector<std::string> advice_for(const protocols::TrialResult& result) {
    std::vector<std::string> advice;
    if (result.fault) {
        advice.push_back(fmt::format("faults: {}", explanation(result.fault->cause)));
    }
    if (result.outcome == protocols::Outcome::unanswered) {
        advice.emplace_back(
            "no answer: ask whether the question is clear, and for a break if need be");
    }
    for (const auto& [reason, remedy] : kRemedies) {
        if (result.invalid.find(reason) != std::string::npos) {
            advice.emplace_back(remedy);
        }
    }
    return advice;
}

std::string outcome_text(const Progress& progress, const std::string& what) {
    const protocols::TrialResult& result = progress.result;
    const std::string_view again =
        progress.runs_again() ? "runs again later in its block" : "is not run again";
    if (result.fault) {
        return fault_text(*result.fault) + fmt::format("; {}", again);
    }
    if (result.outcome == protocols::Outcome::unanswered) {
        return fmt::format("nobody answered in time; {}", again);
    }
    if (!result.response) {
        return fmt::format("{}; comes first when the session goes on", to_string(result.outcome));
    }
    return result.invalid.empty()
             ? what
             : fmt::format("{}  does not count: {}; {}", what, result.invalid, again);
}

}  // namespace

std::string shell_word(const std::string& word) {
    constexpr std::string_view kPlain =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_./:=+,@%";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
        return word;
    }
    if (plain(word, Lines::kept) != word) {  // as bash and zsh read what would be shown otherwise
        std::string text = "$'";
        for (const char c : word) {
            const bool is_plain = kPlain.find(c) != std::string_view::npos;
            text += is_plain ? std::string(1, c)
                             : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
        }
        return text + "'";
    }
    std::string text = "'";
    for (const char c : word) {
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return text + "'";
}

std::string number_text(const protocols::TrialNumber& number) {
    return fmt::format("{} {} of {}", number.practice ? "practice" : "trial", number.number,
                       number.total);
}

std::string OperatorLog::left_text(const Progress& progress) const {
    if (progress.left() == 0) {
        return "none left";
    }
    std::string text = fmt::format("{} left", progress.left());
    if (const auto left = minutes(progress.left())) {
        text += *left < 1.0 ? std::string(", less than a minute")
                            : fmt::format(", about {:.0f} min", *left);
    }
    return text;
}

std::optional<double> OperatorLog::minutes(std::size_t left) const {
    if (took_s_.empty()) {
        return std::nullopt;
    }
    std::vector<double> sorted = took_s_;  // one that somebody sat at for an hour says nothing
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    return *middle * static_cast<double>(left) / 60.0;
}

std::string OperatorLog::alarm() const {
    std::map<std::string, std::size_t> reasons;
    std::size_t lost = 0;
    for (const Ended& attempt : ended_) {
        lost += attempt.advice.empty() ? 0U : 1U;
        for (const std::string& one : attempt.advice) {
            ++reasons[one];
        }
    }
    if (lost < kAlarm) {
        return {};
    }
    std::vector<std::pair<std::string, std::size_t>> by_number(reasons.begin(), reasons.end());
    std::ranges::stable_sort(by_number, {}, [](const auto& one) { return -int(one.second); });
    std::string text = fmt::format("ATTENTION: {} of the last {} trials do not count.", lost,
                                   std::max(ended_.size(), kAlarm));
    for (const auto& [advice, times] : by_number) {
        text += fmt::format("\n    {} x {}", times, advice);
    }
    return text + '\n';
}

std::string OperatorLog::line(const Progress& progress, const std::string& what, double now_s) {
    const std::size_t attempt = ++attempts_[progress.planned.position];
    const bool lost = is_lost(progress.result.outcome) || !progress.result.invalid.empty();
    const bool over = progress.result.response || is_lost(progress.result.outcome);
    ended_s_ += progress.waited_s;
    if (over && !progress.runs_again()) {
        took_s_.push_back(now_s - ended_s_);
        ended_s_ = now_s;
    }
    std::string text = fmt::format("#{:<3} {:<16}", progress.trial, number_text(progress.number));
    text += attempt > 1 ? fmt::format("  attempt {}", attempt) : "";
    text += fmt::format("  {}  ({})\n", outcome_text(progress, what), left_text(progress));
    if (over) {
        ended_.push_back({progress.trial, advice_for(progress.result)});
        if (ended_.size() > kLookBack) {
            ended_.pop_front();
        }
    }
    return text + (lost ? alarm() : std::string());
}

std::string OperatorLog::marked(const protocols::MarkReply& reply) {
    const auto attempt = std::ranges::find(ended_, reply.trial, &Ended::trial);
    if (!reply.found || attempt == ended_.end()) {
        return mark_text(reply);
    }
    attempt->advice = {"marked: what was wrong goes on unless somebody sees to it"};
    return mark_text(reply) + alarm();
}

std::string go_on_command(const std::vector<std::string>& words) {
    const char* launcher = std::getenv("PALPATE_WORD");
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "--resume") {
            ++i;
        } else if (!words[i].starts_with("--resume=")) {
            const bool first = i == 0 && launcher != nullptr && *launcher != '\0';
            text += (text.empty() ? "" : " ") + shell_word(first ? launcher : words[i]);
        }
    }
    return text;
}

std::string run_summary(data::Database& database,
                        std::int64_t session,
                        std::int64_t after,
                        double minutes) {
    data::Statement row = database.first(
        "SELECT count(response.trial_id), count(invalid_reason), count(*) FILTER (WHERE outcome = "
        "'faulted'), coalesce(sum(late_ticks) * 100.0 / nullif(sum(ticks), 0), 0.0) FROM trial "
        "LEFT JOIN response USING (trial_id) WHERE session_id = ?1 AND trial.trial_id > ?2",
        session, after);
    return fmt::format(
        "This run: {} answered, {} of them {} not count, {} faulted, {:.1f} min, {:.3g} % of the "
        "ticks late.\n",
        row.integer(0), row.integer(1), row.integer(1) == 1 ? "does" : "do", row.integer(2),
        minutes, row.real(3));
}

std::string without_stop(std::string sentence) {
    sentence.erase(sentence.find_last_not_of(".\n") + 1);
    return sentence;
}

std::string fault_text(const protocols::Fault& fault) {
    const std::string what =
        without_stop(fault.text.empty() ? std::string(explanation(fault.cause)) : fault.text);
    return fmt::format("fault: {}", what);
}

std::string trouble_text(const protocols::TroubleView& view) {
    const std::string sentence = without_stop(view.sentence);
    if (!view.solved) {
        return fmt::format("trouble: {}\n", sentence);
    }
    return view.by_hand
             ? std::string("the session can go on: Ctrl+Shift+P at the participant's screen\n")
             : std::string("the session can go on: the participant presses Space\n");
}

std::string_view pause_text(bool begins) noexcept {
    return begins ? "pause: Ctrl+Shift+P at the participant's screen goes on\n"
                  : "the pause is over\n";
}

std::string mark_text(const protocols::MarkReply& reply) {
    return reply.found
             ? fmt::format("{} #{} is marked: it does not count and {}\n",
                           number_text(reply.number), reply.trial,
                           reply.runs_again ? "runs again later in its block" : "is not run again")
             : std::string(
                   "nothing to mark: no answer of this run, or the last one does not count\n");
}

}  // namespace palpate::ui
