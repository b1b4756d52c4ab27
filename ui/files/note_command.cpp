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

struct MarkOptions {
    std::string database;
    std::int64_t trial = 0;
    std::string reason;           ///< empty: the mark is taken back
    std::string undo;             ///< why
    std::string operator_name{};  ///< empty: nobody is named
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
    const auto other = std::find_if(all.begin(), all.end(), [&](const data::SessionRow& row) {
        return row.study != all.front().study;
    });
    if (other != all.end()) {
        throw std::invalid_argument(fmt::format("{}: {} takes part in {} and in {}: give --study",
                                                options.database, options.participant,
                                                all.front().study, other->study));
    }
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
    refuse_if(options.reason.empty() == options.undo.empty(),
              "give --invalid REASON, or --undo REASON to take a mark back");
    const bool undo = !options.undo.empty();
    require_text(undo ? options.undo : options.reason,
                 undo ? "the reason of --undo" : "the reason of --invalid");
    data::Database database = open_there(options.database);
    const data::MarkResult marked =
        undo ? data::undo_mark(database, options.trial, {options.undo, options.operator_name})
             : data::mark_invalid(database, options.trial, {options.reason, options.operator_name});
    if (undo) {
        say("Trial {} counts again; that it was marked is kept.\n", options.trial);
    } else {
        say("Trial {} does not count any more; its answer is kept. {}\n", options.trial,
            marked.finished ? "Its session is finished: it is not run again."
                            : "It is run again when its session is resumed.");
    }
    say("Seal {}: note it in the lab book.\n", marked.head);
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

}  // namespace palpate::ui
