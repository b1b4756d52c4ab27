#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "data/store/people.hpp"
#include "ui/cli/commands.hpp"
#include "ui/cli/session_choice.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

/// Only a database that is there: nothing is to be made for a wrong name.
data::Database open_there(const std::string& file) {
    { const data::Database there(file, data::Access::read); }
    return {file, data::Access::write};
}

void require_text(const std::string& text, std::string_view what) {
    if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
        throw std::invalid_argument(fmt::format("{} is empty: say it in a few words", what));
    }
}

/// The session meant: the last one begun, of the only study in question.
data::SessionRow session_of(data::Database& database, const NoteOptions& options) {
    auto all = data::sessions_of(database, options.participant, options.session);
    std::erase_if(all, [&](const data::SessionRow& row) {
        return !options.study.empty() && row.study != options.study;
    });
    if (all.empty()) {
        const auto other = data::similar_participant(database, options.participant);
        if (other) {
            throw std::invalid_argument(fmt::format("{}: nobody is called {}: did you mean {}?",
                                                    options.database, options.participant, *other));
        }
        throw std::invalid_argument(
            fmt::format("{}: {} has no such session", options.database, options.participant));
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

}  // namespace

int note_command(const NoteOptions& options) {
    check_participant(options.participant);
    require_text(options.text, "TEXT");
    data::Database database = open_there(options.database);
    const data::SessionRow session = session_of(database, options);
    const std::string head =
        data::add_note(database, session.id, options.text, options.operator_name);
    say("Noted in session {} of {}, study {}.\nChain {}: note it in the lab book.\n",
        session.number, options.participant, plain(session.study), head);
    return 0;
}

int mark_command(const MarkOptions& options) {
    require_text(options.reason, "the reason of --invalid");
    data::Database database = open_there(options.database);
    const data::Marked marked =
        data::mark_invalid(database, options.trial, options.reason, options.operator_name);
    say("Trial {} does not count any more; its answer is kept. {}\nChain {}: note it in the lab "
        "book.\n",
        options.trial,
        marked.finished ? "Its session is finished: it is not run again."
                        : "It is run again when its session is resumed.",
        marked.head);
    return 0;
}

}  // namespace palpate::ui
