#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "data/store/people.hpp"
#include "data/store/session_lock.hpp"
#include "ui/command/command.hpp"
#include "ui/files/noted_file.hpp"
#include "ui/live/live_segment.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/session_choice.hpp"

namespace palpate::ui {
namespace {

struct NoteOptions {
    std::string database;
    std::string participant;
    std::string study;  ///< empty: the only one of the participant
    std::optional<std::size_t> session;
    std::string text;
    std::string operator_name{};  ///< empty: nobody is named
};

/// What is said of a trial or a session afterwards, and can be taken back.
struct SaidOptions {
    std::string database;
    std::string reason;           ///< empty: it is taken back
    std::string undo;             ///< why
    std::string operator_name{};  ///< empty: nobody is named

    /// @param word  that takes the reason: "--invalid"
    /// @param what  can be taken back: "a mark"
    /// @throws std::invalid_argument unless there is one of both, which says something
    void require_reason(std::string_view word, std::string_view what) const {
        refuse_if(reason.empty() == undo.empty(),
                  "give {} REASON, or --undo REASON to take {} back", word, what);
        require_text(undoes() ? undo : reason,
                     fmt::format("the reason of {}", undoes() ? "--undo" : word));
    }
    [[nodiscard]] bool undoes() const { return !undo.empty(); }
    [[nodiscard]] data::Reason why() const { return {undoes() ? undo : reason, operator_name}; }
};

struct MarkOptions : SaidOptions {
    std::int64_t trial = 0;
};

struct SessionOptions : SaidOptions {
    std::string participant;
    std::int64_t number = 0;
    std::string study;  ///< empty: the only one with such a session
};

/// The session meant: the last one begun, of the only study in question.
data::SessionRow session_of(data::Database& database, const NoteOptions& options) {
    auto all = data::sessions_of(database, options.participant, options.session, options.study);
    if (all.empty()) {
        const auto other = data::similar_participant(database, options.participant);
        refuse_if(other.has_value(), "{}: nobody is called {}: did you mean {}?", options.database,
                  options.participant, other.value_or(""));
        const bool named = options.session || !options.study.empty();
        refuse_if(true, "{}: {} has no {}", options.database, options.participant,
                  named ? "such session" : "session yet");
    }
    const auto other = std::ranges::find_if(
        all, [&](const data::SessionRow& row) { return row.study != all.front().study; });
    refuse_if(other != all.end(), "{}: {} takes part in {} and in {}: give --study",
              options.database, options.participant, all.front().study,
              other == all.end() ? "" : other->study);
    return all.front();
}

/// The page of a session that runs shows the note as well.
void show_note(data::Database& database, std::int64_t session, const std::string& text) {
    if (!data::SessionLock::held(database, session)) {
        return;
    }
    const std::string line = one_line(data::Json{{"do", "noted"}, {"text", text}});
    const std::string uuid =
        database.first("SELECT uuid FROM session WHERE session_id = ?1", session).text(0);
    for (const RunningSession& one : running_sessions(uuid)) {
        if (object_in(ask_session(one.name, line).line).value("ok", false)) {
            return;
        }
    }
    warn("the session runs, and its page does not show this note; the file has it");
}

void declare_note(CommandWords& words, NoteOptions& options) {
    words.add("FILE", options.database, "A palpate database").required();
    words.add("TEXT", options.text, "The note").required().kept_text();
    words.add("--participant", options.participant, "Whose session").required();
    words.add("--session", options.session, "Session number; without it the last one").above_zero();
    words.add("--study", options.study,
              "The study's id, if there are several; of versions ID@HASH");
    words.add("--operator", options.operator_name, "Who notes it").kept_text();
}

int note(const NoteOptions& options) {
    check_participant(options.participant);
    require_text(options.text, "TEXT");
    data::Database database = open_there(options.database);
    const data::SessionRow session = session_of(database, options);
    const std::string head =
        data::add_note(database, session.id, options.text, options.operator_name);
    show_note(database, session.id, options.text);
    say("Noted in session {} of {}, study {}.\nSeal {}: note it in the lab book.\n", session.number,
        options.participant, plain(session.study), head);
    return 0;
}

void declare_mark(CommandWords& words, MarkOptions& options) {
    words.add("FILE", options.database, "A palpate database").required();
    words.add("TRIAL", options.trial, "Its trial_id, as in analysis_trial").required();
    words.add("--invalid", options.reason, "Why it does not count").kept_text();
    words.add("--undo", options.undo, "Why an earlier mark of it is taken back: it counts again")
        .kept_text();
    words.add("--operator", options.operator_name, "Who says so").kept_text();
}

int mark(const MarkOptions& options) {
    options.require_reason("--invalid", "a mark");
    data::Database database = open_there(options.database);
    const data::MarkResult marked = (options.undoes() ? data::undo_mark : data::mark_invalid)(
        database, options.trial, options.why());
    if (options.undoes()) {
        say("Trial {} counts again; that it was marked is kept.\n", options.trial);
    } else {
        say("Trial {} does not count any more; its answer is kept. {}\n", options.trial,
            marked.finished ? "Its session is finished: it is not run again."
                            : "It is run again when its session is resumed.");
    }
    say("Seal {}: note it in the lab book.\n", marked.head);
    return 0;
}

void declare_session(CommandWords& words, SessionOptions& options) {
    words.add("FILE", options.database, "A palpate database").required();
    words.add("ID", options.participant, "Whose session").required();
    words.add("NUMBER", options.number, "Its number, as in session_health")
        .required()
        .within(1, 1'000'000);
    words.add("--study", options.study,
              "The study's id, if there are several; of versions ID@HASH");
    words.add("--withdraw", options.reason, "Why analyses and exports are to leave it out")
        .kept_text();
    words.add("--undo", options.undo, "Why that is taken back").kept_text();
    words.add("--operator", options.operator_name, "Who says so").kept_text();
}

data::SessionRow session_of(data::Database& database, const SessionOptions& options) {
    auto all = data::sessions_of(database, options.participant,
                                 static_cast<std::size_t>(options.number), options.study);
    refuse_if(
        all.size() != 1, "{}: {} has {} session {}: {}", options.database, options.participant,
        all.empty() ? "no" : fmt::format("{} times a", all.size()), options.number,
        all.empty()
            ? "palpate sql FILE -c \"SELECT * FROM session_health\" lists them"
            : fmt::format("give --study and {} or {}", all.front().version, all.back().version));
    return all.front();
}

int withdraw(const SessionOptions& options) {
    options.require_reason("--withdraw", "a withdrawal");
    data::Database database = open_there(options.database);
    const data::SessionRow session = session_of(database, options);
    const std::string head = (options.undoes() ? data::undo_withdrawal : data::withdraw_session)(
        database, session.id, options.why());
    say("Session {} of {}, study {}, {}. Nothing is erased.\nSeal {}: note it in the lab book.\n",
        session.number, options.participant, plain(session.study),
        options.undoes() ? "is analysed again" : "is left out of analyses and exports", head);
    return 0;
}

}  // namespace

Command note_command() {
    return make_command<NoteOptions>(
        "note", "Add an operator's note to a session, also while it runs", declare_note, note);
}

Command mark_command() {
    return make_command<MarkOptions>(
        "mark", "Say that the answer of a trial does not count, or take that back; both are kept",
        declare_mark, mark);
}

Command session_command() {
    return make_command<SessionOptions>(
        "session", "Leave a session out of analyses and exports, or take that back",
        declare_session, withdraw);
}

}  // namespace palpate::ui
