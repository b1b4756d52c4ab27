#include "ui/live/live_session.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "engine/base/clock.hpp"
#include "engine/base/text.hpp"
#include "data/store/uuid.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/operator_log.hpp"

namespace palpate::ui {
using protocols::SessionStep;

namespace {

constexpr std::size_t kLongestText = 2000;
constexpr std::size_t kInbox = 64;
constexpr std::int64_t kWordNs = 60'000 * kMillisecond;

std::string text_in(const data::Json& asked, const char* key) {
    const data::Json text = asked.value(key, data::Json());
    return text.is_string() ? text.get<std::string>() : std::string();
}

void answer_mark(const Caller& caller, const protocols::MarkReply& reply) {
    caller.answer(reply.found, trimmed(mark_text(reply), "\n"));
}

}  // namespace

void LiveSession::begin(LiveFacts facts,
                        const protocols::Protocol& protocol,
                        const protocols::Plan& plan,
                        data::AsyncRecorder& recorder) {
    recorder_ = &recorder;
    board_ = std::make_unique<LiveBoard>(std::move(facts), protocol, plan, desk_);
    try {
        reader_ = std::make_unique<LiveReader>(board_->descriptor());
    } catch (const std::runtime_error&) {  // the session runs, and shows nothing
    }
    open_ = true;
}

void LiveSession::end(std::string_view how) {
    if (open_.exchange(false)) {
        board_->end(how);
        obey_all();
        for (const auto& caller : std::exchange(marking_, {})) {
            caller->answer(false, "the session is over: nothing was marked");
        }
    }
}

// ---- on the socket's thread

bool LiveSession::confirmed(Word& word,
                            const std::string& given,
                            const Caller& caller,
                            std::string_view question) const {
    const bool stands = !word.word.empty() && monotonic_ns() < word.until_ns;
    if (stands && given == word.word) {
        word = {};
        return true;
    }
    if (!stands || !given.empty()) {                     // else two who ask at once have one word
        word.word = data::random_secret().substr(0, 4);  // nobody sends it by accident
    }
    word.until_ns = monotonic_ns() + kWordNs;
    caller.answer(false, question, word.word);
    return false;
}

void LiveSession::end_early(const std::string& word, const Caller& caller) {
    if (interrupted()) {
        caller.answer(true, "the session ends already");
    } else if (confirmed(end_, word, caller,
                         "ends the session: ask again with this word, within 60 s")) {
        interrupt();
        caller.answer(true, "the session ends; what was recorded is kept");
    }
}

bool LiveSession::may_reveal(const std::string& word, const Caller& caller) {
    if (board_->protocol().reveal == protocols::Reveal::never) {
        caller.answer(false, "the protocol says reveal = \"never\": nothing is shown");
        return false;
    }
    if (revealed_) {
        caller.answer(true, "it is shown already");
        return false;
    }
    return confirmed(reveal_, word, caller,
                     "shows what is felt and answered, and that is kept with the session: ask "
                     "again with this word, within 60 s");
}

void LiveSession::answer_state(const Caller& caller) const {
    const auto state = reader_->state();
    const std::string json = state && !state->json.empty() ? state->json : "null";
    std::string answer = one_line(
        {{"ok", true}, {"text", "what runs"}, {"file", board_->facts().file}, {"pid", getpid()}});
    answer.pop_back();  // the state is JSON already
    caller.answer_line(answer + ",\"state\":" + json + "}", board_->descriptor());
}

/// Held for as long as the session runs: between two servers of its page nobody else can listen
/// there, and be taken for one.
void LiveSession::answer_page(const Caller& caller) {
    if (page_.empty()) {
        page_socket_ = listening_at(htonl(INADDR_LOOPBACK));
        if (page_socket_.get() < 0) {
            caller.answer(false, "there is no address for a page");
            return;
        }
        page_ = one_line({{"ok", true},
                          {"text", "where its pages are"},
                          {"token", data::random_secret()},
                          {"cookie", data::random_secret()}});
    }
    caller.answer_line(page_, page_socket_.get());
}

void LiveSession::hear(const std::string& line, const std::shared_ptr<Caller>& caller) {
    using Obey = std::pair<std::string_view, void (LiveSession::*)(const Asked&)>;
    constexpr std::array kObeyed{
        Obey{"pause", &LiveSession::pause}, Obey{"go on", &LiveSession::go_on},
        Obey{"mark", &LiveSession::mark},   Obey{"note", &LiveSession::note},
        Obey{"noted", &LiveSession::noted}, Obey{"reveal", &LiveSession::reveal}};
    const data::Json asked = object_in(line);
    const std::string what = text_in(asked, "do");
    const std::string text = text_in(asked, what == "mark" ? "reason" : "text");
    const data::Json trial = asked.value("trial", data::Json());
    const auto* obeyed = std::ranges::find(kObeyed, what, &Obey::first);
    if (what == "state" && reader_) {
        answer_state(*caller);
    } else if (!open_) {
        caller->answer(false, "no session runs here now: nothing was done");
    } else if (what == "page" && !asked.contains("page")) {  // a page has its address
        answer_page(*caller);
    } else if (what == "end") {
        end_early(text_in(asked, "word"), *caller);
    } else if (text.size() > kLongestText) {
        caller->answer(false, fmt::format("{} bytes: {} are the most", text.size(), kLongestText));
    } else if (text.find('\0') != std::string::npos) {
        caller->answer(false,
                       "the text has a byte 0, at which other programs end it: leave it out");
    } else if (what == "note" && trimmed(text, " \t\r\n").empty()) {
        caller->answer(false, "the note is empty: say it in a few words");
    } else if (obeyed == kObeyed.end() || (what == "noted" && asked.contains("page"))) {
        caller->answer(
            false,
            "\"do\" is stop, state, page, pause, go on, mark, note, end or reveal: nothing "
            "was done");
    } else if (!trial.is_null() && !(trial.is_number_integer() && trial.get<std::int64_t>() > 0)) {
        caller->answer(false, "\"trial\" is a trial_id, a whole number from 1: nothing was done");
    } else if (what != "reveal" || may_reveal(text_in(asked, "word"), *caller)) {
        const std::scoped_lock lock(mutex_);
        if (inbox_.size() < kInbox) {
            inbox_.push_back(
                {obeyed->second, text, caller, trial.is_null() ? 0 : trial.get<std::int64_t>()});
            asked_ = true;
        } else {
            caller->answer(false, "too much was asked for at once: nothing was done");
        }
    }
}

// ---- on the session's thread

void LiveSession::pump() {
    if (!open_.load(std::memory_order_relaxed)) {
        return;
    }
    if (asked_.load(std::memory_order_relaxed)) {
        obey_all();
    }
    if (revealed_ && !board_->revealed()) {
        board_->reveal();
    }
    board_->look();
    if (beside_ && board_->phase() != SessionStep::explore &&
        board_->phase() != SessionStep::question) {
        beside_();
    }
}

void LiveSession::obey_all() {
    std::deque<Asked> all;
    {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock) {
            return;
        }
        all.swap(inbox_);
        asked_ = false;
    }
    for (const Asked& asked : all) {
        if (board_->phase() == SessionStep::ended) {
            asked.caller->answer(false, "the session is over: nothing was done");
        } else {
            (this->*asked.obey)(asked);
        }
    }
}

/// The answer comes once it is on the disk.
void LiveSession::note(const Asked& asked) {
    const auto trial = board_->running();
    board_->noted(asked.text, trial ? std::optional(board_->trial()) : std::nullopt);
    recorder_->event_soon({.kind = protocols::EventKind::note,
                           .text = asked.text,
                           .trial = trial,
                           .when_ns = asked.when_ns},
                          [caller = asked.caller] { caller->answer(true, "noted"); });
}

void LiveSession::noted(const Asked& asked) {
    board_->noted(asked.text);
    asked.caller->answer(true, "shown");
}

/// Nothing is shown before the file says that it is.
void LiveSession::reveal(const Asked& asked) {
    if (std::exchange(reveal_wanted_, true)) {
        asked.caller->answer(true, "it is shown already");
        return;
    }
    recorder_->event_soon({.kind = protocols::EventKind::reveal,
                           .text = "what is felt and answered is shown to the experimenter",
                           .value = board_->facts().operator_name},
                          [this, caller = asked.caller] {
                              revealed_ = true;
                              caller->answer(true, "shown from now on");
                          });
}

void LiveSession::pause(const Asked& asked) {
    const Caller& caller = *asked.caller;
    if (board_->phase() == SessionStep::pause || board_->phase() == SessionStep::trouble) {
        caller.answer(false, "it waits already");
    } else if (desk_.wants_pause()) {
        caller.answer(true, "it pauses before the next trial, as was asked before");
    } else {
        desk_.pause();
        caller.answer(true, "it pauses before the next trial");
    }
}

/// A pause alone: after a stop weak pulses may move the handle, and whoever goes on is to see it.
void LiveSession::go_on(const Asked& asked) {
    const Caller& caller = *asked.caller;
    const SessionStep phase = board_->phase();
    if (phase == SessionStep::trouble) {
        caller.answer(
            false,
            "at the participant's screen alone, where the handle is seen: Ctrl+Shift+P, or "
            "what it says there");
    } else if (const bool waits = phase == SessionStep::pause; waits || desk_.wants_pause()) {
        if (desk_.wants_pause() != waits) {  // else somebody else asked before
            desk_.pause();
        }
        caller.answer(true, waits ? "it goes on" : "it does not pause after all");
    } else {
        caller.answer(false, "nothing waits for the experimenter");
    }
}

void LiveSession::mark(const Asked& asked) {
    const auto& markable = board_->markable();
    if (asked.trial != 0 && (!markable || asked.trial != markable->id)) {
        asked.caller->answer(
            false, fmt::format("another trial has begun since: nothing is marked; palpate mark "
                               "FILE {} --invalid REASON does it once the session is over",
                               asked.trial));
        return;
    }
    reply_.reset();
    desk_.mark(asked.text);
    if (reply_ || !markable) {
        answer_mark(*asked.caller, reply_.value_or(protocols::MarkReply{}));
    } else if (board_->running()) {
        asked.caller->answer(true, fmt::format("{} is marked once it is over, if its answer counts",
                                               number_text(markable->number)));
    } else {
        marking_.push_back(asked.caller);  // it is over: the session marks it as soon as it looks
    }
}

void LiveSession::marked(const protocols::MarkReply& reply, bool alarm) {
    reply_ = reply;
    board_->marked(reply, alarm);
    for (const auto& caller : std::exchange(marking_, {})) {
        answer_mark(*caller, reply);
    }
}

}  // namespace palpate::ui
